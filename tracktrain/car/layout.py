"""How a car is put together, as data: its instances, what they are, and what they exchange."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from orchestrator import Connection, PowerBond

from ..scales import ACCELERATION, DISPLACEMENT, FORCE, RATIO, Scale

SIDES = ("left", "right")
VELOCITY_OF = {"force_y": "vy", "force_z": "vz", "moment_x": "wx", "moment_z": "wz"}
"""What each force and moment works on."""
FRAME = ("ay", "az", "wx_dot", "wz_dot")
"""Accelerations of the car's frame in a curve."""


@dataclass(frozen=True)
class Axle:
    """An axle: what its truck's variables begin with, and the instance of its wheelset."""

    port: str
    wheelset: str


@dataclass(frozen=True)
class Truck:
    """A truck: its instance, the carbody's end above it, and its wheelsets, leading first."""

    instance: str
    end: str
    wheelsets: tuple[str, ...]

    @property
    def axles(self) -> tuple[Axle, ...]:
        return tuple(
            Axle(f"{self.instance}.axle[{number}]", wheelset)
            for number, wheelset in enumerate(self.wheelsets, start=1)
        )


@dataclass(frozen=True)
class Shown:
    """A number that tables and pictures show: its variable, what it is called, and its units."""

    variable: str
    label: str
    scale: Scale


@dataclass(frozen=True)
class Layout:
    """Names of a car's instances by what they are; trucks from the leading one to the trailing."""

    carbody: str
    trucks: tuple[Truck, ...]
    track: str

    @cached_property
    def blocks(self) -> Mapping[str, str]:
        """The block of each instance."""
        return {
            self.carbody: "carbody",
            **{truck.instance: "truck" for truck in self.trucks},
            **{axle.wheelset: "wheelrail" for axle in self.axles},
            self.track: "track",
        }

    def instances(self, block: str) -> tuple[str, ...]:
        """The instances of a block."""
        return tuple(name for name, kind in self.blocks.items() if kind == block)

    @property
    def axles(self) -> tuple[Axle, ...]:
        """All axles, the leading one first."""
        return tuple(axle for truck in self.trucks for axle in truck.axles)

    @property
    def front(self) -> Truck:
        """The leading truck."""
        return self.trucks[0]

    @property
    def leading(self) -> Axle:
        """The leading axle."""
        return self.axles[0]

    def plate(self, truck: Truck) -> str:
        """What the carbody's variables at a truck's centre plate begin with."""
        return f"{self.carbody}.{truck.end}"

    @property
    def speed(self) -> str:
        """The output that has the speed [m/s]."""
        return f"{self.track}.speed_out"

    @property
    def distance(self) -> str:
        """The output that has the distance run [m]."""
        return f"{self.track}.distance"

    @property
    def rails(self) -> Mapping[str, str]:
        """The rails under the leading axle [m], by axis and side as in "y_left"."""
        names = (f"{axis}_{side}" for axis in "yz" for side in SIDES)
        return {name: f"{self.track}.axle[1].rail_{name}" for name in names}

    @property
    def bodies(self) -> tuple[str, ...]:
        """The instances that move: the carbody and the trucks."""
        return (self.carbody, *(truck.instance for truck in self.trucks))

    def coordinates(self, modes: int = 8) -> tuple[str, ...]:
        """The coordinates of the carbody (its modes) and of each truck (6)."""
        counts = {"carbody": modes, "truck": 6}
        return tuple(
            f"{name}.q[{i}]"
            for name in self.bodies
            for i in range(1, counts[self.blocks[name]] + 1)
        )

    @property
    def quantities(self) -> Mapping[str, Shown]:
        """What a run prints, by name."""
        wheelset, centre = self.leading.wheelset, f"{self.carbody}.cg"
        return {
            "force": Shown(f"{wheelset}.force_y", "lateral force", FORCE),
            "displacement": Shown(f"{wheelset}.y_rel", "displacement to rail", DISPLACEMENT),
            "ratio_left": Shown(f"{wheelset}.left.l_over_v", "L/V of left wheel", RATIO),
            "ratio_right": Shown(f"{wheelset}.right.l_over_v", "L/V of right wheel", RATIO),
            "lateral_acceleration": Shown(f"{centre}.ay", "lateral acceleration", ACCELERATION),
            "vertical_acceleration": Shown(f"{centre}.az", "vertical acceleration", ACCELERATION),
        }

    @property
    def printed(self) -> tuple[str, ...]:
        """The variables of `quantities`, whose numbers a sweep takes."""
        return tuple(shown.variable for shown in self.quantities.values())

    def renamed(self, name: Callable[[str], str]) -> Layout:
        """The same layout with other names of its instances."""
        trucks = (
            Truck(name(truck.instance), truck.end, tuple(map(name, truck.wheelsets)))
            for truck in self.trucks
        )
        return Layout(name(self.carbody), tuple(trucks), name(self.track))

    def prefixed(self, prefix: str) -> Layout:
        """The same layout, as `System.prefixed` names the instances."""
        return self.renamed(lambda name: f"{prefix}:{name}")

    def outputs(self) -> dict[str, set[str]]:
        """Outputs that others need, by block."""
        found: dict[str, set[str]] = {}
        for connection in self.connections():
            instance, _, output = connection.source.partition(".")
            found.setdefault(self.blocks[instance], set()).add(output)
        return found

    def connections(self) -> Iterator[Connection]:
        """What the instances must exchange."""
        rails = (f"{self.track}.axle[{n}]" for n in range(1, len(self.axles) + 1))
        for truck in self.trucks:
            plate, car = self.plate(truck), f"{truck.instance}.car"
            for motion in ("y", "z", "roll", "yaw", "vy", "vz", "wx", "wz"):
                yield Connection(f"{plate}.{motion}", f"{car}.{motion}")
            for force in VELOCITY_OF:
                yield Connection(f"{car}.{force}", f"{plate}.{force}")
            for axle, rail in zip(truck.axles, rails, strict=False):
                for motion in ("y", "yaw", "vy", "wz"):
                    yield Connection(f"{axle.port}.{motion}", f"{axle.wheelset}.{motion}")
                for force in ("force_y", "moment_z"):
                    yield Connection(f"{axle.wheelset}.{force}", f"{axle.port}.{force}")
                for side in SIDES:
                    yield Connection(f"{axle.port}.load_{side}", f"{axle.wheelset}.load_{side}")
                    yield Connection(f"{rail}.rail_y_{side}", f"{axle.wheelset}.rail_y_{side}")
                    yield Connection(f"{rail}.rail_z_{side}", f"{axle.port}.rail_z_{side}")
                yield Connection(self.speed, f"{axle.wheelset}.speed")

    def optional_connections(self) -> Iterator[Connection]:
        """What they exchange where both ends have it: the accelerations of the rails."""
        for number, axle in enumerate(self.axles, start=1):
            for side in SIDES:
                acceleration = f"rail_az_{side}"
                rail = f"{self.track}.axle[{number}]"
                yield Connection(f"{rail}.{acceleration}", f"{axle.port}.{acceleration}")

    def curve_connections(self) -> Iterator[Connection]:
        """What a track with curves gives besides: accelerations of the frame, the way over ground.

        Those of the trucks come last.
        """
        for number, axle in enumerate(self.axles, start=1):
            yield Connection(f"{self.track}.axle[{number}].path_yaw", f"{axle.wheelset}.path_yaw")
            yield Connection(f"{self.track}.curvature", f"{axle.wheelset}.path_curvature")
        for name in FRAME:
            yield Connection(f"{self.track}.frame.{name}", f"{self.carbody}.frame.{name}")
        yield from self.trucks_in_curves()

    def trucks_in_curves(self) -> Iterator[Connection]:
        """Those that carry the trucks' own masses along, which a truck may do without."""
        for number, truck in enumerate(self.trucks, start=1):
            for name in FRAME:
                source = f"truck[{number}].ay" if name == "ay" else f"frame.{name}"
                yield Connection(f"{self.track}.{source}", f"{truck.instance}.frame.{name}")

    def bonds(self) -> Iterator[PowerBond]:
        """Each force or moment with the velocity that it works on."""
        for truck in self.trucks:
            for force, velocity in VELOCITY_OF.items():
                yield PowerBond(f"{truck.instance}.car.{force}", f"{self.plate(truck)}.{velocity}")
            for axle in truck.axles:
                for force in ("force_y", "moment_z"):
                    velocity = VELOCITY_OF[force]
                    yield PowerBond(f"{axle.wheelset}.{force}", f"{axle.port}.{velocity}")
