"""The hopper car: how fast it steps, how much of that is inside the FMUs, and a whole warm run.

    python benchmarks/hopper_car.py [rounds]

8 s at 1 ms, default options, everything recorded, on one core. The floor is the same calls of the
FMUs as straight C (`floor.py`), in turn with ours and with the same rows: the macro loop alone,
then with what only a run does. The last row is the whole command `tracktrain run` in a fresh
process, pictures included, with the FMUs built and the compiled code cached.
"""

from __future__ import annotations

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from floor import Floor
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from orchestrator import Settings, System, simulate
from orchestrator.masters.loop.record import record_of
from orchestrator.masters.one_pass import OnePass
from orchestrator.run.execution import Execution
from tracktrain.car.hopper import hopper_car

STEPS, STEP = 8000, 1e-3
SETTINGS = Settings(duration=STEPS * STEP, step=STEP)
Rows = NDArray[np.float64]
RESULT = Path(__file__).parent / "results" / "hopper_car.md"


def stepping(master: str, rounds: int) -> tuple[str, ...]:
    system = hopper_car(speed="60 ft/s", track="report")
    runs = [
        simulate(system, duration=STEPS * STEP, master=master, measure=True) for _ in range(rounds)
    ]
    factors = [run.statistics.real_time_factor for run in runs]
    inside = [run.statistics.time_inside_fmus or 0.0 for run in runs]
    micro = [1e6 * run.statistics.wall_stepping / STEPS for run in runs]
    return (
        f"stepping, {master}",
        f"{statistics.median(micro):.1f} us per macro step",
        f"{statistics.median(factors):.0f} x real time ({min(factors):.0f} to {max(factors):.0f})",
        f"{statistics.median(inside):.0%} inside the FMUs",
    )


def beside_floor(rounds: int) -> list[tuple[str, ...]]:
    """One-pass steps of the car and of the floor in turn: CPU time.

    The ratio of the smallest times is what a busy machine spoils least; the median of the ratios in
    a round is beside it. The floor only steps: what ours does beside that is counted row by row.
    """
    spent = {name: np.array(times) for name, times in _rounds(3 * rounds).items()}
    floor = spent.pop(FLOOR)
    micro = 1e6 / STEPS
    rows = [(f"stepping, {FLOOR}", f"{micro * floor.min():.1f} us at best", "", "")]
    for name, ours in spent.items():
        ratios = ours / floor
        rows.append(
            (
                f"stepping, {name}",
                f"{micro * ours.min():.1f} us at best",
                f"{ours.min() / floor.min():.2f} times the floor at best, {np.median(ratios):.2f} "
                f"in the median ({ratios.min():.2f} to {ratios.max():.2f})",
                "",
            )
        )
    return rows


FLOOR, LOOP, ENDS, RUN = (
    "the floor in plain C",
    "the macro loop alone",
    "the macro loop, with what the energies of bonds need",
    "the whole run: energies, a look at the surroundings, chunks",
)


def _rounds(count: int) -> dict[str, list[float]]:
    """CPU seconds by what was timed; raises SystemExit where the rows of two differ."""
    system = hopper_car()
    alone = replace(system, bonds=())
    spent: dict[str, list[float]] = {name: [] for name in (FLOOR, LOOP, ENDS, RUN)}
    for _ in range(count):
        record, seconds = whole_run(system)
        spent[RUN].append(seconds)
        for name, of in ((FLOOR, system), (LOOP, alone), (ENDS, system)):
            rows, seconds = loop_of(of, record, plain=name == FLOOR)
            spent[name].append(seconds)
            if not np.array_equal(rows, record):
                raise SystemExit(f"the rows differ from ours: {name}")
    return spent


def whole_run(system: System) -> tuple[Rows, float]:
    """The record of a run, and CPU seconds of its steps but the first."""
    with Execution(system, OnePass(), SETTINGS) as execution:
        execution.step()  # the first one is taken in small ones
        begin = time.thread_time()
        execution.run()
        spent = time.thread_time() - begin
        run = execution.finish()
    return run.record[:, : len(execution.context.plan.columns)], spent


def loop_of(system: System, record: Rows, *, plain: bool) -> tuple[Rows, float]:
    """The rows that the floor makes or the macro loop, and CPU seconds; two rows are given."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Execution(system, OnePass(), SETTINGS) as execution,
    ):
        execution.initialise()
        prepared = execution.context.prepared
        floor = Floor(execution.context, Path(folder)) if plain else None
        loop = prepared.advance.bound(prepared.tables)
        execution.step()
        rows = np.ones_like(record, order="C")
        rows[:2] = record[:2]
        made = record_of(rows, np.ones((len(rows), len(prepared.led))))
        report = np.zeros(4, np.int64)
        begin = time.thread_time()
        if floor:
            floor.run(STEP, STEP, rows)
        else:
            loop(1, STEPS, 0.0, STEP, made, report)
        return rows, time.thread_time() - begin


def whole_command(rounds: int) -> tuple[str, ...]:
    spent = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds + 1):  # the first warms the caches
            begin = time.perf_counter()
            command = [sys.executable, "-m", "tracktrain", "run", "--duration", "8s", "--quiet"]
            command += ["--out", folder]
            subprocess.run(command, check=True)
            spent.append(time.perf_counter() - begin)
    warm = spent[1:]
    return (
        "`tracktrain run`, warm, start to finish",
        f"{statistics.median(warm):.2f} s",
        f"{min(warm):.2f} to {max(warm):.2f} s",
        "",
    )


def main(rounds: int) -> None:
    rows = [
        stepping("one-pass", rounds),
        *beside_floor(rounds),
        stepping("jacobi", rounds),
        whole_command(rounds),
    ]
    table = Table("what", "median", "spread", "share", title="The hopper car, 8 s at 1 ms")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    lines = ["| what | median | spread | share |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    RESULT.write_text(
        f"The hopper car, 8 s at 1 ms, all variables recorded; {rounds} rounds on {os.cpu_count()} "
        f"processors {platform.machine()}, load {os.getloadavg()[0]:.1f}. Beside the floor it "
        "is CPU time, else wall time.\n\n" + "\n".join(lines) + "\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
