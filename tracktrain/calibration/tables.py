"""What a calibration found, as tables."""

from __future__ import annotations

import numpy as np
import pandas as pd

from .chosen import Chosen
from .evidence import Array
from .fitting import LEVELS, Fitted
from .told import told


def parameter_table(fitted: Fitted) -> pd.DataFrame:
    """A row a parameter [SI]: start, range, estimate, intervals, and whether the data tell it."""
    rows = []
    intervals = {level: fitted.interval(level) for level in LEVELS}
    plain = np.sqrt(np.diag(fitted.plain_covariance))
    known = told(fitted)
    for n, one in enumerate(fitted.chosen):
        row: dict[str, object] = {
            "parameter": one.name,
            "unit": one.unit,
            "start": one.start,
            "range": _range(one),
            "estimate": float(fitted.values[n]),
        }
        for level, bounds in intervals.items():
            row[f"{100 * level:.0f} % from"] = float(bounds[n, 0])
            row[f"{100 * level:.0f} % to"] = float(bounds[n, 1])
        with np.errstate(invalid="ignore", divide="ignore"):
            row["widened"] = float(fitted.deviations[n] / plain[n])
        bound = fitted.at_bound[n]
        row["told"] = f"at its {bound} bound" if bound else ("yes" if known[n] else "no")
        rows.append(row)
    return pd.DataFrame(rows).set_index("parameter")


def fit_table(fitted: Fitted) -> pd.DataFrame:
    """A row a group: rms of the residuals before and after, and the noise as it was estimated."""
    rows = []
    for group, before, after, noise in zip(
        fitted.groups, fitted.before, fitted.residuals, fitted.noise, strict=True
    ):
        rows.append(
            {
                "measured": group.name,
                "numbers": group.count,
                "residuals": group.what,
                "rms before": _rms(before),
                "rms after": _rms(after),
                "noise": float(noise),
                "noise is": "given" if group.given else "estimated",
            }
        )
    return pd.DataFrame(rows).set_index("measured")


def correlation_table(fitted: Fitted) -> pd.DataFrame:
    """Correlation between the estimates."""
    names = [one.name for one in fitted.chosen]
    table = pd.DataFrame(fitted.correlation, index=names, columns=names)
    table.index.name = "parameter"
    return table


def _range(one: Chosen) -> str:
    """Its range, or its deviation from where it was before."""
    if one.deviation:
        return f"{one.centre:.4g} +- {one.deviation:.4g}"
    return f"{one.low:.4g} to {one.high:.4g}"


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
