"""Self-test of an FMU: does it do what it says of itself? On instances of its own, before a run.

Each check drives them with small changes of their inputs over a few steps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np

from ..errors import OrchestratorError, UnitError, listed
from ..fmu.description import Variable
from ..fmu.read import open_fmu
from ..fmu.units import scale_of
from ..slaves.session import Session
from ..slaves.surroundings import kept
from ..system.system import Component
from .findings import Finding, SelfTest
from .probe import Array, Probe

STEPS = 3
"""Steps before and after a state is saved."""

STEP = 1e-3
"""Length of a step where the FMU recommends none [s]."""

WAVE = 1e-3
"""Change of an input, relative to its start value or 1."""

NUDGES = (1e-6, -1e-6, 1e-2, -1e-2)
"""Changes of an input that tell which outputs depend on it, relative to its value or 1."""

SLOPE = 1e-4
"""Relative difference of a derivative from the central difference that counts as none."""

KINK = 0.1
"""Relative difference of one-sided differences above which a point is on a kink."""

DIFFERENCE = 1e-6
"""Half the distance of a central difference, relative to the input's value or 1."""

Open = Callable[[], Probe]
"""Makes a probe at its start."""


def self_test(component: Component, step: float | None = None) -> SelfTest:
    """Test an FMU with the component's values by steps of `step` [s], else what it recommends."""
    size = step or _recommended(component) or STEP
    findings: list[Finding] = []
    passed: list[str] = []
    label = ""
    for name, check in _CHECKS.items():
        with ExitStack() as stack, kept(lambda changed: None):
            session = stack.enter_context(Session())

            def opened(stack: ExitStack = stack, session: Session = session) -> Probe:
                return Probe("tested", component, session, stack)

            try:
                probe = opened()
                label = probe.description.label
                if not _offers(probe, name, findings):
                    continue
                found = [Finding(name, *said) for said in check(probe, opened, size)]
            except OrchestratorError as error:
                if name == "start":  # nothing else can be tested
                    label = component.file.name if component.file else label
                    return SelfTest(label, (), (Finding(name, str(error)),))
                told = f"could not be tested: {error}"
                found = [Finding(name, told, wrong=False, tested=False)]
            else:
                if not any(f.wrong for f in found):
                    passed.append(name)
            findings += found
    return SelfTest(label, tuple(passed), tuple(findings))


Said = tuple[str, bool]
"""A finding without the name of its check."""


def _start(_: Probe, __: Open, ___: float) -> Iterator[Said]:
    """It can be loaded and initialized: what is checked was done before."""
    yield from ()


def _surroundings(probe: Probe, _: Open, size: float) -> Iterator[Said]:
    """The program around it is left as it was."""
    with probe.slave.watched():
        _driven(probe, 0, STEPS, size)
    if changed := probe.slave.disturbed:
        yield f"it changes {', '.join(changed)} for the whole program", True


def _reading(probe: Probe, _: Open, size: float) -> Iterator[Said]:
    """Outputs can be read at any time."""
    _driven(probe, 0, STEPS, size)
    probe.set(_wave(probe, STEPS))
    try:
        probe.get()
    except OrchestratorError as error:
        yield (
            f"outputs cannot be read after inputs were set without a step between ({error}); in a "
            "run they are those of the last step",
            False,
        )


def _units(probe: Probe, _: Open, __: float) -> Iterator[Said]:
    """Every unit of a port is known."""
    bare = []
    for v in (*probe.inputs, *probe.outputs):
        if v.kind != "real":
            continue
        if v.unit is None:
            bare.append(v.name)
            continue
        try:
            scale_of(v.unit, probe.description.units)
        except UnitError as error:
            yield f"{v.name}: {error}; connections of it cannot be checked", False
    if bare:
        yield f"without a unit, so that connections cannot be checked: {listed(bare)}", False


def _determinism(probe: Probe, opened: Open, size: float) -> Iterator[Said]:
    """A second instance gives the same bits."""
    first = _driven(probe, 0, 2 * STEPS, size)
    if probe.description.single_instance:
        probe.open()
        second = _driven(probe, 0, 2 * STEPS, size)
    else:
        second = _driven(opened(), 0, 2 * STEPS, size)
    if found := _first_difference(probe, first, second):
        name, step, a, b = found
        yield (
            f"two instances differ: after {step} equal steps {name} is {a:.17g} in one and "
            f"{b:.17g} in the other; a run with it cannot be repeated",
            True,
        )


def _rollback(probe: Probe, _: Open, size: float) -> Iterator[Said]:
    """State saved, stepped, put back, stepped again: the same bits."""
    _driven(probe, 0, STEPS, size)
    probe.save()
    before = probe.get()
    first = _driven(probe, STEPS, STEPS, size)
    probe.restore()
    now = probe.get()
    if found := _first_difference(probe, before[None], now[None]):
        name, _step, a, b = found
        yield f"{name} was {a:.17g} when the state was saved, and is {b:.17g} when put back", True
        return
    second = _driven(probe, STEPS, STEPS, size)
    if found := _first_difference(probe, first, second):
        name, step, a, b = found
        yield (
            f"a saved state does not hold everything: {name} is {a:.17g} {_steps(step)} after it, "
            f"and {b:.17g} when it is put back and the same is repeated",
            True,
        )


def _serialisation(probe: Probe, opened: Open, size: float) -> Iterator[Said]:
    """A state as bytes, taken over by another instance, gives the same bits."""
    _driven(probe, 0, STEPS, size)
    state, time = probe.slave.state(), probe.time
    first = _driven(probe, STEPS, STEPS, size)
    if probe.description.single_instance:
        probe.open()
        other = probe
    else:
        other = opened()
    other.slave.restore(state)
    other.time = time
    second = _driven(other, STEPS, STEPS, size)
    if found := _first_difference(probe, first, second):
        name, step, a, b = found
        yield (
            f"a state as bytes does not hold everything: {name} is {a:.17g} {_steps(step)} after "
            f"it, and {b:.17g} in another instance that took it over; do not go on from "
            "checkpoints",
            True,
        )


def _dependencies(probe: Probe, _: Open, size: float) -> Iterator[Said]:
    """Outputs change at once with those inputs that the model description names, and no other."""
    seen: set[tuple[str, str]] = set()
    undeclared: dict[tuple[str, str], str] = {}
    for _point in _points(probe, size):
        u, base = probe.now.copy(), probe.get()
        for j, known in enumerate(probe.inputs):
            if known.kind != "real":
                continue
            for nudge in NUDGES:
                moved = u.copy()
                moved[j] = _bounded(known, u[j] + nudge * max(1.0, abs(u[j])))
                probe.set(moved)
                now = probe.get()
                for n in np.flatnonzero(_differs(now, base)):
                    output = probe.outputs[n]
                    seen.add((output.name, known.name))
                    if output.dependencies is None or known.name in output.dependencies:
                        continue
                    undeclared.setdefault(
                        (output.name, known.name),
                        f"{output.name} goes from {base[n]:.6g} to {now[n]:.6g} at once when "
                        f"{known.name} goes from {u[j]:.6g} to {moved[j]:.6g}, which its model "
                        "description does not say (dependencies); it is read too early then",
                    )
            probe.set(u)
    yield from ((text, True) for text in undeclared.values())
    real = {v.name for v in probe.inputs if v.kind == "real"}
    unseen = [
        f"{output.name} on {name}"
        for output in probe.outputs
        for name in sorted((output.dependencies or frozenset()) & real)
        if (output.name, name) not in seen
    ]
    if unseen:
        yield f"said to depend at once, but not seen to here: {listed(unseen)}", False


def _derivatives(probe: Probe, _: Open, size: float) -> Iterator[Said]:
    """Directional derivatives against central differences."""
    wrong: dict[tuple[str, str], str] = {}
    for point in _points(probe, size):
        u, base = probe.now.copy(), probe.get()
        for j, known in enumerate(probe.inputs):
            unknowns = [
                (n, v)
                for n, v in enumerate(probe.outputs)
                if v.kind == "real" and known.name in (v.dependencies or ())
            ]
            if known.kind != "real" or not unknowns:
                continue
            numbers = [n for n, _v in unknowns]
            given = probe.directional([v for _n, v in unknowns], known)
            forward, backward = differences(probe, u, base, j)
            distance = DIFFERENCE * max(1.0, abs(u[j]))
            rounding = 1e2 * np.finfo(float).eps * np.abs(base) / distance
            if _kinked(forward[numbers], backward[numbers], rounding[numbers]):
                continue
            for value, ahead, behind, n in zip(
                given, forward[numbers], backward[numbers], numbers, strict=True
            ):
                central = 0.5 * (ahead + behind)
                # A bend has one-sided differences that differ.
                allowed = SLOPE * max(abs(value), abs(central)) + abs(ahead - behind) + rounding[n]
                if not abs(value - central) <= allowed:
                    name = probe.outputs[n].name
                    wrong.setdefault(
                        (name, known.name),
                        f"the derivative of {name} by {known.name} is said to be {value:.6g} "
                        f"{point}, and a central difference gives {central:.6g}",
                    )
    yield from ((text, True) for text in wrong.values())


def _kinked(forward: Array, backward: Array, rounding: Array) -> bool:
    """Whether the point is on a kink of some output.

    There a derivative is that of neither side, also of an output that has no kink itself: the kink
    chooses between branches for all.
    """
    apart = np.abs(forward - backward)
    largest = np.maximum(np.abs(forward), np.abs(backward))
    return bool(np.any(apart > KINK * largest + rounding))


_CHECKS: dict[str, Callable[[Probe, Open, float], Iterator[Said]]] = {
    "start": _start,
    "units": _units,
    "surroundings": _surroundings,
    "determinism": _determinism,
    "rollback": _rollback,
    "serialisation": _serialisation,
    "reading": _reading,
    "dependencies": _dependencies,
    "derivatives": _derivatives,
}

CHECKS = tuple(_CHECKS)
"""What an FMU is tested for, in this order."""


def _offers(probe: Probe, check: str, findings: list[Finding]) -> bool:
    """Whether there is something to check, after what was found before."""
    said = probe.description
    reads = not any(f.check == "reading" for f in findings)
    return {
        "rollback": probe.rolls_back,
        "serialisation": said.serializes_state,
        "reading": bool(probe.inputs and probe.outputs),
        "dependencies": reads,
        "derivatives": said.gives_derivatives and reads,
    }.get(check, True)


def differences(probe: Probe, u: Array, base: Array, j: int) -> tuple[Array, Array]:
    """One-sided differences of all outputs by input `j` about `u`, where they are `base`."""
    sides = []
    for sign in (1.0, -1.0):
        moved = u.copy()
        moved[j] += sign * DIFFERENCE * max(1.0, abs(u[j]))
        probe.set(moved)
        sides.append((probe.get() - base) / (moved[j] - u[j]))
    probe.set(u)
    return sides[0], sides[1]


def _points(probe: Probe, size: float) -> Iterator[str]:
    """Be at the start, then after some steps; where that is, in words."""
    probe.set(_wave(probe, 0))
    yield "at the start"
    _driven(probe, 0, STEPS, size)
    yield f"after {STEPS} steps"


def _driven(probe: Probe, first: int, count: int, size: float) -> Array:
    """Outputs after each of `count` steps from the number `first` on, shape (count, outputs)."""
    rows = []
    for k in range(first, first + count):
        probe.set(_wave(probe, k))
        probe.step(size)
        rows.append(probe.get())
    return np.array(rows)


def _wave(probe: Probe, k: int) -> Array:
    """Inputs of step `k`: each a little off its start, and none as another."""
    u = probe.at_start.copy()
    for j, v in enumerate(probe.inputs):
        if v.kind == "real":
            off = ((7 * j + 3 * k) % 11 - 5) / 5.0
            u[j] = _bounded(v, u[j] + WAVE * off * max(1.0, abs(u[j])))
    return u


def _bounded(variable: Variable, value: float) -> float:
    low, high = variable.minimum, variable.maximum
    return float(np.clip(value, -np.inf if low is None else low, np.inf if high is None else high))


def _differs(a: Array, b: Array) -> Any:
    return ~((a == b) | (np.isnan(a) & np.isnan(b)))


def _first_difference(probe: Probe, a: Array, b: Array) -> tuple[str, int, float, float] | None:
    """Output, number of steps, and both values where two records differ first."""
    rows, columns = np.nonzero(_differs(a, b))
    if not rows.size:
        return None
    row, column = int(rows[0]), int(columns[0])
    return probe.outputs[column].name, row + 1, float(a[row, column]), float(b[row, column])


def _steps(count: int) -> str:
    return "one step" if count == 1 else f"{count} steps"


def _recommended(component: Component) -> float | None:
    """The step that an FMU recommends [s]."""
    if component.file is None:
        return None
    said = open_fmu(component.file).root.find("DefaultExperiment")
    try:
        size = float("" if said is None else said.get("stepSize", ""))
    except ValueError:
        return None
    return size if 0.0 < size < np.inf else None
