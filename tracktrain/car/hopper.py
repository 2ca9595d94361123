"""The 80-ton hopper car as a system: eight instances of four blocks, and what they exchange."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING

from ..errors import (
    HopperError,
    choices,
)

if TYPE_CHECKING:
    from orchestrator import (
        Connection,
        PowerBond,
        System,
    )
    from orchestrator.system.system import Value

CARS = ("loaded", "empty", "report-linear")
"""Parameter sets that a hopper car may have."""

TRACKS = (
    "report",
    *(f"fra{number}" for number in range(1, 7)),
    "german-low",
    "german-high",
    "perfect",
)
"""Spectra of the track block, which spells them with an underscore."""

BLOCK_OF = {
    "carbody": "carbody",
    "truck_front": "truck",
    "truck_rear": "truck",
    "wheelset_11": "wheelrail",
    "wheelset_12": "wheelrail",
    "wheelset_21": "wheelrail",
    "wheelset_22": "wheelrail",
    "track": "track",
}
"""The block of each instance; the trucks' wheelsets are numbered (truck, axle)."""

TRUCKS = ("truck_front", "truck_rear")

WHEELSETS = {
    (truck, axle): f"wheelset_{number}{axle}"
    for number, truck in enumerate(TRUCKS, start=1)
    for axle in (1, 2)
}
"""The wheelset of each truck's axle."""

REPORT_SPEED = 18.288
"""60 ft/s [m/s], the slowest of the report's three speeds."""


def hopper_car(
    car: str = "loaded", speed: float = REPORT_SPEED, track: str = "report", seed: int = 1
) -> System:
    """The hopper car `car` of `CARS` at `speed` [m/s] on the track `track` of `TRACKS`.

    The FMUs are the catalogue's, built for this machine if they are not there. `seed` chooses the
    realisation of the irregularities. Raises HopperError for a car, track or speed that is not.
    """
    from fmus.catalogue import fmu_path
    from orchestrator import (
        Component,
        System,
    )

    if car not in CARS:
        raise HopperError(f"there is no car '{car}'; {choices(car, CARS)}")
    if track not in TRACKS:
        raise HopperError(f"there is no track '{track}'; {choices(track, TRACKS)}")
    if not 0.0 < speed < float("inf"):
        raise HopperError(f"a speed of {speed:g} m/s cannot be run; give one above zero")

    values: dict[str, dict[str, Value]] = {
        block: {**given} for block, given in _parameters(car).items()
    }
    values["track"] |= {"spectrum": track.replace("-", "_"), "seed": seed, "speed": speed}
    return System(
        components={
            instance: Component(fmu_path(block), values[block])
            for instance, block in BLOCK_OF.items()
        },
        connections=tuple(_connections()),
        bonds=tuple(_bonds()),
    )


@cache
def _parameters(car: str) -> dict[str, dict[str, float]]:
    """The set's values [SI] by block, read once: building the blocks takes its time."""
    from fmus import BLOCKS
    from fmus.describe.parameters import parameter_set

    parameters = parameter_set(car)
    return {block: parameters.values(BLOCKS[block]()) for block in set(BLOCK_OF.values())}


def required_ports(instance: str) -> frozenset[str]:
    """Names of the variables that an FMU standing in for `instance` must have."""
    ends = [end for c in _connections() for end in (c.source, c.target)]
    owned = (end.partition(".")[::2] for end in ends)
    return frozenset(name for owner, name in owned if owner == instance)


def _connections() -> Iterator[Connection]:
    from orchestrator import Connection

    sides = ("left", "right")
    for truck, end in enumerate(("front", "rear"), start=1):
        frame = f"truck_{end}"
        for motion in ("y", "z", "roll", "yaw", "vy", "vz", "wx", "wz"):
            yield Connection(f"carbody.{end}.{motion}", f"{frame}.car.{motion}")
        for force in ("force_y", "force_z", "moment_x", "moment_z"):
            yield Connection(f"{frame}.car.{force}", f"carbody.{end}.{force}")
        for axle in (1, 2):
            wheelset = f"wheelset_{truck}{axle}"
            rails = f"track.axle[{2 * (truck - 1) + axle}]"
            for motion in ("y", "yaw", "vy", "wz"):
                yield Connection(f"{frame}.axle[{axle}].{motion}", f"{wheelset}.{motion}")
            for force in ("force_y", "moment_z"):
                yield Connection(f"{wheelset}.{force}", f"{frame}.axle[{axle}].{force}")
            for side in sides:
                load, height = f"axle[{axle}].load_{side}", f"axle[{axle}].rail_z_{side}"
                yield Connection(f"{frame}.{load}", f"{wheelset}.load_{side}")
                yield Connection(f"{rails}.rail_y_{side}", f"{wheelset}.rail_y_{side}")
                yield Connection(f"{rails}.rail_z_{side}", f"{frame}.{height}")
            yield Connection("track.speed_out", f"{wheelset}.speed")


def _bonds() -> Iterator[PowerBond]:
    """Each force or moment with the velocity that it works on."""
    from orchestrator import PowerBond

    velocity_of = {"force_y": "vy", "force_z": "vz", "moment_x": "wx", "moment_z": "wz"}
    for truck, end in enumerate(("front", "rear"), start=1):
        for force, velocity in velocity_of.items():
            yield PowerBond(f"truck_{end}.car.{force}", f"carbody.{end}.{velocity}")
        for axle in (1, 2):
            for force in ("force_y", "moment_z"):
                wheelset, motion = f"wheelset_{truck}{axle}", velocity_of[force]
                yield PowerBond(f"{wheelset}.{force}", f"truck_{end}.axle[{axle}].{motion}")
