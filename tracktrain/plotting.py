"""A picture of any signals of one or several runs, of the car or of any other system.

plot("tracktrain-results", ["wheelset_11.force_y in lbf", "carbody cg ay"]).savefig("plot.png")
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from orchestrator import Run, UnitError, choices, conversion

from .car.hopper import layout_of
from .car.layout import Shown
from .errors import TracktrainError
from .overlaid import LEAST_ROWS, TIME, Over, overlaid
from .quantities import shown_quantities
from .results import dataset_of
from .runs import named, within
from .scales import Scale

MOST = 24
"""Panels of which a picture can still be read."""

IN = " in "
"""Between a signal and the unit that it is shown in."""

Given = xr.Dataset | Run | Path | str


def plot(
    runs: Given | Sequence[Given] | Mapping[str, Given],
    of: str | Sequence[str] = (),
    *,
    over: str = "time",
    spectrum: bool = False,
    together: bool = False,
    begin: float | None = None,
    end: float | None = None,
) -> Figure:
    """A panel for each signal, the runs over each other.

    runs: each itself, its dataset, or the folder that it wrote; names of one's own as a mapping.
    of: signals as `orchestrator.picked` reads them, such as "wheelset_*.force_y", "carbody cg ay"
    or "lateral force in lbf"; by default those of the car, else the first ones. over: "time",
    "distance" or a signal. spectrum: power spectral densities. together: signals of one unit share
    a panel. begin, end: the span of time [s].
    Raises TracktrainError for a signal that no run has, and for what cannot be drawn.
    """
    datasets = {
        name: within(name, data, begin, end) if begin is not None or end is not None else data
        for name, data in _by_name(runs).items()
    }
    shown = _shown(datasets, [of] if isinstance(of, str) else of)
    groups: dict[str, list[Shown]] = {}
    for n, signal in enumerate(shown):
        groups.setdefault(signal.scale.unit if together else str(n), []).append(signal)
    if len(groups) > MOST:
        first = ", ".join(signal.label for signal in shown[:4])
        raise TracktrainError(
            f"{len(groups)} signals are meant ({first} ...), and a picture holds {MOST} panels; "
            "name fewer, or have those of one unit together (--together)"
        )
    axis = _over(datasets, over)
    if spectrum and not axis.ordered:
        raise TracktrainError("a spectrum goes over time or distance; leave one of the two out")
    short = [n for n, d in datasets.items() if spectrum and d.sizes["time"] < LEAST_ROWS]
    if short:
        raise TracktrainError(
            f"run {short[0]} has {datasets[short[0]].sizes['time']} rows there, and a spectrum "
            f"takes {LEAST_ROWS} at least; choose a longer span, or a longer run"
        )
    return overlaid(datasets, list(groups.values()), axis, spectrum)


def _by_name(runs: Given | Sequence[Given] | Mapping[str, Given]) -> dict[str, xr.Dataset]:
    if isinstance(runs, Mapping) and not isinstance(runs, xr.Dataset):
        return {name: dataset_of(run) for name, run in runs.items()}
    several: list[Any] = list(runs) if isinstance(runs, list | tuple) else [runs]
    if all(isinstance(run, Path | str) for run in several):
        return named([Path(run) for run in several])
    return {f"run {n}": dataset_of(run) for n, run in enumerate(several, start=1)}


def _shown(runs: Mapping[str, xr.Dataset], asked: Sequence[str]) -> list[Shown]:
    """What is drawn; a unit behind a signal's name is the one that it is drawn in."""
    if not asked:
        return shown_quantities(runs)
    return [shown for one in asked for shown in _asked(runs, one)]


def _asked(runs: Mapping[str, xr.Dataset], asked: str) -> list[Shown]:
    name, given, unit = asked.rpartition(IN)
    found = shown_quantities(runs, [name if given else asked], only=True)
    if not given:
        return found
    return [Shown(s.variable, s.label, _scale(_unit(runs, s.variable), unit)) for s in found]


def _unit(runs: Mapping[str, xr.Dataset], name: str) -> str:
    return next(str(data[name].attrs.get("units", "1")) for data in runs.values() if name in data)


def _scale(own: str, unit: str) -> Scale:
    """How a signal of a unit is shown in another; raises TracktrainError."""
    try:
        found = conversion(own, unit.strip())
    except UnitError as error:
        raise TracktrainError(f"{error}; name one such as mm or lbf") from None
    if found is None or found[1]:
        raise TracktrainError(f"a signal in {own} cannot be shown in {unit}; name another unit")
    return Scale(unit.strip(), found[0])


def _over(runs: Mapping[str, xr.Dataset], asked: str) -> Over:
    if asked == "time":
        return TIME
    if asked == "distance" and all(layout_of(data).distance in data for data in runs.values()):
        return Over(lambda data: _way(data), "distance run", "m")
    present = dict.fromkeys(str(name) for data in runs.values() for name in data.data_vars)
    found = _asked(runs, asked) if asked != "distance" else []
    everywhere = [s for s in found if all(s.variable in data for data in runs.values())]
    if len(everywhere) != 1:
        names = [s.variable for s in everywhere or found] or ["time", *present]
        raise TracktrainError(
            f"'{asked}' is not one signal that every run has, to draw over; {choices(asked, names)}"
        )
    (signal,) = everywhere
    factor = signal.scale.factor
    return Over(
        lambda data: np.asarray(data[signal.variable].values, float) * factor,
        signal.label,
        signal.scale.unit or "1",
        ordered=False,
    )


def _way(data: xr.Dataset) -> np.ndarray:
    return np.asarray(data[layout_of(data).distance].values, float)
