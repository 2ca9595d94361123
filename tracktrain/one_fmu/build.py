"""From a system to one FMU: its variables, its C, its archive."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from fmus.describe.variables import Input, Limit, Output, Parameter
from fmus.export.assembly import Able, Assembly, build_assembly
from fmus.names import identifier
from orchestrator import CoupledCode, Master, System, Variable, coupled_code

from .within import header, sources_of, tables

HERE = Path(__file__).parent
MACRO_STEP = Parameter(
    "macro_step",
    "s",
    "Macro step, at which the FMUs within exchange values; a step of this FMU that is no multiple "
    "of it goes in equal steps that are shorter",
    minimum=1e-9,
)


def build_one_fmu(
    system: System,
    out: Path,
    master: Master | str = "one-pass",
    fmi: str = "2.0",
    platforms: Iterable[str] = ("host",),
) -> tuple[Path, list[str]]:
    """Write the FMU to the file `out`; its path, and notes for the user.

    platforms: as `tracktrain build --target` has them. Raises OrchestratorError for a system that
    cannot be made into one, TracktrainError for an FMU without sources, and CompileError.
    """
    code = coupled_code(system, master)
    files = list(dict.fromkeys(code.fmus))
    guids = [code.descriptions[code.fmus.index(file)].guid for file in files]
    own = [(i, v.reference) for i, v, _ in code.parameters]
    layout = {**code.layout, "N_WITHIN": len(code.names), "N_WITHIN_PARAMETERS": len(own)}
    core = {
        **sources_of(files),
        **{path.name: path.read_text() for path in sorted((HERE / "native").glob("*.[ch]"))},
        "within.c": tables(guids, [files.index(file) for file in code.fmus], own),
        "layout.h": header(layout),
        "system.h": code.text,
    }
    assembly = _assembly(code, identifier(out.stem, "system"), system)
    further = {"documentation/README.md": (HERE / "README.md").read_bytes(), **_icons()}
    return build_assembly(assembly, core, further, out, fmi, platforms), code.notes


def _icons() -> dict[str, bytes]:
    return {
        f"terminalsAndIcons/icon{s}": (HERE / f"icon{s}").read_bytes() for s in (".png", ".svg")
    }


def _assembly(code: CoupledCode, name: str, system: System) -> Assembly:
    def full(i: int, variable: str) -> str:
        return f"{code.names[i]}.{variable}"

    parameters = [_parameter(full(i, v.name), v, value) for i, v, value in code.parameters]
    macro_step = Parameter(**{**vars(MACRO_STEP), "default": code.step})
    inputs = [
        Input(full(i, v.name), v.unit or "1", v.description, v.nominal or None, start)
        for (i, v), start in zip(code.inputs, code.starts, strict=True)
    ]
    outputs = [
        Output(
            full(i, v.name),
            v.unit or "1",
            v.description,
            v.nominal or None,
            full(i, v.derivative_of) if v.derivative_of else None,
        )
        for i, v in code.outputs
    ]
    now = {
        full(i, v.name): sorted(full(*port) for port in code.depends[i, v.name])
        for i, v in code.outputs
    }
    listed = ", ".join(code.names)
    return Assembly(
        name,
        f"{len(code.names)} FMUs and their master in one: {listed}",
        ([*parameters, macro_step], inputs, outputs),
        now,
        _limits(code),
        (system.experiment.stop or 8.0, code.step),
        Able(
            all(d.saves_state for d in code.descriptions),
            all(d.serializes_state for d in code.descriptions),
            all(d.variable_step for d in code.descriptions),
            any(d.single_instance for d in code.descriptions),
        ),
    )


def _parameter(name: str, variable: Variable, value: float) -> Parameter:
    return Parameter(
        name,
        variable.unit or "1",
        variable.description,
        minimum=variable.minimum,
        maximum=variable.maximum,
        tunable=variable.variability == "tunable",
        kind=variable.kind,  # type: ignore[arg-type]
        choices=tuple(variable.items),
        default=value,
    )


def _limits(code: CoupledCode) -> Sequence[Limit]:
    """What the FMUs within say that they hold for."""
    return [
        Limit(
            f"{name}.{number}",
            tuple(f"{name}.{output}" for output in limit.outputs),
            limit.unit,
            limit.least if limit.least > float("-inf") else None,
            limit.largest if limit.largest < float("inf") else None,
            limit.beyond,
            limit.remedy,
            "derived",
            limit.source,
            limit.void,
            limit.allowed,
        )
        for name, description in zip(code.names, code.descriptions, strict=True)
        for number, limit in enumerate(description.limits or (), start=1)
    ]
