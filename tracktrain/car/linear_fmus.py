"""The coupled car for small motion, out of its FMUs' directional derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from math import isclose
from pathlib import Path

import numpy as np

from fmus.carbody.modal_data import ModalData
from fmus.catalogue import fmu_path, parameters
from orchestrator import Component, System, Value, describe, in_unit, linearise, linearised

from .hopper import layout_of
from .layout import SIDES, Layout
from .linear_motion import Array, LinearMotion
from .rolling_line import line_of
from .spreads import Uncertain

SPEEDS = (10.0, 40.0)
"""Two speeds [m/s]: a creepage is a motion over the speed, so that A = B + C/V, whatever the creep
law, and two matrices make all."""

STEP = 1e-4
"""Of differences by a number, over the number: they are wrong by its square."""

SAME = 1e-9
"""Relative difference of a run's number and the known one up to which they are the same."""


class LinearFmus(LinearMotion):
    """dx/dt = A x of a car on perfect track, flange open, all friction stuck, about the lines on
    which its wheelsets run straight.

    given: parameters by instance, as its FMU has them; what is not given is as in the FMU. body:
    modal data of the carbody and its FMU, where it is not the default one. fmus: by instance, of
    wheelsets that are not the default ones.
    """

    def __init__(
        self,
        layout: Layout,
        given: Mapping[str, Mapping[str, Value]],
        body: tuple[ModalData, Path] | None = None,
        fmus: Mapping[str, Path] | None = None,
    ) -> None:
        self.layout, self.carbody = layout, body[0] if body else None
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
        front = given[layout.front.instance]
        numbers = {k: float(v) for k, v in front.items() if isinstance(v, (int, float))}
        self._truck = {**parameters("loaded")["truck"], **numbers}

    @classmethod
    def of(cls, system: System) -> LinearFmus:
        """Of a car of this carbody and these trucks, on whatever wheelsets."""
        layout = layout_of(system)
        given = {name: component.parameters for name, component in system.components.items()}
        wheelsets = [axle.wheelset for axle in layout.axles]
        fmus = {name: Path(str(system.components[name].fmu)) for name in wheelsets}
        return cls(layout, given, fmus=fmus)

    @property
    def truck(self) -> Mapping[str, float]:
        return self._truck

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        return self._parts[0]

    def matrix(self, speed: float) -> Array:
        _, still, moving = self._parts
        return still + moving / speed

    def slopes_along(
        self, speed: float, root: complex, numbers: Sequence[Uncertain]
    ) -> tuple[dict[str, complex], complex]:
        """By differences of the FMUs' derivatives."""
        weights, (_, _, moving) = self.weights(speed, root), self._parts
        found = {}
        with linearised(self._system(speed), record=[]) as model:
            still = model({}).a
            for number in numbers:
                places = self.places(number)
                if not places:
                    continue

                def matrix(
                    value: float, number: Uncertain = number, places: Places = places
                ) -> Array:
                    changes = number.changes(value)
                    return model({place: changes[name] for place, name in places.items()}).a

                found[number.name] = complex((weights * _slope(matrix, still, number)).sum())
        return found, complex((weights * -moving / speed**2).sum())

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
        (first, states), (second, _) = map(self._linearised, SPEEDS)
        moving = (first - second) / (1.0 / SPEEDS[0] - 1.0 / SPEEDS[1])
        return states, first - moving / SPEEDS[0], moving

    def _linearised(self, speed: float) -> tuple[Array, tuple[str, ...]]:
        found = linearise(self._system(speed), record=[])
        return found.a, found.states

    @cached_property
    def _rails(self) -> Mapping[str, Mapping[str, float]]:
        """Where each wheelset's rails are [m], so that it runs straight with its middle at 0."""
        wheelsets = [axle.wheelset for axle in self.layout.axles]
        fmus = {name: Path(str(self._components[name].fmu)) for name in wheelsets}
        lines = {fmu: line_of(fmu) for fmu in {*fmus.values()}}  # all wheelsets may share one
        return {
            name: {f"rail_y_{side}": -lines[fmu] for side in SIDES} if lines[fmu] else {}
            for name, fmu in fmus.items()
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
