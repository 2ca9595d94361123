"""A page of tables, and of the signals of runs over each other to pick from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from . import as_json, series
from .packing import packed
from .rendering import rendered
from .sheet import parts

SCRIPTS = ("common.js", "data.js", "chart.js", "plots.js", "overlay.js")


def overlay(
    title: str,
    runs: Mapping[str, xr.Dataset],
    first: Sequence[str],
    tables: Mapping[str, pd.DataFrame],
    notes: Sequence[str],
    command: str,
) -> str:
    """The text of the page. first: signals that are shown before others are picked."""
    names = list(dict.fromkeys(str(n) for data in runs.values() for n in data.data_vars))
    number = {name: n for n, name in enumerate(names)}
    said: dict[str, dict[str, Any]] = {}
    arrays: dict[str, series.Array] = {}
    widths = [1]
    for r, data in enumerate(runs.values()):
        signals, found, width = series.signals(data, series.POINTS // max(len(runs), 2))
        widths.append(width)
        rows = [number[signal["name"]] for signal in signals]
        for name in ("signals", "density"):  # a signal that the run does not have is a gap
            whole = np.full((len(names), found[name].shape[1]), np.nan)
            whole[rows] = found[name]
            found[name] = whole
        arrays |= {f"{name}{r}": values for name, values in found.items()}
        for signal in signals:
            known = said.setdefault(signal["name"], signal)
            if signal["factor"] < known["factor"]:
                said[signal["name"]] = signal
    index, blob = packed(arrays)
    known = {"signals": [said[n] for n in names], "first": list(first), "events": []}
    return rendered(
        "comparison.html",
        SCRIPTS,
        title=title,
        command=command,
        notes=notes,
        rows=max(data.sizes["time"] for data in runs.values()),
        width=max(widths),
        index=as_json({**known, "runs": list(runs), "arrays": index}),
        blob=blob,
        **parts(tables, {}),
    )
