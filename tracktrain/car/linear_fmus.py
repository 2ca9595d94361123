"""The coupled car for small motion, out of its FMUs' directional derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path

from fmus.carbody.modal_data import ModalData
from fmus.catalogue import fmu_path, parameters
from orchestrator import Component, System, Value, linearise

from .layout import Layout
from .linear_motion import Array, LinearMotion

SPEEDS = (10.0, 40.0)
"""Two speeds [m/s]: a creepage is a motion over the speed, so that A = B + C/V, whatever the creep
law, and two matrices make all."""


class LinearFmus(LinearMotion):
    """dx/dt = A x of a car on perfect track, flange open, all friction stuck.

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

    @property
    def truck(self) -> Mapping[str, float]:
        return self._truck

    @property
    def states(self) -> tuple[str, ...]:  # type: ignore[override]
        return self._parts[0]

    def matrix(self, speed: float) -> Array:
        _, still, moving = self._parts
        return still + moving / speed

    @cached_property
    def _parts(self) -> tuple[tuple[str, ...], Array, Array]:
        """The states; B, and C of A = B + C/V."""
        (first, states), (second, _) = map(self._linearised, SPEEDS)
        moving = (first - second) / (1.0 / SPEEDS[0] - 1.0 / SPEEDS[1])
        return states, first - moving / SPEEDS[0], moving

    def _linearised(self, speed: float) -> tuple[Array, tuple[str, ...]]:
        components = dict(self._components)
        for axle in self.layout.axles:
            own = components[axle.wheelset]
            components[axle.wheelset] = Component(own.fmu, {**own.parameters, "speed": speed})
        track = f"{self.layout.track}."
        links = [c for c in self.layout.connections() if not c.source.startswith(track)]
        found = linearise(System(components, tuple(links)), record=[])
        return found.a, found.states
