"""Whether an FMU answers what moves or pushes it with the signs of the block that it stands in for.

Each input that the car drives is led from 0 to a small value, alone and with its rate beside it; in
the same way for the block and for the FMU, of which one instance runs for each. Two models of one
thing differ in size, and in what is small; where both answer strongly, and all the way with
opposite signs, a sign is wrong. What the block hardly feels cannot be told: the rates of a truck's
carbody.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from orchestrator import (
    Component,
    CouplingError,
    Description,
    Profile,
    System,
    Variable,
    listed,
    simulate,
)

Array = np.ndarray

SMALL = {"m": 1e-3, "rad": 1e-3, "m/s": 1e-2, "rad/s": 1e-2, "N": 5e3, "N.m": 5e3}
"""By unit, where an input is led to: what a car feels on fair track."""

LED, STEP = 0.1, 1e-3
"""Time that it takes, and the macro step [s]."""

LOOKED = 0.5
"""Part of that time from which on answers are compared."""

STRONG, FELT = 0.3, 0.02
"""Parts of an output's largest answer from which on both models are taken at their word: of any
output, and of the one where a move is felt most."""

Move = Mapping[str, float]
"""Inputs that are led at once, and where to; the rate of another one follows from that."""


def opposed(
    own: Component,
    other: Component,
    block: Description,
    rates: Mapping[str, str],
    ports: Collection[str],
    isolated: bool = False,
) -> list[str]:
    """A sentence for each output that answers with the other sign.

    own, other: the block and the FMU with the car's values, both by the block's names. block: the
    block's description. rates: inputs by those whose rates they are. ports: those that the car
    connects. isolated: each instance of the FMU in a process of its own. Raises
    orchestrator.OrchestratorError.
    """
    starts = {v.name: float(v.start or 0.0) for v in block.inputs if v.name in ports}
    led = [v for v in block.inputs if starts.get(v.name) == 0.0 and v.unit in SMALL]
    outputs = [v for v in block.outputs if v.name in ports]
    moves = [*_moves(led, rates)]
    if not moves or not outputs:
        return []
    units = {v.name: str(v.unit) for v in led}
    ours, theirs = (
        _answers(_systems(one, starts, moves, units), outputs, alone)
        for one, alone in ((own, False), (other, isolated))
    )
    share = np.minimum(_share(ours), _share(theirs)).min(axis=2)
    strong = share > np.where(share == share.max(axis=1, keepdims=True), FELT, STRONG)
    wrong = np.all(ours * theirs < 0, axis=2) & strong
    return [
        _told(outputs[o], moves, ours[:, o, -1], theirs[:, o, -1], np.flatnonzero(wrong[:, o]))
        for o in np.flatnonzero(wrong.any(axis=0))
    ]


def _told(output: Variable, moves: Sequence[Move], ours: Array, theirs: Array, wrong: Array) -> str:
    """The strongest of the wrong answers of an output, and how many more there are."""
    most = wrong[np.abs(theirs[wrong]).argmax()]
    others = {next(iter(moves[m])) for m in wrong} - {next(iter(moves[most]))}
    more = f", and so to {listed(sorted(others))}" if others else ""
    return (
        f"{output.name} answers {' and '.join(moves[most])} with {theirs[most]:+.3g} "
        f"{output.unit}, the block with {ours[most]:+.3g}{more}"
    )


def _moves(led: Sequence[Variable], rates: Mapping[str, str]) -> Iterator[Move]:
    names = {v.name for v in led}
    for variable in led:
        yield {variable.name: SMALL[str(variable.unit)]}
        rate = next((r for r, of in rates.items() if of == variable.name and r in names), None)
        if rate is not None:
            yield {variable.name: SMALL[str(variable.unit)], rate: 0.0}


def _systems(
    component: Component,
    starts: Mapping[str, float],
    moves: Sequence[Move],
    units: Mapping[str, str],
) -> System:
    """An instance that nothing moves, and one for each move."""
    still = replace(component, parameters={**component.parameters, **starts})
    names = [f"move_{m}" for m in range(len(moves))]
    system = System(dict.fromkeys(("still", *names), still))
    for name, move in zip(names, moves, strict=True):
        end = next(iter(move.values()))
        for port, value in move.items():
            system = system.driven(f"{name}.{port}", _table(units[port], end, value == 0.0))
    return system


def _answers(system: System, outputs: Sequence[Variable], isolated: bool) -> Array:
    """What the moves change [move, output, time], from half the way on."""
    names = [name for name, component in system.components.items() if component.file is not None]
    run = simulate(
        system,
        master="jacobi",
        duration=LED,
        step=STEP,
        isolate=tuple(names) if isolated else (),
        record=tuple(f"{name}.{output.name}" for name in names for output in outputs),
    )
    if run.message:
        raise CouplingError(run.message)
    first = math.ceil(LOOKED * LED / STEP)
    rows = np.array(
        [[run.dataset[f"{name}.{v.name}"].values[first:] for v in outputs] for name in names]
    )
    return np.asarray(rows[1:] - rows[0])


def _table(unit: str, end: float, rate: bool) -> Profile:
    """From 0 to the end, flat at both ends; or the rate of that."""
    times = np.linspace(0.0, LED, round(LED / STEP) + 1)
    phase = np.pi * times / LED
    values = end * np.pi / (2 * LED) * np.sin(phase) if rate else end * (1 - np.cos(phase)) / 2
    return Profile("value", unit, tuple(times), tuple(values))


def _share(answers: Array) -> Array:
    """Of the largest answer of each output at each time."""
    size = np.abs(answers)
    most = size.max(axis=0, keepdims=True)
    return np.divide(size, most, out=np.zeros_like(size), where=most > 0)
