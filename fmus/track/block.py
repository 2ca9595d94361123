"""The track block: irregularities under the four axles of a car."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, cached_property

import casadi as ca

from ..describe.block import Block, Signals, Table
from ..describe.states import State
from ..describe.terminals import RAILS, Terminal
from ..describe.variables import Array, Input, Output, Parameter, choice
from .gauge import GAUGE_ROWS
from .irregularity import (
    DRAWN_FROM,
    LINE_ROWS,
    LINES,
    NODES,
    SPACING,
    channel_lines,
    page_function,
)
from .spectra import CHANNELS, GAUGE_RANGES, SPECTRA

AXLES = (1, 2, 3, 4)
RAIL_MOTIONS = tuple(
    (axis, direction, side)
    for axis, direction in (("y", "Lateral"), ("z", "Vertical"))
    for side in ("left", "right")
)
LONGEST_WAVE = 2000.0
"""[m]; 300 lines are too few for wider bands."""
LINES_SHAPE = (len(LINE_ROWS), LINES * len(CHANNELS))


def _scale(channel: str) -> Parameter:
    return Parameter(
        f"{channel}_scale",
        "1",
        f"Factor on the {channel.replace('_', '-')} irregularity",
        minimum=0.0,
        default=1.0,
    )


def _rails(axle: int) -> list[Output]:
    return [
        Output(
            f"axle[{axle}].rail_{axis}_{side}",
            "m",
            f"{direction} displacement of the {side} rail under axle {axle}",
            nominal=1e-3,
        )
        for axis, direction, side in RAIL_MOTIONS
    ]


def _accelerations(axle: int) -> list[Output]:
    return [
        Output(
            f"axle[{axle}].rail_az_{side}",
            "m/s2",
            f"Vertical acceleration of the {side} rail under axle {axle}, at a steady speed",
            nominal=1.0,
        )
        for side in ("left", "right")
    ]


def _under_all_axles(axis: str, direction: str, side: str) -> Array:
    rail = f"rail_{axis}_{side}"
    return Array(
        rail,
        f"{direction} displacement of the {side} rail under axles 1 to {len(AXLES)}",
        tuple(f"axle[{axle}].{rail}" for axle in AXLES),
        (len(AXLES),),
    )


ALONG_THE_TRACK = (
    Parameter(
        "fade_length",
        "m",
        "Length over which the irregularities grow to their full size, from station 0",
        symbol="s_f",
        minimum=0.0,
    ),
    *(_scale(channel) for channel in CHANNELS),
    Parameter(
        "half_truck_spacing",
        "m",
        "Half distance of the truck centres",
        symbol="l_c",
        minimum=0.0,
    ),
    Parameter("half_wheelbase", "m", "Half wheelbase of a truck", symbol="L_X", minimum=0.0),
)
"""Parameters of any track: its start, its size, where the axles are."""


class Rails(Block):
    """Rails under four axles that move with the distance travelled, as its table has them.

    The table's values are value [m] and slope [m/m] of each channel. Equation numbers: README.md
    of this folder.
    """

    table: Table
    inputs = (Input("speed", "m/s", "Speed of the car", start=18.288),)
    outputs = (
        Output("distance", "m", "Distance travelled", nominal=100.0),
        Output("speed_out", "m/s", "Speed, passed through", nominal=10.0, derivative_of="distance"),
        *(rail for axle in AXLES for rail in _rails(axle)),
        *(rail for axle in AXLES for rail in _accelerations(axle)),
    )
    states = (State("distance", "m", "Distance travelled"),)
    terminals = tuple(
        Terminal(
            f"axle[{axle}]",
            RAILS,
            f"Wheelset and truck on the rails under axle {axle}",
            (120.0 - 48.0 * axle, 84.0),
            prefix=f"axle[{axle}].",
            renamed={"speed": "speed_out"},
        )
        for axle in AXLES
    )
    arrays = tuple(_under_all_axles(*rail) for rail in RAIL_MOTIONS)

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        return {"distance": ca.SX(0)}

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        return {"distance": u["speed"]}

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """(11), exact for a speed that varies linearly."""
        return {"distance": x["distance"] + (u["speed"] + 0.5 * h * rate["speed"]) * h}, {}

    def travelled(self, x: Signals, p: Signals) -> ca.SX:
        """(10): how far each axle has come; those behind the leading one start on perfect track."""
        truck, axle = 2 * p["half_truck_spacing"], 2 * p["half_wheelbase"]
        behind = ca.vertcat(0, axle, truck, truck + axle)
        return ca.fmax(x["distance"] - behind, 0)

    def stations(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """The leading axle starts at station 0."""
        return self.travelled(x, p)

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        assert lookup is not None
        y: dict[str, ca.SX] = {"distance": x["distance"], "speed_out": u["speed"]}
        travelled, rails = self.travelled(x, p), _rails_at(self.table.spacing)
        for column, axle in enumerate(AXLES):
            fraction, nodes = lookup[0, column], lookup[1:, column]
            value, bend = rails(travelled[column], fraction, nodes, p["fade_length"])
            for i, output in enumerate(_rails(axle)):
                y[output.name] = value[i]
            for i, output in enumerate(_accelerations(axle), start=2):
                y[output.name] = u["speed"] ** 2 * bend[i]  # (12)
        return y


class Track(Rails):
    """Rails of a spectrum and a seed."""

    name = "track"
    description = "Track irregularities under the four axles of a car, from a spectrum and a seed"
    parameters = (
        choice("spectrum", "Spectrum of the irregularities", SPECTRA),
        Parameter(
            "seed",
            "1",
            "Number of the realisation; the same seed is the same track",
            kind="integer",
            minimum=0,
            maximum=2**31 - 1,
            default=1.0,
        ),
        Parameter(
            "report_rms",
            "m",
            "Rms of the alignment of the spectra `report` and `report_grid`",
            symbol="sigma",
            minimum=0.0,
        ),
        Parameter(
            "wavelength_min",
            "m",
            "Shortest wave of the spectra other than the report's",
            symbol="lambda_min",
            minimum=0.5,
            maximum=LONGEST_WAVE,
        ),
        Parameter(
            "wavelength_max",
            "m",
            "Longest wave of the spectra other than the report's",
            symbol="lambda_max",
            minimum=0.5,
            maximum=LONGEST_WAVE,
        ),
        *ALONG_THE_TRACK,
        choice(
            "gauge_range",
            "Whether the gauge keeps to what the FRA class allows, with a mean widening",
            GAUGE_RANGES,
        ),
    )

    def __init__(self) -> None:
        count = LINES_SHAPE[0] * LINES_SHAPE[1]
        page, d = ca.MX.sym("page"), ca.MX.sym("d", count + len(CHANNELS) + len(GAUGE_ROWS))
        lines, rms, gauge = ca.vertsplit(d, [0, count, count + len(CHANNELS), d.numel()])
        nodes = page_function()(page, ca.reshape(lines, *LINES_SHAPE), rms, gauge)
        self.table = Table(
            spacing=SPACING,
            nodes_per_page=NODES,
            values=2 * len(CHANNELS),
            station_count=len(AXLES),
            page=ca.Function("page", [page, d], [nodes]),
        )

    @cached_property
    def derived_shapes(self) -> dict[str, tuple[int, int]]:
        """The lines of all channels, each channel's rms [m], and the range of the gauge [m]."""
        return {"lines": LINES_SHAPE, "rms": (len(CHANNELS), 1), "gauge": (len(GAUGE_ROWS), 1)}

    def derived_function(self) -> ca.Function:
        """(3) to (7), (12): the lines, drawn once, and the range of the gauge."""
        p = ca.MX.sym("p", len(self.parameters))
        value = {v.name: p[i] for i, v in enumerate(self.parameters)}
        lines, rms, gauge = channel_lines()(
            *(value[name] for name in DRAWN_FROM),
            ca.vertcat(*(value[f"{channel}_scale"] for channel in CHANNELS)),
        )
        return ca.Function("derived", [p], [ca.vertcat(ca.vec(lines), rms, gauge)])


@cache
def _rails_at(spacing: float) -> ca.Function:
    """(travelled, fraction of the way, both nodes, fade length) -> rails (4), second derivatives.

    In the order of `RAIL_MOTIONS`; the derivatives [1/m] are along the track.
    """
    travelled, fraction, length = (ca.SX.sym(n) for n in ("travelled", "fraction", "length"))
    nodes = ca.SX.sym("nodes", 4 * len(CHANNELS))
    a, v, xl, g = _interpolate(fraction, nodes, spacing)
    rails = ca.vertcat(a + g / 2, a - g / 2, v + xl / 2, v - xl / 2)  # (9)
    value = _smoothstep(travelled, length) * rails
    place, onwards = ca.vertcat(travelled, fraction), ca.DM([1, 1 / spacing])
    slope = ca.jtimes(value, place, onwards)
    bend = ca.jtimes(slope, place, onwards)
    return ca.Function("rails_at", [travelled, fraction, nodes, length], [value, bend])


def _interpolate(t: ca.SX, column: ca.SX, spacing: float) -> Sequence[ca.SX]:
    """Cubic Hermite interpolation of the four channels between two nodes, (8)."""
    nodes = ca.reshape(column, 2 * len(CHANNELS), 2)
    left, right = nodes[:, 0], nodes[:, 1]
    rest = 1 - t
    values = (
        rest * rest * ((1 + 2 * t) * left[0::2] + t * spacing * left[1::2])
        + t * t * ((1 + 2 * rest) * right[0::2] - rest * spacing * right[1::2])
    )  # fmt: skip
    return ca.vertsplit(values)


def _smoothstep(travelled: ca.SX, length: ca.SX) -> ca.SX:
    """Fade-in: 0 to 1 over the length [m], with continuous slope and curvature."""
    u = ca.fmin(travelled / ca.fmax(length, 1e-6), 1)
    return u * u * u * (10 + u * (6 * u - 15))
