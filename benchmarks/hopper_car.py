"""The hopper car: how fast it steps, how much of that is inside the FMUs, and a whole warm run.

    python benchmarks/hopper_car.py [rounds]

8 s at 1 ms, default options, everything recorded, on one core. The floor is the same calls of the
FMUs as straight C (`floor.py`), in turn with ours and with the same rows. The last row is the
whole command `tracktrain run` in a fresh process, pictures included, with the FMUs built and the
compiled code cached.
"""

from __future__ import annotations

import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from floor import Floor
from rich.console import Console
from rich.table import Table

from orchestrator import Settings, simulate
from orchestrator.masters.one_pass import OnePass
from orchestrator.run.execution import Execution
from tracktrain.car.hopper import hopper_car

STEPS, STEP = 8000, 1e-3
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


def beside_floor(rounds: int) -> tuple[str, ...]:
    """One-pass steps of the car and of the floor in turn: CPU time.

    The ratio of the smallest times is what a busy machine spoils least; the median of the ratios in
    a round is beside it.
    """
    ours, floor = zip(*(one_round() for _ in range(3 * rounds)), strict=True)
    ratios = np.array(ours) / floor
    return (
        "stepping, the floor in plain C",
        f"{1e6 * min(floor) / STEPS:.1f} us at best, ours {1e6 * min(ours) / STEPS:.1f} us",
        f"ours {min(ours) / min(floor):.2f} times the floor at best, "
        f"{np.median(ratios):.2f} in the median ({ratios.min():.2f} to {ratios.max():.2f})",
        "",
    )


def one_round() -> tuple[float, float]:
    """CPU seconds of our steps and of the floor's; raises SystemExit where their rows differ."""
    system, settings = hopper_car(), Settings(duration=STEPS * STEP, step=STEP)
    with Execution(system, OnePass(), settings) as execution:
        execution.step()  # the first one is taken in small ones
        begin = time.thread_time()
        execution.run()
        spent = time.thread_time() - begin
        run = execution.finish()
    with (
        tempfile.TemporaryDirectory() as folder,
        Execution(system, OnePass(), settings) as execution,
    ):
        execution.initialise()
        floor = Floor(execution.context, Path(folder))
        execution.step()
        ours = run.record[:, : len(execution.context.plan.columns)]
        rows = np.ones_like(ours, order="C")
        rows[:2] = ours[:2]
        begin = time.thread_time()
        floor.run(STEP, STEP, rows)
        spent_by_floor = time.thread_time() - begin
    if not np.array_equal(rows, ours):
        raise SystemExit("the floor's rows differ from ours")
    return spent, spent_by_floor


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
        beside_floor(rounds),
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
