"""The command `tracktrain run`."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

import orchestrator
from fmus import catalogue

from ...failures import Stopped, termination_as_interrupt
from ...options.chosen import (
    CAR_ONLY,
    Shape,
    chosen_car,
    chosen_file,
    refuse_idle_options,
    refuse_options,
    system_options,
)
from ...options.file import SUFFIX, read_run_file, run_file, schema
from ...options.master import coupling, master_options
from ...options.out import out_option
from ...options.run import (
    REPEATED,
    RESUMED,
    Counting,
    Kept,
    isolated,
    logged,
    run_options,
    survival,
)
from ...options.trust import shown, trust_options, trusted
from ...terminal import writable
from ...typed import typed
from ...waiting import announced
from ..as_json import json_option, print_json

if TYPE_CHECKING:
    from orchestrator import Responses, Run, Sink, System

    from ...answer import Part
    from ...events import Event
    from ..page_beside import PageBeside

PARTS = "answer"
"""Attribute of the results that has the verdict in parts, a line each."""

TEXT, VERBOSE, JSON, NOTHING = "text", "verbose", "json", "nothing"
"""In which form a run is told at the end."""

STYLES = {"good": "bold green", "unknown": "bold", "doubtful": "bold yellow", "bad": "bold red"}
"""How a verdict is shown, by its level."""

FMUS_OF_CHECKPOINT = "checkpoint-fmus"
"""Folder for what an archive holds, which a run needs again when it goes on from a checkpoint."""


@click.command(
    epilog="""\b
Examples:
  tracktrain run
  tracktrain run --car empty --speed "100 ft/s" --track fra4 --seed 7
  tracktrain run --track perfect --initial truck_front.yaw="0.005 deg" --speed "80 ft/s"
  tracktrain run --set 'wheelset_*.conicity=0.1' --set track.report_rms="0.05 in"
  tracktrain run --swap truck_rear=my_truck.fmu --out results/my-truck
  tracktrain run --master jacobi --verify --verify-output "wheelset_*.force_y"
  tracktrain run --speed-profile run-down.csv --track fra5
  tracktrain run --speed "80 ft/s" --track fra4 --save fast.toml
  tracktrain run fast.toml --seed 7
  tracktrain run hopper.ssp --set track.seed=7 --drive track.speed=run-down.csv"""
)
@click.argument(
    "file",
    required=False,
    is_eager=True,
    type=click.Path(path_type=Path),
    metavar="[FILE]",
    callback=lambda ctx, _, path: _of_file(ctx, path),
)
@click.option(
    "--ssd", metavar="NAME", help="Which system to run, where FILE.ssp holds several (.ssd)."
)
@system_options
@master_options
@out_option("Folder for results.nc and the pictures.", "tracktrain-results")
@run_options
@trust_options
@click.option(
    "--save",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.toml",
    help="Write a file that says what the options say, from which the run can be made again.",
)
@click.option(
    "--schema",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=lambda ctx, _, asked: _print_schema(ctx) if asked else None,
    help="Print the JSON schema of such files, for an editor.",
)
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.option(
    "--verbose", is_flag=True, help="Tell how the answer was computed, too, as the page does."
)
@click.pass_context
def command(
    ctx: click.Context,
    file: Path | None,
    ssd: str | None,
    out: Path,
    save: Path | None,
    as_json: bool,
    quiet: bool,
    **options: Any,
) -> None:
    """Run the 80-ton hopper car, or the system of FILE; write results.nc and pictures.

    Without options: the loaded car for 60 s at 30 mph over track of FRA class 5. FILE is an
    archive or a description (.ssd) of the standard SSP; it says itself what is to be run, and
    --set, --swap, --duration and --step change that. Or FILE is a run: options by name in TOML,
    from which typed ones depart (docs/run_files.md).
    """
    if save is not None:
        _save(ctx, save)
    how, coupled, trust = survival(options), coupling(options), trusted(ctx, options)
    kept, isolate, shape = Kept.taken(options), options.pop("isolate"), Shape.taken(options)
    counting = Counting.taken(options)
    resume = kept.resume
    begun = None if resume is None else orchestrator.read_checkpoint(resume)
    folder = writable(resume or out)
    ctx.with_resource(orchestrator.owned(folder, for_runs=True))
    beside = ctx.with_resource(_beside()) if kept.page else None
    start: Callable[..., Run]
    if resume is not None and begun is not None:
        others = {param.name or "" for param in ctx.command.params} - {*RESUMED}
        refuse_options(ctx, others, f"the run in '{resume}' goes on as it began")
        system = begun.system
        start = partial(orchestrator.resume, resume)
    elif kept.again is not None:
        others = {param.name or "" for param in ctx.command.params} - {*REPEATED}
        refuse_options(ctx, others, f"the run in '{kept.again}' is made again as it was")
        asked = orchestrator.read_request(kept.again, [catalogue.folder()])
        system, same = asked.system, replace(asked.settings, out=folder)
        start = partial(orchestrator.simulate, system, asked.master, same)
    elif file is None:
        refuse_options(ctx, ["ssd"], "there is no file to choose a system of")
        refuse_idle_options(ctx, shape)
        system = chosen_car(shape)
    else:
        refuse_options(ctx, CAR_ONLY, f"the car is the one that '{file}' describes")
        unpacked = folder / FMUS_OF_CHECKPOINT if how["checkpoint"] else None
        system = chosen_file(file, ssd, shape, unpacked)
    if resume is None and kept.again is None:
        settings = {**how, **coupled, "self_test": trust["self_test"]}
        settings["isolate"] = isolated(isolate, system)
        start = partial(
            orchestrator.simulate, system, out=folder, command=ctx.meta["command"], **settings
        )
    with (
        _progress(_span(system), quiet or as_json) as (stage, progress),
        logged(ctx, kept.log, kept.log_level) as logger,
        termination_as_interrupt(),
        _shown_live(kept.live) as sinks,
    ):
        stage("running")
        result = start(progress=progress, logger=logger, sinks=sinks)
        if trust["verify"]:
            stage("verifying")
            outputs = trust["verify_output"] or shown(system)
            result = orchestrator.verify(
                system, outputs=outputs, twin=trust["twin"], run=result, **settings
            )
        stage("writing")
        lost = _write(result, folder, kept.csv, beside)
        if resume is None and kept.again is None and shape.settings:
            stage("comparing")
            lost += _idle(result, system, file, ssd, shape, settings)
        told = _judged(result, counting)
        lost += _finish(result, folder, told, beside)
    if result.completed:
        shutil.rmtree(folder / FMUS_OF_CHECKPOINT, ignore_errors=True)
    form = JSON if as_json else NOTHING if quiet else VERBOSE if options["verbose"] else TEXT
    _say(told, result, folder, lost, form)
    if not result.completed:
        raise _stopped(result, folder, bool(how["checkpoint"] or resume))


def _save(ctx: click.Context, file: Path) -> None:
    with orchestrator.whole_file(file) as new:
        new.write_text(run_file(ctx, file.parent), encoding="utf-8")


def _span(system: System) -> float:
    """Time that a system's experiment takes [s]."""
    return (system.experiment.stop or 0.0) - (system.experiment.start or 0.0)


@contextmanager
def _shown_live(port: int | None) -> Iterator[Sequence[Sink]]:
    """The sink of the page that --live asks for, served until the run is over."""
    if port is None:
        yield ()
        return
    from ...live import Live

    with Live(port) as live:
        click.echo(f"the run is shown at {live.address} while it goes on", err=True)
        yield (live,)
    click.echo(
        "the run is over, and its page with it; an open page keeps the last values", err=True
    )


def _stopped(result: Run, folder: Path, goes_on: bool) -> Stopped:
    message = typed(result.message or "the run stopped early")
    hint = f"; go on with --resume {folder}" if goes_on else ""
    return Stopped(f"{message}; what was computed until then is in {folder}{hint}")


def _of_file(ctx: click.Context, path: Path | None) -> Path | None:
    """The system's file: a run's file, which gives options, may name one."""
    if path is None or path.suffix.lower() != SUFFIX:
        return path
    return read_run_file(ctx, path)


def _print_schema(ctx: click.Context) -> None:
    click.echo(json.dumps(schema(ctx.command), indent=2))
    ctx.exit()


def _beside() -> PageBeside:
    from ..page_beside import PageBeside

    return PageBeside()


def _write(result: Run, folder: Path, csv: bool, beside: PageBeside | None) -> list[str]:
    """Write what is made of results.nc, begin the page beside it, and say what could not be."""
    from ... import plots
    from ...results import clear_earlier, read_bonds, write_bonds

    notes: list[str] = []
    with _spared(result, notes):
        notes += clear_earlier(folder)
        write_bonds(result, folder)
        if beside:
            beside.begin(folder, read_bonds(folder))
        plots.write_pictures(result.signals, folder)
        if csv:
            result.write_csv(folder)
    return notes


def _finish(result: Run, folder: Path, told: Told, beside: PageBeside | None) -> list[str]:
    """Write the events, wait for the page, and say what could not be written."""
    from ..events import write_events

    notes: list[str] = []
    with _spared(result, notes):
        write_events(told.events, folder)
        if beside:
            beside.finish()
    return notes


@contextmanager
def _spared(result: Run, notes: list[str]) -> Iterator[None]:
    """Note what cannot be written of a run that stopped early: why it stopped is to be said."""
    try:
        yield
    except (OSError, orchestrator.UnwrittenError) as error:
        if result.completed:
            raise
        notes.append(f"not all pictures and tables could be written: {error}")


def _idle(
    result: Run,
    system: System,
    file: Path | None,
    ssd: str | None,
    shape: Shape,
    settings: Mapping[str, Any],
) -> list[str]:
    """What was set and has no say."""
    from ...idle import idle

    def without(change: tuple[str, str, str]) -> System:
        others = replace(shape, settings=[given for given in shape.settings if given != change])
        return chosen_car(others) if file is None else chosen_file(file, ssd, others)

    left_out = ("checkpoint", "memory", "self_test")
    same = {name: value for name, value in settings.items() if name not in left_out}
    return idle(result, system, shape.settings, without, {**same, "self_test": False})


@dataclass(frozen=True)
class Told:
    """What is said of a run: the rows that count, events, the verdict in parts, and remarks."""

    counted: Responses
    events: list[Event]
    parts: list[Part]
    remarks: list[str]


def _judged(result: Run, counting: Counting) -> Told:
    from ...answer import parts
    from ...car import curving, slip
    from ...events import events

    whole, remarks = result.signals, []
    try:
        counted = counting.counted(whole)
    except ValueError as error:
        counted, remarks = whole, [f"{error}; all of it is counted"]
    remarks += [*curving.remarks(whole), *slip.remarks(whole)]
    return Told(counted, events(whole), parts(counted, result.verdict, whole=whole), remarks)


def _say(told: Told, result: Run, folder: Path, lost: list[str], form: str) -> None:
    """Say the verdict in parts in the results, and with the statistics at the end, in a form."""
    from ...events import nadal_rule
    from ..events import print_events
    from ..summary import numbers, print_summary

    notes = [*result.notes, *lost, *told.remarks, *_say_in_results(told.parts, folder)]
    if form == JSON:
        print_json(
            folder=folder,
            completed=result.completed,
            message=result.message,
            real_time_factor=result.real_time_factor,
            statistics=numbers(told.counted),
            verdict=told.parts,
            events=told.events,
            bonds=result.bonds,
            notes=notes,
        )
    if form not in (TEXT, VERBOSE):
        return
    console = Console()
    print_summary(console, result, told.counted)
    print_events(console, told.events, nadal_rule(told.counted))
    chosen = [n for n in notes if form == VERBOSE or not isinstance(n, orchestrator.Detail)]
    for note in chosen:
        console.print(f"note: {typed(note)}", style="dim", markup=False, highlight=False)
    console.print(f"results.nc and pictures are in {folder}", markup=False, highlight=False)
    for part in told.parts:
        console.print(str(part), style=STYLES[part.level.value], markup=False, highlight=False)


def _say_in_results(judged: list[Part], folder: Path) -> list[str]:
    """Have results.nc say the verdict in parts, and say what hinders."""
    try:
        said = "\n".join(map(str, judged))
        orchestrator.ResultsFile.reopen(folder / orchestrator.RESULTS_NAME).finish({PARTS: said})
    except (OSError, orchestrator.ResultsError) as error:
        return [f"results.nc does not say the verdict in parts: {error}"]
    return []


Report = Callable[[float, float], None]


@contextmanager
def _progress(duration: float, quiet: bool) -> Iterator[tuple[Callable[[str], None], Report]]:
    """What names the stage, and what moves the bar to a simulated and a wall time [s]."""
    console = Console(stderr=True)
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description:9}"),
        BarColumn(bar_width=24),
        TextColumn("{task.completed:.2f} of {task.total:.2f} s"),
        TextColumn("{task.fields[ratio]}"),
    )
    piped = not quiet and not console.is_terminal
    waits = ExitStack()
    with waits, Progress(*columns, console=console, disable=quiet or piped, transient=True) as bar:
        task = bar.add_task("preparing", total=duration, ratio="")

        def stage(name: str) -> None:
            bar.update(task, description=name)
            waits.close()
            if piped:
                waits.enter_context(announced(name))

        def progress(time: float, wall: float) -> None:
            ratio = f"{time / wall:.0f} x real time" if wall > 0.0 else ""
            bar.update(task, completed=time, ratio=ratio)

        yield stage, progress
