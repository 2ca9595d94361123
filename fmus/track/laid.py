"""The track block of a line with curves, transitions and cant, under irregularities."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np
from scipy.interpolate import CubicSpline, PPoly

from ..describe.block import Signals
from ..describe.experiment import Table as Columns
from ..describe.terminals import FRAME, Terminal
from ..describe.variables import FRAME_INPUTS, Output, Parameter, Values
from .block import AXLES, Rails
from .recorded import RecordedTrack
from .recorded_data import TrackData
from .spectra import CHANNELS

GRAVITY = 9.80665  # [m/s2]
TRUCKS = {1: "leading", 2: "trailing"}
ROWS = ("curvature", "place", "cant")
"""Of the line in the table, behind those of the irregularities."""

_LATERAL = "frame.ay"
_BENT = (
    Output("curvature", "1/m", "Curvature of the line at the car's middle, positive to the left",
           nominal=1e-3),
    Output("cant", "m", "Height of the left rail over the right one at the car's middle",
           nominal=0.1),
    *(
        Output(port.name, port.unit, f"{port.description.split(' of the')[0]} of the car's frame")
        for port in FRAME_INPUTS
    ),
    *(
        Output(f"truck[{j}].ay", "m/s2", f"Lateral acceleration of the frame at the {which} truck")
        for j, which in TRUCKS.items()
    ),
    *(
        Output(f"axle[{axle}].path_yaw", "rad", f"Yaw of the frame's way over the ground at axle "
               f"{axle}", nominal=1e-2)
        for axle in AXLES
    ),
)  # fmt: skip


class LaidTrack(RecordedTrack):
    """Rails of `data` along its line. Equation numbers: README.md of this folder."""

    outputs = (*Rails.outputs, *_BENT)
    terminals = (
        *(
            Terminal(t.name, t.joint, t.description, t.place, t.prefix,
                     {**t.renamed, "path_curvature": "curvature"})
            for t in Rails.terminals
        ),
        Terminal("frame", FRAME, "Carbody in the car's frame", (0.0, -84.0), prefix="frame."),
        *(
            Terminal(f"truck[{j}]", FRAME, f"The {which} truck in the car's frame",
                     (120.0 - 80.0 * j, -84.0), prefix="frame.", renamed={"ay": f"truck[{j}].ay"})
            for j, which in TRUCKS.items()
        ),
    )  # fmt: skip

    def __init__(self, data: TrackData, name: str = "track") -> None:
        super().__init__(data, name)
        self.parameters = (
            *self.parameters,
            Parameter(
                "half_contact_spacing",
                "m",
                "Half distance of the rails, over which cant is measured",
                symbol="L_Y",
                minimum=0.1,
            ),
        )
        spline, line = data.spline, _line(data)
        self.table = self._table(
            np.vstack([spline(spline.x), *(row[0] for row in line)]),
            np.vstack([spline(spline.x, 1), *(row[1] for row in line)]),
            len(AXLES) + 1,
        )

    def known(self, values: Values) -> Columns:
        """As the splines have it; of the line its own outputs, and what it does to the rails."""
        results = super().known(values)
        (curvature, place, cant), speed = _splines(self.data), results["speed_out"]
        truck, axle = values["half_truck_spacing"], values["half_wheelbase"]
        places = np.array([truck + axle, truck - axle, axle - truck, -truck - axle])
        at = [np.maximum(results["distance"] + x - places[0], 0.0) for x in (*places, 0.0)]
        behind = [
            results["distance"] + x - places[0] - s for x, s in zip((*places, 0), at, strict=True)
        ]
        on = behind[-1] == 0
        results["curvature"] = on * curvature(at[-1])
        results["cant"] = cant(at[-1])
        sine = results["cant"] / (2 * values["half_contact_spacing"])
        press = -(speed**2) * results["curvature"] * sine - GRAVITY * (1 - np.sqrt(1 - sine**2))
        heading = place(at[-1], 1)
        middle = place(at[-1]) + heading * behind[-1]
        for i, x in enumerate(places):
            aside = place(at[i]) + place(at[i], 1) * behind[i] - middle - x * heading
            for side, sign in (("left", 0.5), ("right", -0.5)):
                rail = f"axle[{i + 1}].rail"
                results[f"{rail}_y_{side}"] = results[f"{rail}_y_{side}"] + aside
                rise = sign * (cant(at[i]) - results["cant"])
                results[f"{rail}_z_{side}"] = results[f"{rail}_z_{side}"] + rise
                twist = sign * speed**2 * cant(at[i], 2) * (behind[i] == 0)
                results[f"{rail}_az_{side}"] = results[f"{rail}_az_{side}"] + twist + press
        return results

    def places(self, p: Signals) -> ca.SX:
        """Of the four axles and of the car's middle, ahead of the middle [m]."""
        truck, axle = p["half_truck_spacing"], p["half_wheelbase"]
        return ca.vertcat(truck + axle, truck - axle, axle - truck, -truck - axle, 0)

    def unbounded(self, x: Signals, p: Signals) -> ca.SX:
        """Distances of the four axles and of the car's middle from the first station."""
        places = self.places(p)
        return x["distance"] + p["start"] - self.data.first + places - places[0]

    def stations(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        first = p["start"] - self.data.first
        return ca.fmin(ca.fmax(self.unbounded(x, p), first), self.data.length)

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        """The irregularities, and what the line adds to them."""
        assert lookup is not None
        own, line = 2 * len(CHANNELS), 2 * len(ROWS)
        left, right = range(1, 1 + own), range(1 + own + line, 1 + 2 * own + line)
        y = {**super().output(x, u, p, d, lookup[[0, *left, *right], : len(AXLES)])}
        left, right = range(1 + own, 1 + own + line), range(1 + 2 * own + line, lookup.shape[0])
        at, beyond = self.places(p), self.unbounded(x, p) - self.stations(x, u, p, d)
        found = [
            _line_at(self.table.spacing)(lookup[0, i], lookup[[*left, *right], i], beyond[i])
            for i in range(at.numel())
        ]
        (value, slope, bend), speed_2 = found[-1], u["speed"] ** 2
        curvature, middle, cant = ca.vertsplit(value)
        sine = 0.5 * cant / p["half_contact_spacing"]  # (15)
        cosine = ca.sqrt(1 - sine**2)
        press = -speed_2 * curvature * sine - GRAVITY * (1 - cosine)
        ay = speed_2 * curvature * cosine + GRAVITY * sine  # (17)
        wz_dot = speed_2 * slope[0]
        y |= {"curvature": curvature, "cant": cant, _LATERAL: ay, "frame.az": press,
              "frame.wx_dot": 0.5 * speed_2 * bend[2] / p["half_contact_spacing"],
              "frame.wz_dot": wz_dot}  # fmt: skip
        for j, ahead in zip(TRUCKS, (1, -1), strict=True):
            y[f"truck[{j}].ay"] = ay + ahead * p["half_truck_spacing"] * wz_dot
        for i, axle in enumerate(AXLES):
            (_, place, high), _, (_, _, twist) = (ca.vertsplit(part) for part in found[i])
            sideways = place - middle - at[i] * slope[1]  # (16)
            y[f"axle[{axle}].path_yaw"] = at[i] * curvature  # (18)
            for side, sign in (("left", 0.5), ("right", -0.5)):
                y[f"axle[{axle}].rail_y_{side}"] += sideways
                y[f"axle[{axle}].rail_z_{side}"] += sign * (high - cant)
                y[f"axle[{axle}].rail_az_{side}"] += sign * speed_2 * twist + press
        return y


def _splines(data: TrackData) -> tuple[PPoly, PPoly, PPoly]:
    """`ROWS` over the distance from the first station, (14)."""
    assert data.line is not None
    nodes = data.stations - data.first
    curvature, cant = CubicSpline(nodes, data.line[0]), CubicSpline(nodes, data.line[1])
    return curvature, curvature.antiderivative(2), cant


def _line(data: TrackData) -> list[tuple[np.ndarray, np.ndarray]]:
    """Values and slopes of `ROWS` at the stations."""
    nodes = data.stations - data.first
    return [(f(nodes), f(nodes, 1)) for f in _splines(data)]


@cache
def _line_at(spacing: float) -> ca.Function:
    """(fraction of the way, both nodes, way beyond the track) -> values, slopes, bends of `ROWS`.

    Before its start and behind its end the line is straight, and the cant stays.
    """
    t, beyond = ca.SX.sym("fraction"), ca.SX.sym("beyond")
    nodes = ca.SX.sym("nodes", 4 * len(ROWS))
    both = ca.reshape(nodes, 2 * len(ROWS), 2)
    left, right, rest = both[:, 0], both[:, 1], 1 - t
    value = (
        rest * rest * ((1 + 2 * t) * left[0::2] + t * spacing * left[1::2])
        + t * t * ((1 + 2 * rest) * right[0::2] - rest * spacing * right[1::2])
    )  # fmt: skip
    slope = ca.jacobian(value, t) / spacing
    bend = ca.jacobian(slope, t) / spacing
    on = beyond == 0
    heading = slope[1]
    value[1] += heading * beyond
    value[0] *= on
    slope, bend = slope * on, bend * on
    slope[1] = heading
    return ca.Function("line_at", [t, nodes, beyond], [value, slope, bend])
