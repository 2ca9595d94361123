"""The 80-ton hopper car: its layout, its parameter sets, and both as a system."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fmus.catalogue import fmu_path, parameters
from orchestrator import Component, System, Value, choices, in_unit

from ..errors import HopperError
from .layout import Layout, Truck

if TYPE_CHECKING:
    from orchestrator import Responses

TRACKS = (
    "report",
    *(f"fra{number}" for number in range(1, 7)),
    "german-low",
    "german-high",
    "perfect",
    "report-grid",
)
"""Spectra of the track block, which spells them with an underscore."""

HOPPER = Layout(
    carbody="carbody",
    trucks=(
        Truck("truck_front", "front", ("wheelset_11", "wheelset_12")),
        Truck("truck_rear", "rear", ("wheelset_21", "wheelset_22")),
    ),
    track="track",
)
"""The trucks' wheelsets are numbered (truck, axle)."""


@dataclass(frozen=True)
class Vehicle:
    """A car that can be run: its layout, and the parameter set of its blocks."""

    layout: Layout
    parameters: str


CARS = {name: Vehicle(HOPPER, name) for name in ("loaded", "empty", "report-linear")}
"""All cars by name. Another car is one more entry."""

SPEED, TRACK, DURATION = 13.4112, "fra5", 60.0
"""A run that nothing else is asked of: 30 mph [m/s], its track, and its duration [s].

Below the critical speed, where motion decays in 10 s; the car stays inside all limits of its
blocks; and with each of 15 seeds the statistics are settled, those of displacements to 11 %.
"""


def hopper_car(
    car: str = "loaded", speed: float | str = SPEED, track: str = TRACK, seed: int = 1
) -> System:
    """The hopper car `car` of `CARS` at `speed` [m/s] on the track `track` of `TRACKS`.

    The speed may be text with a unit, such as "60 ft/s". The FMUs are the catalogue's, built for
    this machine if they are not there. `seed` chooses the realisation of the irregularities. Raises
    HopperError for a car, track or speed that is not.
    """
    layout, speed = vehicle(car).layout, in_unit(speed, "m/s", "speed")
    if track not in TRACKS:
        raise HopperError(f"there is no track '{track}'; {choices(track, TRACKS)}")
    if not 0.0 < speed < float("inf"):
        raise HopperError(f"a speed of {speed:g} m/s cannot be run; give one above zero")

    values: dict[str, dict[str, Value]] = {
        block: {**given} for block, given in parameters_of(car).items()
    }
    values["track"] |= {"spectrum": track.replace("-", "_"), "seed": seed, "speed": speed}
    return System(
        components={
            instance: Component(fmu_path(block), values[block])
            for instance, block in layout.blocks.items()
        },
        connections=(*layout.connections(), *layout.optional_connections()),
        bonds=tuple(layout.bonds()),
    )


def vehicle(car: str) -> Vehicle:
    """A car of `CARS`; raises HopperError for one that is not there."""
    if car not in CARS:
        raise HopperError(f"there is no car '{car}'; {choices(car, CARS)}")
    return CARS[car]


def parameters_of(car: str) -> dict[str, dict[str, float]]:
    """The parameters [SI] of a car of `CARS`, by block and name."""
    return parameters(vehicle(car).parameters)


def instances() -> tuple[str, ...]:
    """The instances that any of `CARS` has."""
    return tuple(dict.fromkeys(name for car in CARS.values() for name in car.layout.blocks))


def layout_of(subject: System | Responses) -> Layout:
    """The layout of the car in a system, or in the results of a run.

    It is a layout of `CARS` whose names the instances have, also with a prefix before each. Else
    the instances are told by what they give; then they must stand in the order of `HOPPER`.
    `HOPPER` where nothing says otherwise.
    """
    from orchestrator import Provenance  # which is not light enough for a command's help

    if isinstance(subject, System):
        names = [*subject.components, *(connection.source for connection in subject.connections)]
    else:
        names = [*Provenance.of(subject).fmus, *map(str, subject.data_vars)]
    return layout_by(names)


def layout_by(names: Iterable[str]) -> Layout:
    """The same by names of instances, and of what they give as "instance.output"."""
    outputs: dict[str, set[str]] = {}
    for name in names:
        instance, _, output = name.partition(".")
        outputs.setdefault(instance, set()).add(output)
    known = dict.fromkeys(car.layout for car in CARS.values())
    named = (found for layout in known for found in _prefixed(layout, outputs))
    return next(named, None) or _by_outputs(outputs) or HOPPER


def _prefixed(layout: Layout, instances: Collection[str]) -> Iterator[Layout]:
    """A layout as the instances have it, under whatever prefix."""
    for name in instances:
        found = layout.renamed(name.removesuffix(layout.carbody).__add__)
        if all(wanted in instances for wanted in found.blocks):
            yield found


def _by_outputs(outputs: Mapping[str, set[str]]) -> Layout | None:
    """The layout whose instances have all outputs that `HOPPER` connects."""
    found = {
        block: [name for name, own in outputs.items() if needed <= own]
        for block, needed in HOPPER.outputs().items()
    }
    if any(len(names) != len(HOPPER.instances(block)) for block, names in found.items()):
        return None
    new = {
        old: name
        for block, names in found.items()
        for old, name in zip(HOPPER.instances(block), names, strict=True)
    }
    return HOPPER.renamed(new.__getitem__)
