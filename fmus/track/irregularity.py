"""Irregularity as a sum of spectral lines, and its table of values and slopes page by page."""

from __future__ import annotations

import casadi as ca
import numpy as np

from .random_numbers import draw, stream_state
from .spectra import CHANNELS, amplitudes, bin_variance, corners, grid_spacing
from .trigonometry import TURN, cosine_sine

LINES = 300
"""Lines of a channel, report (5-18)."""
SPACING = 0.1
"""Distance between the table's nodes [m]."""
NODES = 64
"""Nodes of a page."""
LINE_ROWS = ("frequency", "phase", "amplitude", "step_cosine", "step_sine")
"""A line: frequency [cycle/m], phase [turn], amplitude [m], phasor of one step of the table."""


def channel_lines() -> ca.Function:
    """Lines of the four channels.

    (spectrum, seed, report_rms, wavelength_min, wavelength_max, scale (4))
    -> lines (5, 1200), channel after channel; rms of each channel [m] (4).
    """
    names = ("spectrum", "seed", "report_rms", "wavelength_min", "wavelength_max")
    spectrum, seed, report_rms, wavelength_min, wavelength_max = (ca.MX.sym(n) for n in names)
    scale = ca.MX.sym("scale", len(CHANNELS))
    is_report = spectrum == 1
    chosen = np.arange(1, amplitudes().shape[1] + 1) == spectrum
    amplitude = ca.mtimes(ca.DM(amplitudes()), chosen)
    corner = ca.mtimes(ca.DM(corners()), chosen)
    band = ca.vertcat(1 / wavelength_max, 1 / wavelength_min)
    edges = _bin_edges(is_report, ca.fmin(band[0], band[1]), ca.fmax(band[0], band[1]))
    stream, numbers = stream_state(), _pair().mapaccum(LINES)

    lines, rms = [], []
    for i, channel in enumerate(CHANNELS):
        _, uniform = numbers(stream(len(CHANNELS) * seed + i))
        raw = _line(channel).map(LINES)(edges[:, :-1], edges[:, 1:], uniform, amplitude[i], corner)
        level = ca.sqrt(ca.sumsqr(raw[2, :]) / 2)
        fitted = ca.if_else(is_report, report_rms / ca.fmax(level, 1e-30), 1)
        factor = ca.if_else(level > 0, fitted, 0) * scale[i]
        lines.append(ca.vertcat(raw[:2, :], raw[2, :] * factor, raw[3:, :]))
        rms.append(level * ca.fabs(factor))
    return ca.Function(
        "channel_lines",
        [spectrum, seed, report_rms, wavelength_min, wavelength_max, scale],
        [ca.horzcat(*lines), ca.vertcat(*rms)],
    )


def page_function() -> ca.Function:
    """(page number, lines, rms) -> nodes (8, 64): value [m] and slope [m/m] of each channel.

    A channel whose rms is zero is skipped.
    """
    page, rms = ca.MX.sym("page"), ca.MX.sym("rms", len(CHANNELS))
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
    return ca.Function("page", [page, lines, rms], [ca.vertcat(*parts)])


def _bin_edges(is_report: ca.MX, low: ca.MX, high: ca.MX) -> ca.MX:
    """Edges of the bins [cycle/m], shape (1, LINES + 1).

    The report's lines lie in the middle of bins of equal width (erratum 8); otherwise the
    distance grows linearly, so that bins are narrow where the waves are long.
    """
    number = ca.DM(np.arange(LINES + 1.0)).T
    fraction = ca.DM(np.arange(LINES + 1.0) / LINES).T
    uniform = ca.MX(grid_spacing() * (number + 0.5))
    return ca.if_else(is_report, uniform, low + (high - low) * (fraction * fraction))


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
