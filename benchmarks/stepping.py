"""A macro step at a time beside a whole run: what a hand on the hopper car costs.

    python benchmarks/stepping.py [rounds]

CPU time of the thread; in each round a whole run, one step by step, and one that also reads a
value at each step. At most 5 us a step more are promised for the latter.
"""

from __future__ import annotations

import statistics
import sys
import time

from orchestrator import Execution, OnePass, Settings
from tracktrain import hopper_car

STEPS, STEP = 20_000, 1e-3
READ = "truck_front.axle[1].y"


def whole(execution: Execution) -> None:
    execution.run()


def stepped(execution: Execution) -> None:
    while execution.step():
        pass


def read(execution: Execution) -> None:
    while execution.step():
        execution[READ]


def main(rounds: int) -> None:
    system, settings = hopper_car(), Settings(duration=STEPS * STEP, step=STEP)
    spent: dict[str, list[float]] = {}
    for _ in range(rounds + 1):
        for way in (whole, stepped, read):
            with Execution(system, OnePass(), settings) as execution:
                execution.step()  # the first one is taken in small ones
                begin = time.thread_time()
                way(execution)
                spent.setdefault(way.__name__, []).append(time.thread_time() - begin)
    warm = {name: [1e6 * s / STEPS for s in found[1:]] for name, found in spent.items()}
    print(f"whole run: {statistics.median(warm['whole']):.2f} us a step")
    for name in ("stepped", "read"):
        more = [a - b for a, b in zip(warm[name], warm["whole"], strict=True)]
        print(f"{name}: {statistics.median(more):+.2f} us a step ({min(more):+.2f} at best)")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 5)
