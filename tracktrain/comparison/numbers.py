"""What came out, in numbers beside each other, and which of them differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from orchestrator import Estimate, State, settling

from ..car.layout import Shown
from ..statistics import STATISTICS, UNKNOWN, differ, dominant, excited, swaying, uncertainty

FREQUENCY = "dominant frequency [Hz]"

ANSWERS = {True: "yes", False: "no", None: "?"}
"""Whether a number differs by more than the intervals."""


def numbers(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> pd.DataFrame:
    """Statistics and dominant frequency of each signal, indexed by quantity and number.

    For each run a column, and the wider side of its interval of 95 % in per cent; then each other
    run's number over that of the first, as "b / a", and whether the two differ by more than their
    intervals: "yes", "no", or "?" where these are not known. NaN where a run does not have the
    signal, or does not move.
    """
    found = {key: estimates for quantity in shown for key, estimates in _rows(runs, quantity)}
    index = pd.MultiIndex.from_tuples(list(found), names=["quantity", "number"])
    table = pd.DataFrame(index=index)
    columns = dict(zip(runs, zip(*found.values(), strict=True), strict=True))
    for name, estimates in columns.items():
        table[name] = [e.value for e in estimates]
        table[f"{name} ± [%]"] = [100.0 * uncertainty(e) for e in estimates]
    first, *others = runs
    for name in others:
        pairs = list(zip(columns[first], columns[name], strict=True))
        table[f"{name} / {first}"] = [b.value / a.value if a.value else np.nan for a, b in pairs]
        table[f"{name} differs"] = [ANSWERS[differ(a, b)] for a, b in pairs]
    return table


def unsettled(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> list[str]:
    """For each run whose numbers are those of its span only, a remark."""
    remarks = []
    for name, data in runs.items():
        present = (q for q in shown if q.variable in data)
        states = {q.label: settling(data[q.variable], q.scale.rest).state for q in present}
        moving = {k: s for k, s in states.items() if s not in (State.SETTLED, State.STILL)}
        if moving:
            said = ", ".join(f"{label} {state.value}" for label, state in moving.items())
            remarks.append(f"{name} has not settled ({said}): its numbers are those of this span")
    return remarks


def still(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> list[str]:
    """For each run in which signals do not move, a remark."""
    remarks = []
    for name, data in runs.items():
        present = (q for q in shown if q.variable in data)
        found = [q.label for q in present if not excited(data[q.variable], q.scale.rest)]
        if found:
            remarks.append(f"not excited in {name}: {', '.join(found)}")
    return remarks


def _rows(
    runs: Mapping[str, xr.Dataset], quantity: Shown
) -> list[tuple[tuple[str, str], list[Estimate]]]:
    """By quantity and number, an estimate a run."""
    values = [data.get(quantity.variable) for data in runs.values()]
    unit = f" [{quantity.scale.unit}]" if quantity.scale.unit else ""
    rows = [
        (
            (quantity.label, name + unit),
            [_scaled(UNKNOWN if v is None else of(v), quantity.scale.factor) for v in values],
        )
        for name, of in STATISTICS.items()
    ]
    name, rest = quantity.variable, quantity.scale.rest
    frequencies = [
        dominant(swaying(data, name), rest) if name in data else UNKNOWN for data in runs.values()
    ]
    return [*rows, ((quantity.label, FREQUENCY), frequencies)]


def _scaled(found: Estimate, factor: float) -> Estimate:
    return Estimate(factor * found.value, factor * found.low, factor * found.high)
