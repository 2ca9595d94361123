"""A sweep from start to end: grid, runs, table."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestrator import choices, in_unit, owned

from ..car.hopper import CARS, hopper_car
from ..options.car import fmu_of
from ..options.chosen import PROFILES, Shape, check_pair
from ..options.master import USUAL as COUPLED
from ..terminal import Progress, unseen
from .axes import QUANTITIES, Axis, Given, SweepError, make_axis, shaped
from .one import run_one
from .store import Store, held
from .table import make_table, pace, write_table
from .workers import processes, rows

if TYPE_CHECKING:
    import xarray as xr

USUAL: dict[str, Any] = {**vars(Shape()), **COUPLED}
"""What the runs of a sweep have in common, where it does not say otherwise: as `tracktrain run`."""


def sweep(
    over: Mapping[str, Given] | Sequence[Axis],
    *,
    out: Path | str | None = None,
    outputs: str | Sequence[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    reuse: bool = True,
    progress: Progress = unseen,
    **options: Any,
) -> xr.Dataset:
    """Run the car at every point of a grid; rms, peak and dominant frequency of its outputs.

    over: by "speed", "seed", "car", "track", "layout", "wheel", "rail", "right_wheel",
    "right_rail", "right_radius", "duration", "step", "master" or "instance.parameter" the values,
    as "60:100:20 ft/s", "loaded,empty", names of files or a sequence [SI].
    out: folder for rows.jsonl, which has each run as soon as it is done, and in the end sweep.csv
    and sweep.nc; a sweep that was stopped goes on from there. outputs: names or patterns; those
    that a run prints when None.
    workers, scheduler: see `workers.rows`. reuse: keep FMUs loaded between runs. options: what all
    runs have, by the names of `USUAL`.
    Raises SweepError for what cannot be swept over; a run that fails is a row that says why.
    """
    axes = _axes(over)
    outputs = [outputs] if isinstance(outputs, str) else outputs
    shape = _shape(options, axes)
    _check_pairs(axes, shape)
    points = list(product(*(axis.values for axis in axes)))
    with ExitStack() as stack:
        folder = Path(out or stack.enter_context(tempfile.TemporaryDirectory()))
        stack.enter_context(owned(folder))
        store = Store(folder, _asked(axes, shape, outputs))
        tasks = {
            number: shaped(axes, point, shape)
            for number, point in enumerate(points)
            if number not in store.rows
        }
        begin, before = time.perf_counter(), set(store.rows)
        try:
            work = partial(run_one, outputs=outputs, reuse=reuse)
            ours = not shape["swaps"]
            for number, row in rows(tasks, work, workers, scheduler, here=ours):
                store.add(number, row)
                progress(len(store.rows) / len(points))
        finally:
            table = make_table(axes, store.rows)
            made = [row for number, row in store.rows.items() if number not in before]
            busy = 0 if scheduler else processes(len(tasks), workers)
            table.attrs["pace"] = pace(made, time.perf_counter() - begin, busy)
            if out is not None:
                write_table(table, folder)
    return table


def _axes(over: Mapping[str, Given] | Sequence[Axis]) -> list[Axis]:
    found = (
        [make_axis(name, given) for name, given in over.items()]
        if isinstance(over, Mapping)
        else list(over)
    )
    names = [axis.name for axis in found]
    if not names:
        raise SweepError("there is nothing to sweep over; give at least one axis")
    for name in names:
        if names.count(name) > 1:
            raise SweepError(f"{name} is swept over twice; give all its values at once")
    return found


def _shape(options: Mapping[str, Any], axes: Sequence[Axis]) -> dict[str, Any]:
    for name in options:
        if name not in USUAL:
            raise SweepError(f"a sweep has no option '{name}'; {choices(name, USUAL)}")
    shape = {**USUAL, **options}
    for name, unit in QUANTITIES.items():
        if shape.get(name) is not None:
            shape[name] = in_unit(shape[name], unit, name)
    for axis in axes:
        shape.pop(axis.name, None)
    return shape


def _check_pairs(axes: Sequence[Axis], shape: Mapping[str, Any]) -> None:
    """Raise TracktrainError for wheels and rails that make no contact, before any run is made."""
    values: dict[str, Sequence[Any]] = {axis.name: axis.values for axis in axes}
    for pair in product(*(values.get(name, (shape.get(name),)) for name in PROFILES)):
        check_pair(*pair)


def _files(axes: Sequence[Axis], shape: Mapping[str, Any]) -> dict[str, str]:
    """All files that the runs read, and what each holds, in short."""
    given = [*shape.values(), *(value for axis in axes for value in axis.values)]
    for assigned in ("drives", "maps"):
        given += [file for _, _, file in shape[assigned]]
    return held(given)


def _asked(
    axes: Sequence[Axis], shape: Mapping[str, Any], outputs: Sequence[str] | None
) -> dict[str, Any]:
    """All that decides what the rows are, the FMUs included."""
    from orchestrator import describe

    cars = next((axis.values for axis in axes if axis.name == "car"), [shape.get("car")])
    layouts = [CARS[str(car)].layout for car in cars if car in CARS]
    printed = dict.fromkeys(name for layout in layouts for name in layout.printed)
    fmus = {Path(str(c.fmu)) for c in hopper_car().components.values()}
    fmus |= {fmu_of(given) for _, _, given in shape["swaps"]}
    return {
        "over": {axis.label: axis.values for axis in axes},
        "options": shape,
        "outputs": outputs or list(printed),
        "files": _files(axes, shape),
        "FMUs": {path.name: describe(path).sha256 for path in sorted(fmus)},
    }
