"""What came out, in numbers beside each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from orchestrator import dominant_frequency, peak, rms

from ..car.layout import Shown

NUMBERS: Mapping[str, Callable[[xr.DataArray], float]] = {"rms": rms, "peak": peak}
FREQUENCY = "dominant frequency [Hz]"


def numbers(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> pd.DataFrame:
    """Rms, peak and dominant frequency of each signal, indexed by quantity and number.

    A column a run; then each other run's number over that of the first, as "b / a". NaN where a
    run does not have the signal, or does not move.
    """
    rows: dict[tuple[str, str], list[float]] = {}
    for quantity in shown:
        values = [data.get(quantity.variable) for data in runs.values()]
        unit = f" [{quantity.scale.unit}]" if quantity.scale.unit else ""
        for name, of in NUMBERS.items():
            rows[quantity.label, name + unit] = [
                np.nan if v is None else of(v) * quantity.scale.factor for v in values
            ]
        rows[quantity.label, FREQUENCY] = [np.nan if v is None else _frequency(v) for v in values]
    index = pd.MultiIndex.from_tuples(list(rows), names=["quantity", "number"])
    table = pd.DataFrame(list(rows.values()), index=index, columns=list(runs), dtype=float)
    first, *others = runs
    with np.errstate(divide="ignore", invalid="ignore"):
        for name in others:
            ratio = table[name].to_numpy() / table[first].to_numpy()
            table[f"{name} / {first}"] = np.where(np.isfinite(ratio), ratio, np.nan)
    return table


def _frequency(values: xr.DataArray) -> float:
    moves = values.size > LEAST and float(np.ptp(values.values)) > 0.0
    return dominant_frequency(values) if moves else np.nan


LEAST = 3
"""Rows of a signal, above which it has a dominant frequency."""
