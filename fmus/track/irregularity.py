"""Irregularity as a sum of spectral lines, and its table of values and slopes page by page."""

from __future__ import annotations

import casadi as ca
import numpy as np

from .gauge import GAUGE_ROWS, gauge_range, limited_gauge
from .random_numbers import draw, stream_state
from .spectra import (
    CHANNELS,
    REPORT_SPECTRA,
    SPECTRA,
    amplitudes,
    bin_variance,
    corners,
    grid_spacing,
    report_band,
)
from .trigonometry import TURN, cosine_sine

LINES = 300
"""Lines of a channel, report (5-18)."""
SPACING = 0.1
"""Distance between the table's nodes [m]."""
NODES = 64
"""Nodes of a page."""
LINE_ROWS = ("frequency", "phase", "amplitude", "step_cosine", "step_sine")
"""A line: frequency [cycle/m], phase [turn], amplitude [m], phasor of one step of the table."""


WIDE_BAND = 400
"""Ratio of a band's longest to its shortest wave, beyond which bins grow with the square."""
DRAWN_FROM = ("spectrum", "seed", "report_rms", "wavelength_min", "wavelength_max", "gauge_range")
"""Parameters that the lines follow from, beside the scales."""


def channel_lines() -> ca.Function:
    """Lines of the four channels.

    (DRAWN_FROM, scale (4)) -> lines (5, 1200), channel after channel; rms of each channel
    [m] (4); GAUGE_ROWS.
    """
    given = {name: ca.MX.sym(name) for name in DRAWN_FROM}
    spectrum, scale = given["spectrum"], ca.MX.sym("scale", len(CHANNELS))
    report, report_grid = (spectrum == SPECTRA.index(name) + 1 for name in REPORT_SPECTRA)
    chosen = np.arange(1, len(SPECTRA) + 1) == spectrum
    amplitude = ca.mtimes(ca.DM(amplitudes()), chosen)
    corner = ca.mtimes(ca.DM(corners()), chosen)
    given_band = ca.vertcat(1 / given["wavelength_max"], 1 / given["wavelength_min"])
    band = ca.if_else(report, ca.DM(report_band()), given_band)
    edges = _bin_edges(report_grid, ca.fmin(band[0], band[1]), ca.fmax(band[0], band[1]))
    stream, numbers = stream_state(), _pair().mapaccum(LINES)

    lines, rms = [], []
    for i, channel in enumerate(CHANNELS):
        _, uniform = numbers(stream(len(CHANNELS) * given["seed"] + i))
        raw = _line(channel).map(LINES)(edges[:, :-1], edges[:, 1:], uniform, amplitude[i], corner)
        level = ca.sqrt(ca.sumsqr(raw[2, :]) / 2)
        wanted = given["report_rms"] / ca.fmax(level, 1e-30)
        fitted = ca.if_else(ca.logic_or(report, report_grid), wanted, 1)
        factor = ca.if_else(level > 0, fitted, 0) * scale[i]
        lines.append(ca.vertcat(raw[:2, :], raw[2, :] * factor, raw[3:, :]))
        rms.append(level * ca.fabs(factor))
    gauge = gauge_range()(spectrum, given["gauge_range"], rms[CHANNELS.index("gauge")])
    return ca.Function(
        "channel_lines",
        [*given.values(), scale],
        [ca.horzcat(*lines), ca.vertcat(*rms), gauge],
    )


def page_function() -> ca.Function:
    """(page number, lines, rms, GAUGE_ROWS) -> nodes (8, 64): value [m], slope [m/m] by channel.

    A channel whose rms is zero is skipped.
    """
    page, rms = ca.MX.sym("page"), ca.MX.sym("rms", len(CHANNELS))
    gauge = ca.MX.sym("gauge", len(GAUGE_ROWS))
    lines = ca.MX.sym("lines", len(LINE_ROWS), LINES * len(CHANNELS))
    start, own = ca.MX.sym("start"), ca.MX.sym("own", len(LINE_ROWS), LINES)
    nodes = _add_line().fold(LINES)(ca.DM.zeros(2, NODES), own, start)
    present = ca.Function("present", [own, start], [nodes])
    absent = ca.Function("absent", [own, start], [ca.MX.zeros(2, NODES)])
    channel = ca.Function.if_else("channel_page", present, absent)
    parts = [
        channel(rms[i] > 0, lines[:, i * LINES : (i + 1) * LINES], page * (NODES * SPACING))
        for i in range(len(CHANNELS))
    ]
    i = CHANNELS.index("gauge")
    parts[i] = limited_gauge().map(NODES)(parts[i], ca.repmat(gauge, 1, NODES))
    return ca.Function("page", [page, lines, rms, gauge], [ca.vertcat(*parts)])


def _bin_edges(regular: ca.MX, low: ca.MX, high: ca.MX) -> ca.MX:
    """Edges of the bins [cycle/m], shape (1, LINES + 1).

    The lines of a regular grid lie in the middle of bins of equal width (erratum 8); otherwise
    bins are narrow where the waves are long. They grow with the line's number, in wide bands
    with its square, so that no line carries more than 5 % of a channel's variance.
    """
    number = ca.DM(np.arange(LINES + 1.0)).T
    fraction = ca.DM(np.arange(LINES + 1.0) / LINES).T
    uniform = ca.MX(grid_spacing() * (number + 0.5))
    square = fraction * fraction
    grown = ca.if_else(high > WIDE_BAND * low, square * fraction, square)
    return ca.if_else(regular, uniform, low + (high - low) * grown)


def _pair() -> ca.Function:
    """State of the generator -> next state, two uniform numbers."""
    state, one = ca.SX.sym("state", 6), draw()
    after_first, first = one(state)
    after_second, second = one(after_first)
    return ca.Function("pair", [state], [after_second, ca.vertcat(first, second)])


def _line(channel: str) -> ca.Function:
    """(low edge, high edge, two uniform numbers, A, corners) -> line (5)."""
    low, high, amplitude = (ca.SX.sym(n) for n in ("low", "high", "amplitude"))
    uniform, corner = ca.SX.sym("uniform", 2), ca.SX.sym("corner", 3)
    frequency = low + (high - low) * uniform[0]
    variance = bin_variance(channel, low, high, amplitude, (corner[0], corner[1], corner[2]))
    line = ca.vertcat(
        frequency,
        uniform[1],  # report (5-21)
        ca.sqrt(2 * variance),  # erratum 7
        *cosine_sine(frequency * SPACING),
    )
    return ca.Function(f"line_{channel}", [low, high, uniform, amplitude, corner], [line])


def _add_line() -> ca.Function:
    """(nodes (2, 64), line, start of the page [m]) -> nodes with the line added.

    The phasor at the start is turned to the other nodes by doubling: 1, 2, 4 ... steps at once.
    """
    nodes, line = ca.SX.sym("nodes", 2, NODES), ca.SX.sym("line", len(LINE_ROWS))
    start = ca.SX.sym("start")
    frequency, phase, amplitude, step_cosine, step_sine = ca.vertsplit(line)
    cosine, sine = cosine_sine(frequency * start + phase)
    c, s = amplitude * cosine, amplitude * sine
    while c.numel() < NODES:
        c, s = (
            ca.vertcat(c, step_cosine * c - step_sine * s),
            ca.vertcat(s, step_sine * c + step_cosine * s),
        )
        step_cosine, step_sine = (
            step_cosine * step_cosine - step_sine * step_sine,
            2 * step_cosine * step_sine,
        )
    slope = -(TURN * frequency) * s
    return ca.Function("add_line", [nodes, line, start], [nodes + ca.horzcat(c, slope).T])
