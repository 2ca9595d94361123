"""Rings of 8 to 8000 FMUs: what a macro step and what loading costs for each instance.

    python benchmarks/scaling.py [rounds]

The ring of `ring.py`, larger. Each master and size runs in a process of its own, rounds in turn;
the fewest seconds of all rounds count. One output of each instance is recorded.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from rich.console import Console
from rich.table import Table
from ring import HERE, STEP, build, ring

from orchestrator import simulate

SIZES = (8, 80, 800, 8000)
MASTERS = {
    "jacobi": {"master": "jacobi"},
    "jacobi, two threads": {"master": "jacobi", "threads": 2},
    "one-pass": {"master": "one-pass"},
}
FIRST = "jacobi"
INSTANCE_STEPS = 800_000
"""Steps of an instance in a run, whatever the size of the ring."""


def one(folder: Path, master: str, blocks: int) -> None:
    """One run in this process; prints seconds per step and instance, and of loading."""
    steps = INSTANCE_STEPS // blocks
    system = ring(folder / "block.fmu", blocks)
    run = simulate(system, duration=steps * STEP, step=STEP, record=["*.x"], **MASTERS[master])
    if not run.completed:
        raise SystemExit(run.message)
    spent = run.statistics.wall_stepping / (steps * blocks)
    print(json.dumps([spent, run.statistics.wall_load / blocks]))


def measure(folder: Path, rounds: int) -> dict[tuple[str, int], tuple[float, float]]:
    """Fewest seconds per step and instance, and of loading an instance."""
    found: dict[tuple[str, int], tuple[float, float]] = {}
    for _ in range(rounds):
        for master in MASTERS:
            for blocks in SIZES:
                command = [sys.executable, __file__, "--one", str(folder), master, str(blocks)]
                done = subprocess.run(command, capture_output=True, text=True, check=True)
                step, load = json.loads(done.stdout)
                known = found.get((master, blocks), (step, load))
                found[master, blocks] = (min(step, known[0]), min(load, known[1]))
    return found


def draw(found: dict[tuple[str, int], tuple[float, float]], path: Path) -> None:
    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    for master in MASTERS:
        values = [1e6 * blocks * found[master, blocks][0] for blocks in SIZES]
        axes.loglog(SIZES, values, "o-", label=master)
    first = 1e6 * SIZES[0] * found[FIRST, SIZES[0]][0]
    linear = [first * blocks / SIZES[0] for blocks in SIZES]
    axes.loglog(SIZES, linear, "k:", label="in proportion")
    axes.set(xlabel="FMUs", ylabel="wall time of a macro step [us]")
    axes.legend(frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=150)


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        build(folder, 2)
        for master in MASTERS:  # compiles the macro loops
            subprocess.run([sys.executable, __file__, "--one", name, master, "8"], check=True)
        found = measure(folder, rounds)
    results = HERE / "results"
    draw(found, results / "scaling.png")
    header = ("master", "FMUs", "ns per step of an FMU", "us per macro step", "load, ms per FMU")
    rows = [
        (
            master,
            f"{blocks}",
            f"{1e9 * found[master, blocks][0]:.0f}",
            f"{1e6 * blocks * found[master, blocks][0]:.1f}",
            f"{1e3 * found[master, blocks][1]:.2f}",
        )
        for master in MASTERS
        for blocks in SIZES
    ]
    table = Table(*header)
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    lines = [
        f"Rings of FMUs, six connections each, {INSTANCE_STEPS} steps of an FMU in a run, one "
        f"output of each recorded; fewest seconds of {rounds} rounds, each in a fresh process.",
        "",
        f"| {' | '.join(header)} |",
        f"|{'---|' * len(header)}",
        *(f"| {' | '.join(row)} |" for row in rows),
        "",
        "Two threads need a core each: where others share the cores, they wait for each other.",
        "",
        "![Wall time of a macro step over the number of FMUs](scaling.png)",
    ]
    (results / "scaling.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(Path(sys.argv[2]), sys.argv[3], int(sys.argv[4]))
    else:
        main()
