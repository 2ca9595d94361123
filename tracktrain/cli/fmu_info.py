"""What an FMU is, as tables for a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any

import fmpy
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from orchestrator import Contents, Description, Variable, plain

from ..terminal import plain_grid
from .fmu_contents import Extras
from .fmu_data import experiment, has_source, scales

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


def print_info(
    console: Console,
    contents: Contents,
    description: Description,
    beside: Extras,
    parameters: bool,
) -> None:
    """Print what an FMU is; its parameters if they are asked for."""
    _print_head(console, contents, description, beside)
    _print_ports(console, description)
    _print_terminals(console, beside)
    _print_range(console, description)
    if parameters:
        _print_parameters(console, description)


def _print_range(console: Console, description: Description) -> None:
    """What its laws hold for, where it says so."""
    rows = [
        {
            "outputs": ", ".join(limit.outputs),
            "at least": f"{limit.least:.4g}" if isfinite(limit.least) else "",
            "at most": f"{limit.largest:.4g}" if isfinite(limit.largest) else "",
            "unit": limit.unit,
            "beyond": limit.beyond,
        }
        for limit in description.limits or ()
    ]
    if rows:
        console.print(_table("range: its laws hold for", rows))


def _table(title: str, rows: list[dict[str, str]]) -> Table:
    """One column for each key under which a row has something."""
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
        table.add_row(*(plain(row[heading]) for heading in headings))
    return table


def _one_line(text: str | None) -> str:
    return plain(" ".join((text or "").split()))


def _print_head(
    console: Console, contents: Contents, description: Description, beside: Extras
) -> None:
    root = contents.root.attrib
    kinds = " and ".join(contents.interfaces) or "no interface"
    console.print(f"{plain(description.label)}: FMI {contents.version}, {kinds}", style="bold")
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
    return here([*contents.platforms, *source], bool(description.binary))


def here(platforms: list[str], runs_here: bool) -> str:
    state = "runs on this machine" if runs_here else f"none for this machine, {fmpy.platform}"
    return f"{', '.join(platforms)} ({state})" if platforms else f"none ({fmpy.platform} is needed)"


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
            return f"{plain(unit)} (not known)"
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
