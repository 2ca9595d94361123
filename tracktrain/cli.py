"""The command `tracktrain`: build the FMUs, run the hopper car."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .errors import TracktrainError
from .failures import Stopped, clear_errors
from .fmu_command import fmu
from .hopper import BLOCK_OF, CARS, TRACKS
from .options import Assignment, Name, Quantity
from .studies.command import study
from .terminal import writable

if TYPE_CHECKING:
    from orchestrator import Run


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


main.add_command(fmu)
main.add_command(study)


@main.command(
    epilog="""\b
Examples:
  tracktrain build --out my-fmus
  tracktrain build --target all
  tracktrain build --target host --target windows-x86_64"""
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
    "--out",
    type=click.Path(path_type=Path),
    default=Path("tracktrain-fmus"),
    show_default=True,
    metavar="DIR",
    help="Folder to write to.",
)
def build(targets: tuple[str, ...], out: Path) -> None:
    """Write carbody.fmu, truck.fmu, wheelrail.fmu and track.fmu.

    The first build for Windows compiles the C runtime too, which takes about a minute.
    """
    with clear_errors():
        from fmus import BLOCKS
        from fmus.export import build as build_fmus

        folder = writable(out)
        for name in BLOCKS:
            path = build_fmus(folder, [name], targets)[name]
            click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


@main.command(
    epilog="""\b
Examples:
  tracktrain run
  tracktrain run --car empty --speed "100 ft/s" --track fra4 --seed 7
  tracktrain run --track perfect --initial truck_front.yaw="0.005 deg" --speed "80 ft/s"
  tracktrain run --set wheelset_11.conicity=0.1 --set track.report_rms="0.05 in"
  tracktrain run --swap truck_rear=my_truck.fmu --out results/my-truck"""
)
@click.option(
    "--car",
    type=Name("car", CARS),
    default="loaded",
    show_default=True,
    help="Parameter set of the car.",
)
@click.option(
    "--speed",
    type=Quantity("speed", "m/s", ("ft/s", "mph", "m/s", "km/h"), "60 ft/s"),
    default="60 ft/s",
    show_default=True,
    metavar="SPEED",
    help="Speed of the train, with its unit.",
)
@click.option(
    "--track",
    type=Name("track", TRACKS),
    default="report",
    show_default=True,
    help="Irregularities of the track.",
)
@click.option(
    "--seed", type=int, default=1, show_default=True, help="Which realisation of the track."
)
@click.option(
    "--duration",
    type=Quantity("duration", "s", ("s", "min", "ms"), "8s"),
    default="8s",
    show_default=True,
    metavar="TIME",
    help="Simulated time.",
)
@click.option(
    "--step",
    type=Quantity("step", "s", ("ms", "s"), "1ms"),
    default="1ms",
    show_default=True,
    metavar="TIME",
    help="Macro step, at which the FMUs exchange values.",
)
@click.option(
    "--master",
    type=Name("master", ("one-pass", "jacobi")),
    default="one-pass",
    show_default=True,
    help="Coupling algorithm.",
)
@click.option(
    "--set",
    "settings",
    type=Assignment(tuple(BLOCK_OF), 'instance.parameter="value unit"'),
    multiple=True,
    metavar='INSTANCE.PARAMETER="VALUE UNIT"',
    help="Change a parameter. Repeatable.",
)
@click.option(
    "--initial",
    "initials",
    type=Assignment(tuple(BLOCK_OF), 'instance.coordinate="value unit"'),
    multiple=True,
    metavar='INSTANCE.COORDINATE="VALUE UNIT"',
    help="Displace a truck or the carbody at the start. Repeatable.",
)
@click.option(
    "--swap",
    "swaps",
    type=Assignment(tuple(BLOCK_OF), "instance=path.fmu"),
    multiple=True,
    metavar="INSTANCE=FMU",
    help="Put another FMU with the same ports in an instance's place. Repeatable.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("tracktrain-results"),
    show_default=True,
    metavar="DIR",
    help="Folder for results.nc and the pictures.",
)
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.pass_context
def run(
    ctx: click.Context,
    car: str,
    speed: float,
    track: str,
    seed: int,
    duration: float,
    step: float,
    master: str,
    settings: tuple[tuple[str, str, str], ...],
    initials: tuple[tuple[str, str, str], ...],
    swaps: tuple[tuple[str, str, str], ...],
    out: Path,
    quiet: bool,
) -> None:
    """Run the 80-ton hopper car; print what came out, write results.nc and pictures.

    Without options: the loaded car at 60 ft/s over 8 s of the 1980 report's track.
    """
    with clear_errors():
        if step > duration:
            raise TracktrainError(
                f"a step of {step:g} s is longer than the run of {duration:g} s; "
                "give a shorter --step or a longer --duration"
            )
        from orchestrator import simulate

        from . import changes, hopper

        folder = writable(out)
        with _progress(duration, quiet) as (stage, progress):
            system = hopper.hopper_car(car, speed, track, seed)
            notes = []
            for instance, _, path in swaps:
                system, lacking = changes.swapped(system, instance, Path(path))
                if lacking:
                    notes.append(f"{path} as {instance} lacks the parameters {', '.join(lacking)}")
            for instance, coordinate, value in initials:
                system = changes.displaced(system, instance, coordinate, value)
            for instance, name, value in settings:
                system = changes.assigned(system, instance, name, value)
            stage("running")
            result = simulate(
                system,
                duration=duration,
                step=step,
                master=master,
                progress=progress,
                command=ctx.meta["command"],
            )
            stage("writing")
            _write(result, folder)
        if not quiet:
            _print(result, [*notes, *result.notes], folder)
    if not result.completed:
        message = result.message or "the run stopped early"
        raise Stopped(f"{message}; what was computed until then is in {folder}")


def _write(result: Run, folder: Path) -> None:
    from . import plots

    result.write(folder)
    plots.write_pictures(result.dataset, folder)


def _print(result: Run, notes: list[str], folder: Path) -> None:
    from rich.console import Console

    from .summary import summary

    console = Console()
    console.print(summary(result))
    for note in notes:
        console.print(f"note: {note}", style="dim", markup=False, highlight=False)
    console.print(f"results.nc and pictures are in {folder}", markup=False, highlight=False)


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
