"""A run of the car as the rules see it: signals by name, filtered, in windows of time or way."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from orchestrator import Provenance, Responses, Signal, dominant_frequency

from ..car.hopper import layout_of
from ..car.layout import SIDES, Axle, Truck
from ..events import Nadal, nadal_rule
from ..geometry.sections import Section, curves, sections
from ..rows import together
from ..scales import REST
from ..statistics import without_curves
from . import windows
from .rules import Band, ForeignError, NotApplicableError, Rule, parameter

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
SAMPLES_PER_CYCLE = 4
"""At the upper corner of a filter, at least."""

LEAST_CURVE = 20.0
"""Of a full curve [m], somewhat more than the car's length."""

LONG_ENOUGH = 1 - 1e-9
"""Share of a window at which a run is as long as it, to rounding."""


class Car:
    """Signals of a run of the car; all of them raise NotApplicableError where the run lacks one.

    Where the system has no such instance, it is a ForeignError.
    """

    def __init__(self, dataset: Responses) -> None:
        self._dataset, self.layout = dataset, layout_of(dataset)
        said = Provenance.of(dataset)
        outputs = {str(name).partition(".")[0] for name in dataset.data_vars}
        self._instances = outputs | said.fmus.keys()
        if not self._instances & self.layout.blocks.keys():
            raise ForeignError("the system is no car")
        self.time = dataset["time"].values
        if len(self.time) < 2:
            raise NotApplicableError("the run has no more than one row")
        self.rate = (len(self.time) - 1) / float(self.time[-1] - self.time[0])
        together(dataset, self._looked_at)
        self._parameters = said.parameters
        self._moved: list[bool] = []

    @property
    def _looked_at(self) -> set[str]:
        """What the rules look at, if the run has it."""
        layout, sides = self.layout, [(a, side) for a in self.layout.axles for side in SIDES]
        bodies = [f"{layout.carbody}.cg", *map(layout.plate, layout.trucks)]
        return {
            layout.distance,
            *(f"{axle.wheelset}.{side}.l_over_v" for axle, side in sides),
            *(f"{axle.port}.load_{side}" for axle, side in sides),
            *(f"{axle.wheelset}.force_y" for axle in layout.axles),
            *(f"{axle.port}.vy" for axle in layout.axles),
            *(f"{body}.{name}" for body in bodies for name in ("ay", "az")),
            f"{layout.carbody}.cg.roll",
        }

    def __getitem__(self, name: str) -> Array:
        values = self._read(name)
        rest = REST.get(str(self._dataset[name].attrs.get("units")), 0.0)
        self._moved.append(bool(np.any(np.abs(values) > rest)))
        return values

    def excited(self) -> bool:
        """Whether any signal that was taken since the last call left its rest; True where none was.

        Loads rest at what they carry, everything else at zero.
        """
        moved, self._moved = self._moved, []
        return any(moved) or not moved

    def _read(self, name: str) -> Array:
        if name not in self._dataset:
            raise self._lacking(name)(f"the run has no {name}")
        return np.asarray(self._dataset[name].values, dtype=float)

    def parameter(self, name: str) -> float:
        """A parameter of an instance [SI]."""
        if name not in self._parameters:
            raise self._lacking(name)(f"the run does not say {name}")
        return float(self._parameters[name])

    def _lacking(self, name: str) -> type[NotApplicableError]:
        known = name.partition(".")[0] in self._instances
        return NotApplicableError if known else ForeignError

    @cached_property
    def distance(self) -> Array:
        """Way run since the start [m]."""
        way = self._read(self.layout.distance)
        return way - way[0]

    def of_track(self, name: str) -> Array | None:
        """What the track says of itself at each row, such as its curvature; None where it does not.

        Its value is no motion of the car.
        """
        variable = f"{self.layout.track}.{name}"
        return self._read(variable) if variable in self._dataset else None

    @cached_property
    def speed(self) -> float:
        """Largest speed of the run [m/s]; 0 where the way is not known."""
        if self.layout.distance not in self._dataset:
            return 0.0
        return float(np.abs(np.gradient(self.distance, self.time)).max())

    @cached_property
    def speeds(self) -> Array:
        """[m/s]"""
        return np.asarray(np.gradient(self.distance, self.time))

    @cached_property
    def curves(self) -> list[tuple[Section, Rows]]:
        """The full curves, and the rows in which the car's middle is in each; ends are kept off
        by what `sections` takes for the transition."""
        bent = f"{self.layout.track}.curvature", f"{self.layout.track}.cant"
        if bent[0] not in self._dataset:
            raise NotApplicableError("it is assessed in curves, and the track is straight")
        found = []
        for section in curves(sections(self.distance, *(self._read(name) for name in bent))):
            inside = (self.distance > section.first) & (self.distance < section.last)
            rows = np.flatnonzero(inside)
            if rows.size > 1 and section.length > LEAST_CURVE:
                found.append((section, rows))
        if not found:
            raise NotApplicableError("it is assessed in curves, and the run is in no full one")
        return found

    def load(self, axle: Axle, side: str, rule: Rule) -> Array:
        """Vertical force of a wheel on its rail [N]."""
        load = self._read(f"{axle.port}.load_{side}")
        self._moved.append(bool(np.ptp(load) > REST["N"]))
        return self.filtered(load, rule.band)

    def lateral(self, axle: Axle, side: str, rule: Rule) -> Array:
        """Outward force of a wheel on its rail [N]."""
        ratio = self[f"{axle.wheelset}.{side}.l_over_v"]
        load = self._read(f"{axle.port}.load_{side}")
        return self.filtered(ratio * load, rule.band)

    def net_lateral(self, axle: Axle, rule: Rule) -> Array:
        """Lateral force of the rails on a wheelset [N]."""
        return self.filtered(self[f"{axle.wheelset}.force_y"], rule.band)

    def axle_acceleration(self, axle: Axle) -> Array:
        """Lateral acceleration of a wheelset and of the side frames above it [m/s2]."""
        return np.gradient(self[f"{axle.port}.vy"], 1 / self.rate)

    @cached_property
    def nadal(self) -> Nadal:
        """The rule for a wheel's L/V, of the wheels of the run."""
        return nadal_rule(self._dataset)

    def static_axle_load(self, truck: Truck) -> float:
        """[N]"""
        return self.parameter(f"{truck.instance}.axle_load")

    @property
    def least_axle_load(self) -> float:
        """The smallest static load of any axle [N]."""
        return min(map(self.static_axle_load, self.layout.trucks))

    def truck_mass(self, truck: Truck) -> float:
        """[kg]"""
        masses = {"wheelset_mass": 2, "side_frame_mass": 2, "bolster_mass": 1}
        return sum(n * self.parameter(f"{truck.instance}.{name}") for name, n in masses.items())

    def ends(self, quantity: str, rule: Rule) -> Iterator[tuple[str, Array]]:
        """A motion of the carbody above each truck, in the rule's band, by place."""
        for truck in self.layout.trucks:
            place = f"{self.layout.carbody} {truck.end}"
            yield place, self.filtered(self[f"{self.layout.plate(truck)}.{quantity}"], rule.band)

    def floor_ends(self, quantity: str, rule: Rule) -> Iterator[tuple[str, Array]]:
        """A motion near the carbody's ends at floor level, in the rule's band, by place.

        The body is taken as rigid: the motions above the trucks go on to its ends in a straight
        line, and roll, by which they differ from that of the centre of gravity, adds to the height.
        """
        body = self.layout.carbody
        reach = self.parameter(f"{body}.body_length") / 2
        reach /= self.parameter(f"{body}.half_truck_spacing")
        front, rear = (self[f"{self.layout.plate(t)}.{quantity}"] for t in self.layout.trucks)
        mean, half = (front + rear) / 2, (front - rear) / 2
        if quantity == "ay":
            plate = self.parameter(f"{self.layout.front.instance}.centre_plate_height")
            height = self.parameter(f"{body}.gravity_centre_height")
            roll = (mean - self[f"{body}.cg.{quantity}"]) / height
            mean = mean - (parameter("floor_height") - plate) * roll
        for truck, side in zip(self.layout.trucks, (1, -1), strict=True):
            yield f"{body} {truck.end} end", self.filtered(mean + side * reach * half, rule.band)

    def filtered(self, values: Array, band: Band | None) -> Array:
        """The values in a band: Butterworth filters of second order, forwards and backwards."""
        if band is None:
            return values
        low, high = band.low, band.high
        if band.around:
            middle = self._dominant(values)
            low, high = max(middle - band.around, 0.0), middle + band.around
        if self.rate < SAMPLES_PER_CYCLE * high:
            raise NotApplicableError(
                f"{self.rate:.4g} rows a second are too few for a filter at {high:.3g} Hz"
            )
        corners, kind = ((low, high), "bandpass") if low else (high, "lowpass")
        sections = signal.butter(2, corners, kind, fs=self.rate, output="sos")
        return np.asarray(
            signal.sosfiltfilt(sections, values, padlen=min(len(values) - 1, int(self.rate)))
        )

    def windowed(self, values: Array, rule: Rule) -> tuple[Array, int]:
        """The values at equal distances of time or way, and how many make up the rule's window."""
        if rule.window is None:
            return values, len(values)
        if rule.over_way:
            length = rule.window.to("m")
            way = self.distance
            extent, unit, rule_unit = float(way[-1]), "m", str(rule.window)
            if extent <= 0.0:
                raise NotApplicableError("the car stands still")
            values = np.interp(np.linspace(0.0, extent, len(way)), way, values)
        else:
            length = rule.window.to("s")
            extent, unit, rule_unit = (len(values) - 1) / self.rate, "s", str(rule.window)
        if extent < length * LONG_ENOUGH:
            raise NotApplicableError(self._too_short(extent, length, unit, rule_unit))
        return values, max(round(length / extent * (len(values) - 1)), 1)

    def windowed_rows(self, values: Array, rule: Rule, rows: Rows) -> tuple[Array, int]:
        """The values of some rows at equal distances of way, and how many the window has."""
        assert rule.window is not None
        way = self.distance[rows]
        even = np.interp(np.linspace(way[0], way[-1], len(rows)), way, values[rows])
        spacing = float(way[-1] - way[0]) / (len(rows) - 1)
        return even, min(max(round(rule.window.to("m") / spacing), 1), len(rows))

    def lasting(self, values: Array, rule: Rule) -> float:
        """The largest level that moving values keep for as long as the rule says."""
        count = max(round(rule.sustained * self.rate), 1)
        if len(values) < count:
            raise NotApplicableError(
                f"the run of {self.time[-1] - self.time[0]:.3g} s is shorter than a window of "
                f"{rule.window} that lasts for {rule.sustained:g} s"
            )
        return float(windows.held_above(values, count).max())

    def strided(self, values: Array, rule: Rule) -> Array:
        """Of values at equal distances of way, those that count by the rule."""
        if not rule.stride:
            return values
        spacing = float(self.distance[-1]) / (len(self.distance) - 1)
        return values[:: max(round(rule.stride / spacing), 1)]

    def _too_short(self, extent: float, length: float, unit: str, window: str) -> str:
        said = f"the window of {window} is longer than the run of {extent:.3g} {unit}"
        if unit == "m":
            needed = length / (extent / float(self.time[-1] - self.time[0]))
            said += f"; at this speed it takes {np.ceil(10 * needed) / 10:g} s"
        return said

    def _dominant(self, values: Array) -> float:
        line = self.of_track("curvature")
        if line is not None and len(line) == len(values):
            values = without_curves(values, line)
        found = dominant_frequency(Signal.of(values, self.time))
        if np.isnan(found):
            raise NotApplicableError("nothing moves")
        return found
