"""A sweep of the hopper car: two processes against one, and what it saves to keep FMUs loaded.

    python benchmarks/sweep.py [rounds]

Speeds of 60, 80 and 100 ft/s, 40 seeds each, 8 s at 1 ms. This process is one of them, from the
first moment. `steady` is over the last two thirds of the rows, when the other one has started and
imported all; `all` is from start to end. The ratios are of sweeps that follow one another, so that
other load falls on both.
"""

from __future__ import annotations

import os
import statistics
import sys
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tracktrain.sweep import sweep

RESULT = Path(__file__).parent / "results" / "sweep.md"
OVER = {"speed": "60:100:20 ft/s", "seed": "1:40"}
COUNT = 120
STARTED = COUNT // 3
"""Rows after which all processes are at work."""


def spent(workers: int, reuse: bool = True) -> tuple[float, float]:
    """Wall time [s] a run when all are at work, and of the whole sweep."""
    begin = time.perf_counter()
    done: list[float] = []
    sweep(
        OVER,
        duration=8.0,
        track="report",
        workers=workers,
        reuse=reuse,
        progress=lambda share: done.append(time.perf_counter()),
    )
    return (done[-1] - done[STARTED]) / (COUNT - 1 - STARTED), time.perf_counter() - begin


def main(rounds: int) -> None:
    sweep({"seed": "1:2"}, workers=1)  # builds, compiles
    found = [(spent(1), spent(2), spent(1, reuse=False)) for _ in range(rounds)]
    per_run = [1e3 * one[0] for one, _, _ in found]
    ratios = {
        "two processes against one, steady": [one[0] / two[0] for one, two, _ in found],
        "two processes against one, all": [one[1] / two[1] for one, two, _ in found],
        "FMUs kept loaded against loaded for each run": [
            anew[0] / one[0] for one, _, anew in found
        ],
    }
    rows = [
        (
            "one process, FMUs kept loaded",
            f"{statistics.median(per_run):.0f} ms a run",
            f"{min(per_run):.0f} to {max(per_run):.0f} ms",
        )
    ]
    for name, values in ratios.items():
        spread = f"{min(values):.2f} to {max(values):.2f}"
        rows.append((name, f"{statistics.median(values):.2f} times as fast", spread))
    table = Table("what", "median", "spread", title=f"Sweep of {COUNT} runs of 8 s at 1 ms")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    load, cores = os.getloadavg()[0], os.cpu_count()
    lines = ["| what | median | spread |", "|---|---|---|"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    RESULT.write_text(
        f"Sweep of {COUNT} runs of 8 s at 1 ms (`sweep.py`), {rounds} rounds, {cores} cores; load "
        f"average {load:.1f} at the end.\n\n" + "\n".join(lines) + "\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
