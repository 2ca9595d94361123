"""The coupled car for small motion, out of its FMUs' directional derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import product
from math import isclose, nan
from pathlib import Path

import numpy as np

from fmus.carbody.modal_data import ModalData
from fmus.catalogue import fmu_path
from orchestrator import (
    Component,
    LinearModel,
    OrchestratorError,
    System,
    Value,
    describe,
    in_unit,
    linearised,
)

from .friction import LARGE, damping, kinds, to_rates
from .hopper import layout_of
from .layout import SIDES, Layout
from .linear_motion import Array, Complex, LinearMotion, Parameter
from .rolling_line import lines_of
from .spreads import Uncertain
from .values import values_of

SPEEDS, BETWEEN = (10.0, 40.0), 20.0
"""Two speeds [m/s]: a creepage is a motion over the speed, so that A = B + C/V, whatever the creep
law, and two matrices make all; and one to see whether that holds."""

ROUNDING = 1e-9
"""Of a matrix, over its largest element."""

STEP = 1e-4
"""Of differences by a number, over the number: they are wrong by its square."""

SAME = 1e-9
"""Relative difference of a run's number and the known one up to which they are the same."""


class LinearFmus(LinearMotion):
    """dx/dt = A x of a car on perfect track, flange open, about the lines on which its wheelsets
    run straight.

    given: parameters by instance, as its FMU has them; what is not given is as in the FMU. body:
    modal data of the carbody and its FMU, where it is not the default one. fmus: by instance, of
    wheelsets that are not the default ones. friction, omega: as of `LinearCar`.
    """

    def __init__(
        self,
        layout: Layout,
        given: Mapping[str, Mapping[str, Value]],
        body: tuple[ModalData, Path] | None = None,
        fmus: Mapping[str, Path] | None = None,
        friction: str | Mapping[str, str] = "stuck",
        omega: float = 2 * np.pi,
    ) -> None:
        self.layout, self.carbody = layout, body[0] if body else None
        self.friction, self.omega = kinds(friction), omega
        files = {name: fmu_path(b) for name, b in layout.blocks.items() if name != layout.track}
        if body:
            files[layout.carbody] = body[1]
        files |= fmus or {}
        self._components = {
            name: Component(
                path, {k: v for k, v in given[name].items() if not k.startswith("initial.")}
            )
            for name, path in files.items()
        }

    @classmethod
    def of(
        cls, system: System, friction: str | Mapping[str, str] = "stuck", omega: float = 2 * np.pi
    ) -> LinearFmus:
        """Of a car of this carbody and these trucks, on whatever wheelsets."""
        layout = layout_of(system)
        given = {name: component.parameters for name, component in system.components.items()}
        wheelsets = [axle.wheelset for axle in layout.axles]
        fmus = {name: Path(str(system.components[name].fmu)) for name in wheelsets}
        return cls(layout, given, None, fmus, friction, omega)

    def values(self, block: str) -> Mapping[str, float]:
        return self._values[self.layout.instances(block)[0]]

    @property
    def parameters(self) -> list[Parameter]:
        """The numbers of the car: all but options and initial values."""
        found: dict[str, list[str]] = {}
        for instance, own in self._values.items():
            for name in own:
                if not name.startswith("initial.") and name != "micro_step":
                    found.setdefault(name, []).append(instance)
        return [self._parameter(name, instances) for name, instances in found.items()]

    def _parameter(self, name: str, instances: Sequence[str]) -> Parameter:
        blocks = dict.fromkeys(self.layout.blocks[instance] for instance in instances)
        first, *others = (self._values[instance][name] for instance in instances)
        stated = describe(Path(str(self._components[instances[0]].fmu))).variables[name]
        value = first if all(isclose(first, other, rel_tol=SAME) for other in others) else nan
        return Parameter(name, tuple(blocks), value, stated.unit or "1", stated.description)

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        return self._parts[0]

    @cached_property
    def holds(self) -> bool:
        """Whether its FMUs give derivatives, and their forces go with the speed as creepages do."""
        try:
            _, (between,) = self._linearised(BETWEEN)
        except OrchestratorError:
            return False
        apart = np.abs(self.matrix(BETWEEN) - between).max()
        return bool(apart <= ROUNDING * np.abs(between).max())

    def matrix(self, speed: float) -> Array:
        _, still, moving = self._parts
        return still + moving / speed

    def slopes_along(
        self, speed: float, root: complex, numbers: Sequence[Uncertain]
    ) -> tuple[dict[str, complex], complex]:
        """By differences of the FMUs' derivatives."""
        weights, found = self.weights(speed, root), {}
        with linearised(self._system(speed), record=[]) as model:
            still = self._matrix(model, {})
            for number in numbers:
                places = self.places(number)
                if not places:
                    continue

                def matrix(
                    value: float, number: Uncertain = number, places: Places = places
                ) -> Array:
                    changes = number.changes(value)
                    own = {place: changes[name] for place, name in places.items()}
                    return self._matrix(model, own)

                found[number.name] = complex((weights * _slope(matrix, still, number)).sum())
        return found, self._by_speed(weights, speed)

    def relative_slopes(self, speed: float, root: complex) -> tuple[dict[str, complex], complex]:
        """By differences of the FMUs' derivatives."""
        weights = self.weights(speed, root)
        found = {
            p.name: complex((weights * (more - less)).sum()) / (2 * STEP)
            for p, more, less in self.moved(speed, STEP)
        }
        return found, self._by_speed(weights, speed)

    def moved(self, speed: float, share: float) -> Iterator[tuple[Parameter, Array, Array]]:
        with linearised(self._system(speed), record=[]) as model:
            for p in self.parameters:
                own = {
                    f"{instance}.{p.name}": values[p.name]
                    for instance, values in self._values.items()
                    if p.name in values
                }
                more, less = (
                    self._matrix(model, {place: (1 + s * share) * v for place, v in own.items()})
                    for s in (1, -1)
                )
                yield p, more, less

    def _by_speed(self, weights: Complex, speed: float) -> complex:
        return complex((weights * -self._parts[2] / speed**2).sum())

    def places(self, number: Uncertain) -> Places:
        """Where the car has a number, and what follows it, as it is known.

        Nowhere if a block has it nowhere: what took its place there holds for the other blocks.
        """
        known, blocks = number.changes(number.spread.value), self.layout.blocks
        places = {
            f"{instance}.{name}": name
            for instance, component in self._components.items()
            for name, value in known.items()
            if _has(component, name, value, number.unit)
        }
        having = {blocks[place.partition(".")[0]] for place in places}
        return places if having >= {*number.blocks} else {}

    @cached_property
    def _parts(self) -> tuple[tuple[str, ...], Array, Array]:
        """The states; B, and C of A = B + C/V."""
        states, (first, second) = self._linearised(*SPEEDS)
        moving = (first - second) / (1.0 / SPEEDS[0] - 1.0 / SPEEDS[1])
        return states, first - moving / SPEEDS[0], moving

    def _linearised(self, *speeds: float) -> tuple[tuple[str, ...], list[Array]]:
        """The states, and A at each speed [m/s]."""
        with linearised(self._system(speeds[0]), record=[]) as model:
            matrices = [
                self._matrix(model, {f"{wheelset}.speed": speed for wheelset in self._rails})
                for speed in speeds
            ]
            return model({}).states, matrices

    def _matrix(
        self, model: Callable[[Mapping[str, Value]], LinearModel], values: Mapping[str, float]
    ) -> Array:
        """A with these values, friction as it is to stand for.

        It is affine in each friction stiffness, so that what an element's spring does is what goes
        with its stiffness.
        """
        found = model(values)
        total = found.a
        for truck, (element, kind) in product(self.layout.trucks, self.friction.items()):
            if kind == "stuck":
                continue
            own = {
                name: values.get(f"{truck.instance}.{element}.{name}", known)
                for name in ("friction_stiffness", "friction_limit", "stop_stiffness", "free_play")
                for known in [self._values[truck.instance][f"{element}.{name}"]]
            }
            stiffness, limit = own["friction_stiffness"], own["friction_limit"]
            none = {f"{truck.instance}.{element}.friction_stiffness": 0.0}
            spring = found.a - model({**values, **none}).a
            total = total - spring
            if kind == "damper" and stiffness > 0.0:
                stopped = own["stop_stiffness"] > 0.0
                amplitude = own["free_play"] if stopped else LARGE * limit / stiffness
                c = damping(limit, amplitude, self.omega)
                total = total + c / stiffness * spring @ to_rates(found.states)
        return total

    @cached_property
    def _values(self) -> Mapping[str, Mapping[str, float]]:
        """The real parameters of all instances."""
        return {name: values_of(component) for name, component in self._components.items()}

    @cached_property
    def _rails(self) -> Mapping[str, Mapping[str, float]]:
        """Where each wheelset's rails are [m], so that it runs straight with its middle at 0."""
        wheelsets = [axle.wheelset for axle in self.layout.axles]
        lines = lines_of({name: Path(str(self._components[name].fmu)) for name in wheelsets})
        return {
            name: {f"rail_y_{side}": -line for side in SIDES} if line else {}
            for name, line in lines.items()
        }

    def _system(self, speed: float) -> System:
        components = dict(self._components)
        for name, rails in self._rails.items():
            own = components[name]
            components[name] = Component(own.fmu, {**own.parameters, **rails, "speed": speed})
        track = f"{self.layout.track}."
        links = [c for c in self.layout.connections() if not c.source.startswith(track)]
        return System(components, tuple(links))


Places = Mapping[str, str]
"""Names of parameters by "instance.parameter"."""


def _has(component: Component, name: str, value: float, unit: str) -> bool:
    """Whether a parameter of an instance is what it is known to be [unit]."""
    variable = describe(Path(str(component.fmu))).find(name)
    if variable is None or (variable.unit or "1") != unit:
        return False
    given = component.parameters.get(name)
    own = float(variable.start or 0.0) if given is None else in_unit(given, unit, name)
    return isclose(own, value, rel_tol=SAME)


def _slope(matrix: Callable[[float], Array], still: Array, number: Uncertain) -> Array:
    """Derivative of a matrix by a number where it is, from values inside its range."""
    spread = number.spread
    value = spread.value
    h = STEP * (abs(value) or spread.standard_deviation)
    low = -np.inf if spread.low is None else spread.low
    high = np.inf if spread.high is None else spread.high
    if value + h > high:
        h = -h
    first = matrix(value + h)
    if np.array_equal(first, still):
        return np.zeros_like(still)
    if low <= value - h <= high:
        return (first - matrix(value - h)) / (2 * h)
    return (4 * first - 3 * still - matrix(value + 2 * h)) / (2 * h)
