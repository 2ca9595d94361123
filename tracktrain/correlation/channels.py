"""Which measured channel is which signal of a run, and where its sensor sat on the carbody."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from orchestrator import OrchestratorError, Quantity, choices

from ..car.hopper import layout_of
from ..car.layout import Shown
from ..errors import TracktrainError
from ..quantities import shown_unit
from ..scales import Scale
from .files import Channel, factor
from .history import Array, History, history

PLACED = re.compile(r"(?P<quantity>\w+\.\w+)\s+at\s+(?P<place>.+)")
COORDINATE = re.compile(r"\s*([xyz])\s*=\s*([^xyz]+)", re.IGNORECASE)
ORDERS = {"": 0, "v": 1, "a": 2}
"""How often a displacement is differentiated."""


@dataclass(frozen=True)
class Sensor:
    """A signal as a sensor has it. place: on the carbody [m], from its centre of gravity.

    text: as it was written. variable: of the run; with a place, the carbody's y, z, vy, vz, ay, az.
    """

    text: str
    variable: str
    place: Mapping[str, float] | None = None


@dataclass(frozen=True, eq=False)
class Matched:
    """A measured channel in the unit of its signal, and the signal in each run by name."""

    channel: str
    sensor: Sensor
    unit: str
    measured: History
    runs: Mapping[str, History]
    notes: Sequence[str] = field(default=())

    @property
    def shown(self) -> Shown:
        """How it is shown."""
        largest = float(np.abs(self.measured.values).max())
        return Shown(self.sensor.text, self.channel, Scale(*shown_unit(self.unit, largest)))


def sensor(text: str) -> Sensor:
    """A variable, or `carbody.ay at x=6.1m z=-0.5m`; raises TracktrainError."""
    match = PLACED.fullmatch(text.strip())
    if match is None:
        return Sensor(text.strip(), text.strip())
    found = COORDINATE.findall(match["place"])
    rest = COORDINATE.sub("", match["place"]).strip(" ,")
    example = f"'{match['quantity']} at x=6.1m y=0m z=-0.5m'"
    if not found or rest:
        raise TracktrainError(f"the place in '{text}' cannot be read; write it like {example}")
    place = {"x": 0.0, "y": 0.0, "z": 0.0}
    for axis, value in found:
        try:
            place[axis.lower()] = Quantity.parsed(value).to("m")
        except OrchestratorError as error:
            raise TracktrainError(
                f"the place in '{text}': {error}; write it like {example}"
            ) from None
    return Sensor(text.strip(), match["quantity"], place)


def values_of(sensor: Sensor, run: xr.Dataset, name: str) -> tuple[Array, str]:
    """A sensor's signal in a run, and its unit; raises TracktrainError where the run lacks it."""
    if sensor.place is None:
        variable = _variable(run, sensor.variable, name)
        return np.asarray(variable.values, float), str(variable.attrs.get("units", "1"))
    body, _, quantity = sensor.variable.partition(".")
    order, axis = ORDERS.get(quantity[:-1]), quantity[-1:]
    if order is None or axis not in ("y", "z"):
        raise TracktrainError(
            f"a sensor at a place has y, z, vy, vz, ay or az, not '{quantity}', as "
            f"'{layout_of(run).carbody}.ay at x=6.1m'"
        )
    # Small rotations of a rigid body: u = u_cg + theta x r.
    arms = (
        {"yaw": sensor.place["x"], "roll": -sensor.place["z"]}
        if axis == "y"
        else {"roll": sensor.place["y"], "pitch": -sensor.place["x"]}
    )
    time = run["time"].values
    moved = _differentiated(run, body, axis, order, name)
    for rotation, arm in arms.items():
        if arm:
            angle = np.asarray(_variable(run, f"{body}.cg.{rotation}", name).values, float)
            moved = moved + arm * _times(angle, time, order)
    return moved, ("m", "m/s", "m/s2")[order]


def matched(
    channels: Mapping[str, Channel], runs: Mapping[str, xr.Dataset], given: Sequence[str]
) -> tuple[list[Matched], list[str]]:
    """Channels beside what they are in the runs, and names of those that are nothing there.

    given: texts `COLUMN = SIGNAL`; a column that is named as a signal needs none. Raises
    TracktrainError for a column, a signal or a unit that is not there or does not fit.
    """
    wanted: dict[str, Sensor] = {}
    for text in given:
        column, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not column or not right:
            raise TracktrainError(f"'{text}' cannot be read; write --channel 'COLUMN = SIGNAL'")
        if column not in channels:
            raise TracktrainError(
                f"the measurement has no channel '{column}'; {choices(column, channels)}"
            )
        wanted[column] = sensor(right)
    first = next(iter(runs.values()))
    for name in channels:
        if name not in wanted and name in first:
            wanted[name] = Sensor(name, name)
    if not wanted:
        raise TracktrainError(
            f"no channel of the measurement ({', '.join(channels)}) is named as a signal of "
            "the run; say which is which, such as "
            f"--channel '{next(iter(channels))} = {next(iter(first.data_vars), 'carbody.cg.ay')}'"
        )
    found = [_matched(channels[name], as_sensor, runs) for name, as_sensor in wanted.items()]
    return found, [name for name in channels if name not in wanted]


def _matched(channel: Channel, as_sensor: Sensor, runs: Mapping[str, xr.Dataset]) -> Matched:
    simulated, unit = {}, "1"
    for name, run in runs.items():
        values, unit = values_of(as_sensor, run, name)
        simulated[name] = _history(run["time"].values, values, f"{as_sensor.text} of run {name}")
    gain = factor(channel.unit, unit)
    if gain is None:
        raise TracktrainError(
            f"the channel '{channel.name}' is in {channel.unit}, and {as_sensor.text} in {unit}, "
            "which measures another thing; choose another signal or mend the file's unit"
        )
    measured = _history(channel.time, channel.values * gain, f"the channel '{channel.name}'")
    return Matched(channel.name, as_sensor, unit, measured, simulated)


def _history(time: Array, values: Array, name: str) -> History:
    try:
        return history(time, values)
    except TracktrainError as error:
        raise TracktrainError(f"{name} cannot be used: {error}") from None


def _variable(run: xr.Dataset, variable: str, name: str) -> xr.DataArray:
    if variable not in run:
        raise TracktrainError(
            f"run {name} has no signal '{variable}'; {choices(variable, map(str, run.data_vars))}"
        )
    return run[variable]


def _differentiated(run: xr.Dataset, body: str, axis: str, order: int, name: str) -> Array:
    """The motion of the centre of gravity; its recorded acceleration where there is one."""
    recorded = f"{body}.cg.{'a' if order == 2 else ''}{axis}"
    if order != 1 and recorded in run:
        return np.asarray(run[recorded].values, float)
    values = np.asarray(_variable(run, f"{body}.cg.{axis}", name).values, float)
    return _times(values, run["time"].values, order)


def _times(values: Array, time: Array, order: int) -> Array:
    for _ in range(order):
        values = np.gradient(values, time)
    return values
