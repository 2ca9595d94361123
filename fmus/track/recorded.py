"""The track block of given stations: the same ports, a spline through what was measured or made."""

from __future__ import annotations

import casadi as ca
import numpy as np

from ..describe.block import Signals, Table
from ..describe.experiment import TIMES, Reference, as_bytes, held
from ..describe.experiment import Table as Columns
from ..describe.variables import Parameter, Values
from .block import ALONG_THE_TRACK, AXLES, Rails
from .irregularity import NODES
from .recorded_data import TrackData
from .spectra import CHANNELS

SPEED = 18.288
"""Of the reference results [m/s]."""
TOLERANCE = 1e-9
METHOD = (
    "Constant speed over the recorded track. Results: its cubic spline at each axle, and its "
    "second derivative, without the block's table."
)


class RecordedTrack(Rails):
    """Rails of `data`; beyond its last station they stay as they are there.

    name: of the block, letters, digits and _. Equation numbers: README.md of this folder.
    """

    home = "track"
    stands_for = "track"

    def __init__(self, data: TrackData, name: str = "track") -> None:
        self.data, self.name = data, name
        self.description = (
            f"Track {data.name!r} under the four axles of a car: {data.length:.6g} m, "
            f"{data.values.shape[1]} stations"
        )
        self.parameters = (
            *ALONG_THE_TRACK,
            Parameter(
                "start",
                "m",
                "Station of the record at which the leading axle starts",
                symbol="s_0",
                minimum=data.first,
                maximum=data.last,
                default=data.first,
            ),
        )
        spline = data.spline
        self.table = self._table(spline(spline.x), spline(spline.x, 1), len(AXLES))

    def _table(self, values: np.ndarray, slopes: np.ndarray, station_count: int) -> Table:
        """Of rows (n, nodes) at equal distances; the channels come first and have their factors."""
        page, scale = ca.MX.sym("page"), ca.MX.sym("scale", len(CHANNELS))
        pages = _pages(values, slopes)
        flat = ca.MX(ca.DM(pages.flatten("F")))
        size, last = pages.shape[0] * NODES, pages.shape[1] // NODES - 1
        at = ca.fmax(ca.fmin(page, last), 0) * size + ca.DM(np.arange(size))
        factors = ca.vertcat(scale, ca.DM.ones(len(values) - len(CHANNELS)))
        rows = ca.repmat(ca.vec(ca.horzcat(factors, factors).T), 1, NODES)
        return Table(
            spacing=self.data.spacing,
            nodes_per_page=NODES,
            values=2 * len(values),
            station_count=station_count,
            page=ca.Function(
                "page", [page, scale], [rows * ca.reshape(flat[at], pages.shape[0], NODES)]
            ),
        )

    def known(self, values: Values) -> Columns:
        """Outputs over the experiment's times at a steady speed, without the block's table."""
        return _along(self.data, values)

    def derived(self, p: Signals) -> Signals:
        """The factors on the channels."""
        return {"scale": ca.vertcat(*(p[f"{channel}_scale"] for channel in CHANNELS))}

    def stations(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """From the first station on; the leading axle starts at `start`."""
        return self.travelled(x, p) + (p["start"] - self.data.first)


def _pages(values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Value and slope of each row (2 rows, nodes) in whole pages; the last one holds the end."""
    count = values.shape[1]
    padded = (count // NODES + 2) * NODES
    table = np.zeros((2 * len(values), padded))
    table[0::2, :count] = values
    table[0::2, count:] = values[:, -1:]
    table[1::2, :count] = slopes
    return table


def reference(data: TrackData, block: RecordedTrack, values: Values) -> Reference:
    """Known results of a recorded track, its full size from the start on; values: [SI]."""
    tables = {"stimuli": held({"speed": _speed(data)}), "results": block.known(values)}
    return Reference(
        block.name,
        METHOD,
        {"co-simulation": TOLERANCE, "model exchange": TOLERANCE},
        {"fade_length": 0.0},
        {name: as_bytes(table) for name, table in tables.items()},
    )


def _speed(data: TrackData) -> float:
    """Of the known results, over one second [m/s]."""
    return min(SPEED, 0.9 * data.length)


def _along(data: TrackData, values: Values) -> Columns:
    """Outputs over one second at a steady speed, by the splines."""
    behind = 2 * values["half_wheelbase"] * np.array([0, 1, 0, 1])
    behind += 2 * values["half_truck_spacing"] * np.array([0, 0, 1, 1])
    speed = _speed(data)
    distance = speed * TIMES
    results: Columns = {
        "time": TIMES,
        "distance": distance,
        "speed_out": np.full(len(TIMES), speed),
    }
    for axle, offset in zip(AXLES, behind, strict=True):
        place, on = np.maximum(distance - offset, 0.0), distance > offset
        (a, v, xl, g), (_, bend, twist, _) = (on * data.spline(place, order) for order in (0, 2))
        rails = {"y_left": a + g / 2, "y_right": a - g / 2, "z_left": v + xl / 2,
                 "z_right": v - xl / 2}  # fmt: skip
        results |= {f"axle[{axle}].rail_{name}": value for name, value in rails.items()}
        for side, sign in (("left", 1), ("right", -1)):
            results[f"axle[{axle}].rail_az_{side}"] = speed**2 * (bend + sign * twist / 2)
    return results
