"""A system with its master as C: what an FMU is made of that holds the whole system.

The C stands for itself: the macro loop, the loop that brings the values at the start into
agreement, and their tables as data. It calls the FMUs by the functions of FMI 2.0, as in a run, and
so it computes the same, to the last bit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from ..compiled.library import c_of
from ..compiled.translate import HEAD
from ..errors import CouplingError
from ..fmu.description import Description, Variable
from ..masters.base import Master, master_named
from ..masters.loop.record import record_of
from ..masters.loop.settle import PASSES, settle_row, settle_tables
from ..masters.loop.tables import LOOP, NOT_CONVERGED, NOT_FINITE
from ..plan.order import Port
from ..plan.plan import Plan, feedthrough, make_plan
from ..slaves.abi import FUNCTIONS, Addresses
from ..slaves.base import Slave
from ..slaves.inline import InlineModel
from ..system.system import STEP, Component, Connection, System, Value
from .image import Image, StandIn

OUTSIDE = "outside"
"""The instance that stands for whoever drives the system's open inputs."""

SPARE = 8
"""Rows kept besides those that a master looks back at, so that they are seldom moved."""


@dataclass(frozen=True)
class CoupledCode:
    """A system in C, and what its numbers mean.

    layout: sizes and places in its tables, and the numbers of its reports, by name. fmus: by
    instance, its file. inputs: those that nothing drives, as pairs of instance and variable, with
    `starts`; in C they are the outputs of the last instance, called `outside`. outputs: pairs
    likewise, in the order of the record's columns. parameters: likewise, with the value that the
    system or else the FMU gives each. step: the macro step [s] that is usual.
    """

    text: str
    layout: Mapping[str, int]
    names: list[str]
    descriptions: list[Description]
    fmus: list[Path]
    inputs: list[tuple[int, Variable]]
    starts: list[float]
    outputs: list[tuple[int, Variable]]
    parameters: list[tuple[int, Variable, float]]
    depends: Mapping[Port, frozenset[Port]]
    step: float
    notes: list[str]


def coupled_code(system: System, master: Master | str = "one-pass") -> CoupledCode:
    """The C of a system; raises OrchestratorError for one whose FMUs cannot be called so."""
    master = master_named(master) if isinstance(master, str) else master
    plan = make_plan(system)
    _check(system, plan)
    inputs = [port for port in plan.open_inputs if port[1].kind == "real"]
    given = {(i, v.name): value for i, pairs in enumerate(plan.values) for v, value in pairs}
    starts = [_number(v, given.get((i, v.name), v.start or 0.0)) for i, v in inputs]
    driven = make_plan(_from_outside(system, plan, inputs))
    slaves = cast(list[Slave], [StandIn(n) for n in range(len(driven.names))])
    prepared = master.prepare(driven, slaves)
    if prepared.states is not None or prepared.solved is not None:
        raise CouplingError(
            f"the master '{master.name}' repeats macro steps, which is not made into one FMU; "
            "choose one-pass, gauss-seidel or jacobi"
        )
    if prepared.start_order:
        prepared.notes.append("the first macro steps have no values before them to extrapolate")
    columns, behind = len(driven.columns), prepared.behind
    rows = np.zeros((behind + SPARE, columns))
    record = record_of(rows, np.zeros((behind + SPARE, len(prepared.led))))
    report = np.zeros(4, np.int64)
    common = (0, 0, 0.0, 0.0, record, report)
    loops = {
        "ADVANCE": (prepared.advance, (*common, *prepared.tables)),
        **{
            name: (settle_row, (*common, *settle_tables(driven, slaves, stepping)))
            for name, stepping in (("SETTLE", False), ("SETTLE_STEPPING", True))
        },
    }
    image = Image(loops, [report, *prepared.memory, *_counted(loops)], [record.ends, rows])
    layout = {
        "ROWS": len(rows),
        "BEHIND": behind,
        "COLUMNS": columns,
        "LED": len(prepared.led),
        "INSTANCES": len(plan.names),
        "OUTSIDE_COLUMN": driven.first_column[-2],
        "ROWS_BYTE": image.byte_of(rows),
        "ENDS_BYTE": image.byte_of(record.ends),
        "REPORT_BYTE": image.byte_of(report),
        "NOT_FINITE": NOT_FINITE,
        "NOT_CONVERGED": NOT_CONVERGED,
        "LOOP": LOOP,
        "PASSES": PASSES,
        "IMAGE_WORDS": image.size,
        "IMAGE_CHANGING": image.changing,
        **{f"{name}_ARGUMENTS": word for name, word in image.arguments.items()},
    }
    return CoupledCode(
        text="\n".join([*_code(loops, image), *_names(driven), ""]),
        layout=layout,
        names=plan.names,
        descriptions=plan.descriptions,
        fmus=[cast(Path, c.file) for c in system.components.values()],
        inputs=inputs,
        starts=starts,
        outputs=driven.columns[: driven.first_column[-2]],
        parameters=_parameters(plan, given),
        depends=_depends(plan),
        step=system.experiment.step or STEP,
        notes=[*plan.notes, *prepared.notes],
    )


def _check(system: System, plan: Plan) -> None:
    """Raise CouplingError for what C's calls of FMI 2.0 do not reach."""
    for name, description, every in zip(plan.names, plan.descriptions, plan.every, strict=True):
        where = f"{name} ({description.label}) cannot be made part of one FMU: "
        if system.components[name].file is None:
            raise CouplingError(
                f"{where}it is no file, but a table or a model of this program; leave it out, and "
                "what it drives is an input of the FMU"
            )
        ports = [*description.inputs, *description.outputs]
        if description.fmi_version.startswith("3") or any(
            v.lane or v.type != "Real" for v in ports
        ):
            raise CouplingError(f"{where}it takes an FMU of FMI 2.0 whose ports are of type Real")
        if every != 1:
            raise CouplingError(f"{where}it steps every {every} macro steps; let it step in each")
        if system.components[name].ports is not None:
            raise CouplingError(
                f"{where}its ports go by a map; give it an FMU with the system's names"
            )


def _from_outside(system: System, plan: Plan, inputs: Sequence[tuple[int, Variable]]) -> System:
    """The system with one more instance, which drives all inputs that nothing drives."""
    if OUTSIDE in system.components:
        raise CouplingError(f"an instance is called '{OUTSIDE}', as the inputs' source would be")
    ports = {f"u[{n}]": v.unit or "1" for n, (_, v) in enumerate(inputs, start=1)}
    open_ports = {(plan.names[i], v.name) for i, v in inputs}
    components = {
        name: replace(
            c, parameters={n: v for n, v in c.parameters.items() if (name, n) not in open_ports}
        )
        for name, c in system.components.items()
    }
    components[OUTSIDE] = Component(InlineModel(outputs=ports))
    connections = tuple(
        Connection(f"{OUTSIDE}.{port}", plan.name(i, v), suppress_unit_conversion=True)
        for port, (i, v) in zip(ports, inputs, strict=True)
    )
    return replace(system, components=components, connections=system.connections + connections)


def _counted(loops: Mapping[str, tuple[Any, tuple[Any, ...]]]) -> Iterator[Any]:
    """Whole numbers that all loops change: those of algebraic loops."""
    for _, given in loops.values():
        for table in given:
            if hasattr(table, "again"):
                yield from (table.again, table.unknowns.state)


def _code(loops: Mapping[str, tuple[Any, tuple[Any, ...]]], image: Image) -> Iterator[str]:
    """The loops as functions that this file keeps to itself, and their tables."""
    entries = {loop.name: loop for loop, _ in loops.values()}
    text = c_of(entries.values())
    yield text.replace(HEAD, f"{HEAD}#undef EXPORT\n#define EXPORT static\n", 1)
    yield from (f"#define {name}_LOOP {loop.name}" for name, (loop, _) in loops.items())
    yield from image.c(Addresses._fields)


def _names(plan: Plan) -> Iterator[str]:
    """What a message calls instances, columns and calls."""
    texts = {
        "INSTANCE_NAME": plan.names,
        "COLUMN_NAME": [plan.name(i, v) for i, v in plan.columns],
        "CALL_NAME": ["", *(f.fmi2 for f in FUNCTIONS.values())],
    }
    for table, names in texts.items():
        listed = ",\n    ".join(f'"{name}"' for name in names)
        yield f"static const char *const {table}[] = {{\n    {listed}}};"


def _parameters(plan: Plan, given: Mapping[Port, Value]) -> list[tuple[int, Variable, float]]:
    """All parameters that are numbers, with their values."""
    return [
        (i, v, _number(v, given.get((i, v.name), v.start or 0.0)))
        for i, d in enumerate(plan.descriptions)
        for v in d.variables.values()
        if v.causality == "parameter" and v.coupled and v.takes_value
    ]


def _number(variable: Variable, value: Value) -> float:
    """A value as it was resolved, or as a description states it."""
    if isinstance(value, str):
        return float({"true": 1, "false": 0, **variable.items}.get(value, value))
    return float(cast(float, value))


def _depends(plan: Plan) -> dict[Port, frozenset[Port]]:
    """By output, the open inputs that it depends on within the same instant."""
    _, needs, driver = feedthrough(plan.columns, plan.links, plan.descriptions)
    found: dict[Port, frozenset[Port]] = dict.fromkeys(needs, frozenset())
    before: object = None
    while before != (before := dict(found)):  # until what is reached grows no more
        for port, names in needs.items():
            inputs = [(port[0], name) for name in names]
            reached = [found[driver[i]] if i in driver else frozenset((i,)) for i in inputs]
            found[port] = frozenset[Port]().union(*reached)
    return found
