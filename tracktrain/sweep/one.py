"""One run of a sweep, in whatever process: options in, a row of numbers out."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from orchestrator import Responses, Run, Session

Row = dict[str, Any]

LOAD_RATIOS = "*.l_over_v"
"""Outputs whose largest value is a column of its own."""

NUMBERS = {
    "l_over_v.max": "1",
    "energy_residual": "1",
    "wall_time": "s",
    "stepping_time": "s",
}
"""Columns beside those of the outputs, and their units."""

TEXTS = ("creep_law", "verdict", "message")


@cache
def session() -> Session:
    """The process's own, which keeps the FMUs loaded from run to run."""
    from orchestrator import Session

    return Session()


def run_one(options: Mapping[str, Any], outputs: Sequence[str] | None, reuse: bool = True) -> Row:
    """Run the car of `chosen_car`'s options and `simulate`'s coupling; its numbers by column.

    The units stand under "units". A run that fails says why under "message", and has what was
    computed until then.
    """
    from orchestrator import simulate

    from ..car.creep import laws
    from ..car.hopper import layout_of
    from ..failures import PACKAGES, heard
    from ..options.chosen import Shape, chosen_car

    begin = time.perf_counter()
    coupled = dict(options)
    shape = Shape.taken(coupled)
    try:
        system = chosen_car(shape)
        layout = layout_of(system)
        outputs = outputs or layout.printed
        line = {c.source for c in system.connections} & {f"{layout.track}.curvature"}
        run = simulate(
            system,
            record=[*outputs, LOAD_RATIOS, *line],  # whose curves have no frequency
            session=session() if reuse else None,
            **coupled,
        )
    except Exception as error:
        if type(error).__module__.partition(".")[0] in PACKAGES:
            said = str(error)
        else:
            said = f"{type(error).__name__}: {error}"
        return {"units": {}, "message": said, "wall_time": time.perf_counter() - begin}
    row = _numbers(heard(run), outputs)
    row |= {"creep_law": laws(system), "verdict": str(run.verdict), "message": run.message or ""}
    row["stepping_time"] = run.statistics.wall_stepping
    row["wall_time"] = time.perf_counter() - begin
    return row


def _numbers(run: Run, outputs: Sequence[str]) -> Row:
    from orchestrator import dominant_frequency, peak, picked, rms

    from ..statistics import swaying

    data = run.signals
    row: Row = {"units": {}}
    names = [str(name) for name in data.data_vars]
    wanted = {name for asked in outputs for name in picked(asked, names)}
    for name in names:
        if name in wanted:
            values = data[name]
            unit = str(values.attrs.get("units", "1"))
            row |= {f"{name}.rms": rms(values), f"{name}.peak": peak(values)}
            row[f"{name}.frequency"] = dominant_frequency(swaying(data, name))
            row["units"] |= {f"{name}.rms": unit, f"{name}.peak": unit, f"{name}.frequency": "Hz"}
    ratios = [_largest(data, str(n)) for n in data.data_vars if fnmatchcase(str(n), LOAD_RATIOS)]
    if ratios:
        row["l_over_v.max"] = max(ratios)
    if run.bonds:
        row["energy_residual"] = max(bond.relative for bond in run.bonds)
    return row


def _largest(data: Responses, name: str) -> float:
    return float(np.max(np.abs(data[name].values)))
