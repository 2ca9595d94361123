"""The hopper car: how fast it steps, how much of that is inside the FMUs, and a whole warm run.

    python benchmarks/hopper_car.py [rounds]

8 s at 1 ms, default options, everything recorded, on one core. The last rows are the whole
command `tracktrain run` in a fresh process, pictures included, with the FMUs built and the
compiled code cached.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from orchestrator import simulate
from tracktrain.car.hopper import hopper_car

RESULT = Path(__file__).parent / "results" / "hopper_car.md"


def stepping(master: str, rounds: int) -> tuple[str, ...]:
    system = hopper_car()
    runs = [simulate(system, duration=8.0, master=master, measure=True) for _ in range(rounds)]
    factors = [run.statistics.real_time_factor for run in runs]
    inside = [run.statistics.time_inside_fmus or 0.0 for run in runs]
    micro = [1e6 * run.statistics.wall_stepping / 8000 for run in runs]
    return (
        f"stepping, {master}",
        f"{statistics.median(micro):.1f} us per macro step",
        f"{statistics.median(factors):.0f} x real time ({min(factors):.0f} to {max(factors):.0f})",
        f"{statistics.median(inside):.0%} inside the FMUs",
    )


def whole_command(rounds: int) -> tuple[str, ...]:
    spent = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds + 1):  # the first warms the caches
            begin = time.perf_counter()
            command = [sys.executable, "-m", "tracktrain", "run", "--quiet", "--out", folder]
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
    rows = [stepping("one-pass", rounds), stepping("jacobi", rounds), whole_command(rounds)]
    table = Table("what", "median", "spread", "share", title="The hopper car, 8 s at 1 ms")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    lines = ["| what | median | spread | share |", "|---|---|---|---|"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    RESULT.write_text(
        f"The hopper car, 8 s at 1 ms, 206 variables recorded; {rounds} rounds.\n\n"
        + "\n".join(lines)
        + "\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
