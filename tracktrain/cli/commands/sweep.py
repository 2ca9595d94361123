"""The command `tracktrain sweep`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console

from ...failures import Stopped, termination_as_interrupt
from ...options.chosen import refuse_options, system_options
from ...options.master import master_options
from ...options.out import out_option
from ...options.workers import workers_option
from ...terminal import print_whole, printable, progress_bar, writable
from ..as_json import json_option, print_json

if TYPE_CHECKING:
    import xarray as xr


@click.command(
    epilog="""\b
Examples:
  tracktrain sweep --over speed=20:140:5ft/s --over seed=1:50
  tracktrain sweep --over car=loaded,empty --over speed=40:120:10ft/s --track fra4
  tracktrain sweep --over "wheelset_*.conicity=0.02:0.2:0.02" --workers 4
  tracktrain sweep --over truck_front.initial.yaw=0.1:1:0.1deg --track perfect
  tracktrain sweep --over wheel=conical,worn --rail crown --over layout=a.toml,b.toml
  tracktrain sweep --over seed=1:1000 --scheduler tcp://node1:8786 --out many"""
)
@click.option(
    "--over",
    "axes",
    multiple=True,
    required=True,
    metavar="NAME=VALUES",
    help="What to sweep over: speed, seed, car, track, layout, wheel, rail, right_wheel, "
    "right_rail, right_radius, duration, step, master or an instance.parameter, of several "
    "instances as in wheelset_*.conicity; as start:stop:step with a unit, or a list with commas, "
    "of files, too. Repeatable: all combinations are run.",
)
@system_options
@master_options
@click.option(
    "--output",
    "outputs",
    multiple=True,
    metavar="PATTERN",
    help="Take the numbers of the outputs whose names match. Repeatable.  [default: those that a "
    "run prints]",
)
@workers_option()
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Run on the cluster of this Dask scheduler instead; needs tracktrain[cluster].",
)
@out_option(
    "Folder for the table and pictures; a sweep that was stopped goes on there.", "tracktrain-sweep"
)
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.pass_context
def command(
    ctx: click.Context,
    axes: tuple[str, ...],
    outputs: tuple[str, ...],
    workers: int | None,
    scheduler: str | None,
    out: Path,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Run the hopper car at every combination of some values; one table out.

    Each run that is done is on the disk at once: after Ctrl-C, or a kill, the same command goes on.
    A run that fails is a row that says why. Writes sweep.csv, sweep.nc and a picture an output.
    """
    from ...sweep.axes import read_axis
    from ...sweep.grid import sweep as run_sweep
    from ...sweep.pictures import write_pictures

    found = [read_axis(text) for text in axes]
    for axis in found:
        refuse_options(ctx, [axis.name], f"{axis.name} is swept over")
    folder = writable(out)
    try:
        with progress_bar("sweep", hidden=quiet or as_json) as progress, termination_as_interrupt():
            table = run_sweep(
                found,
                out=folder,
                outputs=outputs or None,
                workers=workers,
                scheduler=scheduler,
                progress=progress,
                **options,
            )
    except KeyboardInterrupt:
        raise Stopped(
            f"interrupted; the runs that are done are in {folder}, and the same command goes "
            "on with the others"
        ) from None
    write_pictures(table, folder)
    if as_json:
        print_json(runs=table)
    elif not quiet:
        _print(table, [axis.digest for axis in found], folder)
    messages = [str(text) for text in table["message"].values.ravel()]
    if messages and all(messages):
        raise Stopped(f"no run came to its end; the first one: {messages[0]}")


def _print(table: xr.Dataset, axes: list[str], folder: Path) -> None:
    from ...sweep.table import digest, idle_axes, mixed_laws

    console = Console()
    failed = [str(text) for text in table["message"].values.ravel() if text]
    print_whole(console, printable(digest(table), f"{table['done'].size} runs: {'; '.join(axes)}"))
    if failed and len(failed) < table["message"].size:
        note = f"note: {len(failed)} runs failed, as: {failed[0]}"
        console.print(note, style="dim", markup=False, highlight=False)
    for axis in idle_axes(table):
        note = f"note: {axis} changed no bit of any number: it has no say in these runs"
        console.print(note, style="dim", markup=False, highlight=False)
    if laws := mixed_laws(table):
        note = f"note: creep laws differ, {laws}; --set '*.creep_law=polach' for one in all runs"
        console.print(note, style="dim", markup=False, highlight=False)
    console.print(table.attrs["pace"], markup=False, highlight=False)
    console.print(
        f"sweep.csv, sweep.nc and pictures are in {folder}", markup=False, highlight=False
    )
