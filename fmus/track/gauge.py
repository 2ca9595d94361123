"""The gauge of track that its class allows: mean widening, and a smooth limit."""

from __future__ import annotations

import casadi as ca
import numpy as np

from .spectra import GAUGE_RANGES, data, legal_gauge

GAUGE_ROWS = ("mean", "middle", "half_range")
"""Mean gauge, middle and half of the legal range [m], all less the nominal gauge."""
UNLIMITED = 1e3
"""Half range [m] that no gauge reaches."""


def gauge_range() -> ca.Function:
    """(spectrum, item of GAUGE_RANGES, rms of the gauge [m]) -> GAUGE_ROWS, (12).

    A spectrum of no FRA class is not limited.
    """
    spectrum, item, rms = (ca.SX.sym(name) for name in ("spectrum", "item", "rms"))
    least, most = legal_gauge()
    chosen = (np.arange(1, least.size + 1) == spectrum) * ca.DM(~np.isnan(least))
    low, high = (ca.dot(ca.DM(np.nan_to_num(limit)), chosen) for limit in (least, most))
    middle = (low + high) / 2
    deviations = data()["gauge"]["deviations"]["value"]
    mean = ca.fmin(ca.fmax(low + deviations * rms, 0), middle)
    limited = (item == GAUGE_RANGES.index("legal") + 1) * ca.sum1(chosen)
    rows = ca.vertcat(mean, middle, (high - low) / 2)
    free = ca.vertcat(0, 0, UNLIMITED)
    return ca.Function("gauge_range", [spectrum, item, rms], [ca.if_else(limited, rows, free)])


def limited_gauge() -> ca.Function:
    """(value and slope (2, nodes), GAUGE_ROWS) -> those of the gauge within its range, (13)."""
    knee = data()["gauge"]["knee"]["value"]
    value, slope, mean, middle, half = (
        ca.SX.sym(name) for name in ("value", "slope", "mean", "middle", "half")
    )
    offset = value + mean - middle
    size, room = ca.fabs(offset), (1 - knee) * half
    beyond = ca.fmax(size - knee * half, 0) / room
    root = ca.sqrt(1 + beyond * beyond)
    bent = ca.fmin(size, knee * half) + room * beyond / root
    return ca.Function(
        "limited_gauge",
        [ca.vertcat(value, slope), ca.vertcat(mean, middle, half)],
        [ca.vertcat(middle + ca.sign(offset) * bent, slope / (root * root * root))],
    )
