"""The command `tracktrain`: build the FMUs, run and export the hopper car."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from fmus.names import FMI_VERSIONS

from ..errors import TracktrainError
from ..failures import (
    Stopped,
    clear_errors,
    termination_as_interrupt,
)
from ..options.chosen import (
    CAR_ONLY,
    chosen_car,
    chosen_file,
    refuse_options,
    system_options,
)
from ..options.master import (
    coupling,
    master_options,
)
from ..options.run import (
    RESUMED,
    isolated,
    logged,
    run_options,
    survival,
)
from ..options.trust import (
    shown,
    trust_options,
    trusted,
)
from ..options.types import Name
from ..terminal import writable
from .finished import (
    assess,
    report,
)
from .fmu import fmu
from .models import (
    new,
    pack,
)
from .self_test import test
from .study import study
from .sweep import sweep

if TYPE_CHECKING:
    from orchestrator import Run

STYLES = {"good": "bold green", "unknown": "bold", "doubtful": "bold yellow", "bad": "bold red"}
"""How a verdict is shown, by its level."""

FMUS_OF_CHECKPOINT = "checkpoint-fmus"
"""Folder for what an archive holds, which a run needs again when it goes on from a checkpoint."""


class Tracktrain(click.Group):
    """The command group; it remembers its arguments, which the results quote."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.meta["command"] = shlex.join(["tracktrain", *args])
        return super().parse_args(ctx, args)


@click.group(
    cls=Tracktrain,
    epilog="""\b
Examples:
  tracktrain run
  tracktrain run --car empty --speed "80 ft/s" --track fra4 --out results/fra4
  tracktrain build --out my-fmus""",
)
@click.version_option(package_name="tracktrain")
def main() -> None:
    """A freight car on irregular track, as coupled FMUs."""


main.add_command(assess)
main.add_command(fmu)
main.add_command(new)
fmu.add_command(pack)
fmu.add_command(test)
main.add_command(report)
main.add_command(study)
main.add_command(sweep)


@main.command(
    epilog="""\b
Examples:
  tracktrain build --out my-fmus
  tracktrain build --target all
  tracktrain build --target host --target windows-x86_64
  tracktrain build --fmi 3.0
  tracktrain build --flavor python"""
)
@click.option(
    "--target",
    "targets",
    multiple=True,
    default=("host",),
    metavar="TARGET",
    help="Platform whose binaries the FMUs hold: host, all, linux-x86_64, linux-aarch64, "
    "windows-x86_64, macos-x86_64 or macos-arm64. Repeatable.  [default: host]",
)
@click.option(
    "--fmi",
    "versions",
    multiple=True,
    type=click.Choice(FMI_VERSIONS),
    default=FMI_VERSIONS,
    help="Version of FMI. Repeatable.  [default: both]",
)
@click.option(
    "--flavor",
    "flavors",
    type=Name("flavor", ("native", "python")),
    multiple=True,
    default=("native",),
    help="Compiled, or Python sources to read and to change. Repeatable.  [default: native]",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("tracktrain-fmus"),
    show_default=True,
    metavar="DIR",
    help="Folder to write to.",
)
def build(
    targets: tuple[str, ...], versions: tuple[str, ...], flavors: tuple[str, ...], out: Path
) -> None:
    """Write carbody.fmu, truck.fmu, wheelrail.fmu and track.fmu, and carbody_fmi3.fmu and so on.

    The first build for Windows compiles the C runtime too, which takes about a minute. The Python
    flavor writes carbody_python.fmu and so on, which need Python with casadi and numpy.
    """
    with clear_errors():
        from fmus import BLOCKS
        from fmus.export import build as build_native
        from fmus.export.python import build_python

        folder = writable(out)
        paths: list[Path] = []
        if "native" in flavors:
            paths += build_native(folder, None, targets, versions).values()
        if "python" in flavors:
            paths += [build_python(name, folder) for name in BLOCKS]
        for path in paths:
            click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


@main.command(
    epilog="""\b
Examples:
  tracktrain run
  tracktrain run --car empty --speed "100 ft/s" --track fra4 --seed 7
  tracktrain run --track perfect --initial truck_front.yaw="0.005 deg" --speed "80 ft/s"
  tracktrain run --set wheelset_11.conicity=0.1 --set track.report_rms="0.05 in"
  tracktrain run --swap truck_rear=my_truck.fmu --out results/my-truck
  tracktrain run --master jacobi --verify --verify-output "wheelset_*.force_y"
  tracktrain run hopper.ssp --set track.seed=7"""
)
@click.argument(
    "file", required=False, is_eager=True, type=click.Path(path_type=Path), metavar="[FILE.ssp]"
)
@click.option(
    "--ssd", metavar="NAME", help="Which system to run, where FILE.ssp holds several (.ssd)."
)
@system_options
@master_options
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("tracktrain-results"),
    show_default=True,
    metavar="DIR",
    help="Folder for results.nc and the pictures.",
)
@run_options
@trust_options
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.pass_context
def run(
    ctx: click.Context,
    file: Path | None,
    ssd: str | None,
    out: Path,
    quiet: bool,
    csv: bool,
    page: bool,
    resume: Path | None,
    isolate: tuple[str, ...],
    log: Path | None,
    log_level: str,
    **shape: Any,
) -> None:
    """Run the 80-ton hopper car, or the system of FILE; write results.nc and pictures.

    Without options: the loaded car at 60 ft/s over 8 s of the 1980 report's track. FILE is an
    archive or a description (.ssd) of the standard SSP; it says itself what is to be run, and
    --set, --swap, --duration and --step change that.
    """
    with clear_errors():
        from orchestrator import (
            read_checkpoint,
            simulate,
            verify,
        )
        from orchestrator import resume as go_on

        how, coupled, trust = survival(shape), coupling(shape), trusted(shape)
        folder = writable(resume or out)
        start: Callable[..., Run]
        if resume is not None:
            others = {param.name or "" for param in ctx.command.params} - {*RESUMED}
            refuse_options(ctx, others, f"the run in '{resume}' goes on as it began")
            system = read_checkpoint(resume).system
            start = partial(go_on, resume)
        elif file is None:
            refuse_options(ctx, ["ssd"], "there is no file to choose a system of")
            system = chosen_car(**shape)
        else:
            refuse_options(ctx, CAR_ONLY, f"the car is the one that '{file}' describes")
            kept = folder / FMUS_OF_CHECKPOINT if how["checkpoint"] else None
            changes = {k: v for k, v in shape.items() if k not in CAR_ONLY}
            system = chosen_file(file, ssd, unpacked=kept, **changes)
        if resume is None:
            settings = {
                **how,
                **coupled,
                "isolate": isolated(isolate, system),
                "self_test": trust["self_test"],
            }
            start = partial(simulate, system, out=folder, command=ctx.meta["command"], **settings)
        experiment = system.experiment
        span = (experiment.stop or 0.0) - (experiment.start or 0.0)
        with (
            _progress(span, quiet) as (stage, progress),
            logged(ctx, log, log_level) as logger,
            termination_as_interrupt(),
        ):
            stage("running")
            result = start(progress=progress, logger=logger)
            if trust["verify"]:
                stage("verifying")
                outputs = trust["verify_output"] or shown(system)
                result = verify(system, outputs=outputs, twin=trust["twin"], run=result, **settings)
            stage("writing")
            lost = _write(result, folder, csv, page)
        if result.completed:
            shutil.rmtree(folder / FMUS_OF_CHECKPOINT, ignore_errors=True)
        if not quiet:
            _print(result, [*result.notes, *lost], folder)
    if not result.completed:
        message = result.message or "the run stopped early"
        hint = f"; go on with --resume {folder}" if how["checkpoint"] or resume else ""
        raise Stopped(f"{message}; what was computed until then is in {folder}{hint}")


@main.command(
    epilog="""\b
Examples:
  tracktrain export hopper.ssp
  tracktrain export fast.ssp --speed "100 ft/s" --track fra4 --seed 7 --duration 20s
  tracktrain export soft.ssp --set truck_front.bolster_lateral.stiffness="2000 lbf/in"
  tracktrain run hopper.ssp"""
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.ssp")
@click.option(
    "--standard",
    type=Name("version of SSP", ("1.0", "2.0")),
    help="Version of the standard SSP.  [default: 1.0, which more tools read; 2.0 where an FMU is "
    "of FMI 3.0]",
)
@click.option(
    "--changes-only",
    is_flag=True,
    help="Leave out values that the FMUs start with anyway. libcosim and ecos cannot read "
    "enumerations such as a creep law; unless changed, these are left out then.",
)
@system_options
def export(file: Path, standard: str | None, changes_only: bool, **shape: Any) -> None:
    """Write the hopper car as an SSP archive, which other co-simulation tools can run.

    It holds the FMUs, the values of their parameters, the connections and the experiment.
    """
    with clear_errors():
        from orchestrator.ssp import write_ssp

        if file.suffix != ".ssp":
            raise TracktrainError(f"'{file}' is no name for an archive; it must end in .ssp")
        system = chosen_car(**shape)
        path = write_ssp(system, file, name=file.stem, version=standard, changes_only=changes_only)
        for note in system.notes:
            click.echo(f"note: {note}")
        click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


def _write(result: Run, folder: Path, csv: bool, page: bool) -> list[str]:
    """Write what is made of results.nc, and say what could not be."""
    from .. import plots
    from ..results import (
        BONDS,
        bond_table,
        opened,
    )

    try:
        bonds = bond_table(result)
        bonds.to_csv(folder / BONDS)
        plots.write_pictures(result.dataset, folder)
        if page:
            from ..report import write_report

            write_report(opened(folder), folder, bonds)
        if csv:
            result.write_csv(folder)
    except OSError as error:
        if result.completed:
            raise
        return [f"not all pictures and tables could be written: {error}"]
    return []


def _print(result: Run, notes: list[str], folder: Path) -> None:
    from rich.console import Console

    from .summary import summary

    console = Console()
    console.print(summary(result))
    for note in notes:
        console.print(f"note: {note}", style="dim", markup=False, highlight=False)
    console.print(f"results.nc and pictures are in {folder}", markup=False, highlight=False)
    console.print(str(result.verdict), style=STYLES[result.verdict.level.value], markup=False)


Report = Callable[[float, float], None]


@contextmanager
def _progress(duration: float, quiet: bool) -> Iterator[tuple[Callable[[str], None], Report]]:
    """What names the stage, and what moves the bar to a simulated and a wall time [s]."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

    console = Console(stderr=True)
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description:9}"),
        BarColumn(bar_width=24),
        TextColumn("{task.completed:.2f} of {task.total:.2f} s"),
        TextColumn("{task.fields[ratio]}"),
    )
    hidden = quiet or not console.is_terminal
    with Progress(*columns, console=console, disable=hidden, transient=True) as bar:
        task = bar.add_task("preparing", total=duration, ratio="")

        def stage(name: str) -> None:
            bar.update(task, description=name)

        def progress(time: float, wall: float) -> None:
            ratio = f"{time / wall:.0f} x real time" if wall > 0.0 else ""
            bar.update(task, completed=time, ratio=ratio)

        yield stage, progress
