"""The commands `tracktrain fmu`: what an FMU is, and whether it can stand in for a block."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from fmus.names import NAMES

from ..failures import clear_errors
from ..options.types import Name
from .fmu_data import (
    as_data,
    experiment,
    has_source,
    scales,
)

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from orchestrator import (
        Description,
        Variable,
    )
    from orchestrator.fmu.read import Contents

    from ..car.stand_in import StandIn
    from .fmu_contents import Extras


CAPABILITIES = {
    "directional derivatives": ("providesDirectionalDerivative", "providesDirectionalDerivatives"),
    "input derivatives": ("canInterpolateInputs", "providesIntermediateUpdate"),
    "variable step": ("canHandleVariableCommunicationStepSize",),
    "saved state": ("canGetAndSetFMUstate", "canGetAndSetFMUState"),
    "serialised state": ("canSerializeFMUstate", "canSerializeFMUState"),
}
"""What an interface may offer, and the attributes that say so in the versions of FMI."""

OF_STEPS = ("input derivatives", "variable step")
"""Those that make sense in co-simulation only."""

DEMANDS = {
    "one instance in a process": "canBeInstantiatedOnlyOncePerProcess",
    "the tool that made it": "needsExecutionTool",
}

PARAMETERS = ("parameter", "structuralParameter")


class ClearErrors(click.Group):
    """A group whose errors are one message each, as those of the other commands."""

    def invoke(self, ctx: click.Context) -> Any:
        with clear_errors():
            return super().invoke(ctx)


@click.group(
    cls=ClearErrors,
    epilog="""\b
Examples:
  tracktrain fmu info my_truck.fmu
  tracktrain fmu check my_truck.fmu --as truck
  tracktrain fmu test my_truck.fmu""",
)
def fmu() -> None:
    """Look into FMUs, ours or any other."""


@fmu.command(
    epilog="""\b
Examples:
  tracktrain fmu info my_truck.fmu
  tracktrain fmu info my_truck.fmu --parameters
  tracktrain fmu info my_truck.fmu --json > my_truck.json"""
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--parameters", is_flag=True, help="List the parameters, too.")
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON.")
def info(file: Path, parameters: bool, as_json: bool) -> None:
    """Say what an FMU is: ports, units, terminals, capabilities, platforms, hash, provenance.

    FMI 1.0, 2.0 and 3.0, for model exchange or co-simulation.
    """
    from orchestrator.fmu.read import (
        open_fmu,
        survey,
    )

    from .fmu_contents import extras

    contents = open_fmu(file)
    description = survey(contents)
    beside = extras(contents)
    if as_json:
        data = as_data(contents, description, beside)
        click.echo(json.dumps(data, indent=2, ensure_ascii=False))
        return
    console = plain_console()
    _print_head(console, contents, description, beside)
    _print_ports(console, description)
    _print_terminals(console, beside)
    if parameters:
        _print_parameters(console, description)


@fmu.command(
    epilog="""\b
Examples:
  tracktrain fmu check my_truck.fmu --as truck
  tracktrain fmu check my_wheelset.fmu --as wheelrail
  tracktrain fmu check foreign.fmu --as wheelrail --map foreign.toml"""
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--as",
    "block",
    type=Name("block", NAMES),
    help="Block of the hopper car that it is to replace; needed.",
)
@click.option(
    "--map",
    "map_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="What the block's ports are called in the FMU, with signs and units, in TOML or as an SSP "
    "parameter map (.ssm).",
)
@click.pass_context
def check(ctx: click.Context, file: Path, block: str | None, map_file: Path | None) -> None:
    """Tell whether an FMU can stand in for a block of the hopper car.

    The exit code is 0 if it can, 1 if it cannot, and 2 if there is nothing to check.
    """
    if block is None:
        raise click.UsageError(f"--as is missing; choose one of: {', '.join(NAMES)}")
    from orchestrator import read_port_map

    from ..car.stand_in import compare

    found = compare(file, block, None if map_file is None else read_port_map(map_file))
    console = plain_console()
    console.print(_comparison(found))
    console.print()
    style = "bold green" if found.possible else "bold red"
    console.print(found.verdict, style=style, soft_wrap=True)
    ctx.exit(0 if found.possible else 1)


def plain_console() -> Console:
    from rich.console import Console

    return Console(markup=False, highlight=False, emoji=False)


def plain_grid() -> Table:
    from rich.table import Table

    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    return table


def _table(title: str, rows: list[dict[str, str]]) -> Table:
    """One column for each key under which a row has something."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=title,
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        collapse_padding=True,
    )
    headings = [heading for heading in rows[0] if any(row[heading] for row in rows)]
    for heading in headings:
        widest = max(len(row[heading]) for row in rows)
        table.add_column(heading, overflow="fold", no_wrap=heading == "name" and widest <= 36)
    for row in rows:
        table.add_row(*(row[heading] for heading in headings))
    return table


def _one_line(text: str | None) -> str:
    return " ".join((text or "").split())


def _print_head(
    console: Console, contents: Contents, description: Description, beside: Extras
) -> None:
    root = contents.root.attrib
    kinds = " and ".join(contents.interfaces) or "no interface"
    console.print(f"{description.label}: FMI {contents.version}, {kinds}", style="bold")
    if text := _one_line(root.get("description")):
        console.print(text)
    console.print()
    grid = plain_grid()
    grid.add_row("model", _one_line(f"{root.get('modelName', '')} {root.get('version', '')}"))
    made = [root.get("generationTool"), root.get("generationDateAndTime")]
    grid.add_row("made by", _one_line(", ".join(filter(None, made))) or "not said")
    for label, name in (("author", "author"), ("copyright", "copyright"), ("licence", "license")):
        grid.add_row(label, _one_line(root.get(name)) or "not said")
    grid.add_row("platforms", _platforms(contents, description))
    for kind, said in contents.interfaces.items():
        grid.add_row(kind, _capabilities(kind, said))
    if said := experiment(contents):
        grid.add_row("experiment", ", ".join(f"{k} {v}" for k, v in said.items()))
    grid.add_row("units", _units(description) or "none")
    grid.add_row("parameters", str(len(_of(description, *PARAMETERS))))
    grid.add_row("states", f"{beside.states}, event indicators {beside.event_indicators}")
    for standard in beside.standards:
        files = "\n".join(f"{role}: {source}" for role, source in standard.related)
        grid.add_row("follows", f"{standard.name} {standard.version}\n{files}".strip())
    for problem in beside.problems:
        grid.add_row("problem", problem)
    grid.add_row("guid", description.guid)
    grid.add_row("sha256", description.sha256)
    console.print(grid)


def _of(description: Description, *causalities: str) -> list[Variable]:
    return [v for v in description.variables.values() if v.causality in causalities]


def _platforms(contents: Contents, description: Description) -> str:
    source = ["source code"] if has_source(contents) else []
    return _here([*contents.platforms, *source], bool(description.binary))


def _here(platforms: list[str], runs_here: bool) -> str:
    import fmpy

    here = "runs on this machine" if runs_here else f"none for this machine, {fmpy.platform}"
    return f"{', '.join(platforms)} ({here})" if platforms else f"none ({fmpy.platform} is needed)"


def _capabilities(kind: str, said: Mapping[str, str]) -> str:
    possible = [n for n in CAPABILITIES if kind == "co-simulation" or n not in OF_STEPS]
    offers = [
        name
        for name, attributes in CAPABILITIES.items()
        if any(said.get(attribute) in ("true", "1") for attribute in attributes)
    ]
    lacks = [name for name in possible if name not in offers]
    needs = [name for name, attribute in DEMANDS.items() if said.get(attribute) in ("true", "1")]
    parts = {"offers": offers, "without": lacks, "demands": needs}
    return "\n".join(f"{label} {', '.join(names)}" for label, names in parts.items() if names)


def _units(description: Description) -> str:
    def shown(unit: str, scale: Any) -> str:
        if scale is None:
            return f"{unit} (not known)"
        if (scale.factor, scale.offset) == (1.0, 0.0):
            return unit
        shift = f" {scale.offset:+.10g}" if scale.offset else ""
        return f"{unit} ({scale.factor:.10g}{shift} in SI)"

    return ", ".join(shown(unit, scale) for unit, scale in scales(description).items())


def _print_ports(console: Console, description: Description) -> None:
    for causality in ("input", "output"):
        ports = _of(description, causality)
        rows = [
            {
                "name": port.name + _kind(port),
                "unit": port.unit or "",
                "start": _start(port) if causality == "input" else "",
                "rate of": port.derivative_of or "",
                "depends on": _depends(port, description) if causality == "output" else "",
                "": _one_line(port.description),
            }
            for port in ports
        ]
        console.print()
        title = f"{causality}s ({len(ports)})"
        console.print(_table(title, rows) if rows else f"no {causality}s")


def _print_terminals(console: Console, beside: Extras) -> None:
    if not beside.terminals:
        return
    rows = [
        {
            "name": terminal.name,
            "kind": terminal.kind,
            "rule": terminal.rule,
            "members": ", ".join(
                variable
                if not name or f".{variable}".endswith(f".{name}")
                else f"{name} = {variable}"
                for name, variable, _ in terminal.members
            ),
        }
        for terminal in beside.terminals
    ]
    console.print()
    console.print(_table(f"terminals ({len(rows)})", rows))


def _kind(port: Variable) -> str:
    size = f"[{', '.join(str(n) for n in port.shape)}]" if port.shape else ""
    plain = port.type in ("Real", "Float64") and not size
    return "" if plain else f" ({port.type}{size})"


def _depends(port: Variable, description: Description) -> str:
    if port.dependencies is None:
        return "not said"
    inputs = {v.name for v in description.inputs}
    found = port.dependencies & inputs
    if not found:
        return "no input"
    return "all inputs" if found == inputs else f"{len(found)} of {len(inputs)} inputs"


def _print_parameters(console: Console, description: Description) -> None:
    rows = []
    for v in _of(description, *PARAMETERS):
        rows.append(
            {
                "name": v.name + _kind(v),
                "unit": v.unit or "",
                "start": _start(v),
                "range": _range(v),
                "": _one_line(v.description),
            }
        )
    console.print()
    console.print(_table(f"parameters ({len(rows)})", rows) if rows else "no parameters")


def _start(variable: Variable) -> str:
    start = variable.start or ""
    if variable.items:
        return next((k for k, number in variable.items.items() if str(number) == start), start)
    try:
        return f"{float(start):.6g}" if variable.type in ("Real", "Float64") else start
    except ValueError:
        return start


def _range(variable: Variable) -> str:
    if variable.items:
        return ", ".join(variable.items)
    low, high = variable.minimum, variable.maximum
    if low is None:
        return "" if high is None else f"at most {high:.10g}"
    return f"at least {low:.10g}" if high is None else f"{low:.10g} to {high:.10g}"


def _comparison(found: StandIn) -> Table:
    grid = plain_grid()

    def add(label: str, texts: list[str], style: str | None = None) -> None:
        if texts:
            grid.add_row(label, "\n".join(texts), style=style)

    grid.add_row("ports", f"{len(found.fitting)} of {found.required} required ones fit as they are")
    add("fitting", [", ".join(found.fitting)] if found.fitting else [])
    missing = {causality: ports for causality, ports in found.missing.items() if ports}
    add("missing", [f"{c}s {', '.join(ports)}" for c, ports in missing.items()], "red")
    add("unusable", found.unusable, "red")
    add("converted", [f"{c.port}: {c.source} -> {c.target}, {c.rule}" for c in found.converted])
    add("mapped", [f"{ours} is {theirs}" for ours, theirs in found.mapped.items()])
    if found.unitless:
        grid.add_row("unitless", f"taken to be in the block's unit: {', '.join(found.unitless)}")
    for label, there, absent in (
        ("optional", found.optional, found.absent),
        ("parameters", found.given, found.lacking),
    ):
        if there or absent:
            without = f"; without {_shortened(absent)}" if absent else ""
            grid.add_row(label, f"{len(there)} of {len(there) + len(absent)}{without}")
    grid.add_row("platforms", _here(found.platforms, found.runs_here))
    add("coupling", found.losses)
    if found.losses and found.effects == []:
        grid.add_row("effect", "none: every input of the car is led as before")
    add("effect", found.effects or [])
    add("note", found.remarks)
    return grid


def _shortened(names: list[str], limit: int = 8) -> str:
    more = f" and {len(names) - limit} more" if len(names) > limit else ""
    return ", ".join(names[:limit]) + more
