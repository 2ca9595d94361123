"""What a native FMU's step costs beyond its equations, in FMI 2.0 and 3.0, and how fast it loads.

    python benchmarks/fmu_step.py [ROUNDS]

Each round times, one after the other, the generated step function alone and the FMUs' doStep over
one micro step; the figures are ratios within a round, so that a busy machine spoils few of them.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from rich.console import Console
from rich.table import Table

from fmus.catalogue import fmu_path
from fmus.export.compiler import compiler_command, host_target

HERE = Path(__file__).parent
RESULT = HERE / "results" / "fmu_step.md"
MICRO_STEP = {"carbody": 1e-3, "truck": 2.5e-4, "wheelrail": 1e-3, "track": 1e-3}
"""Steps [s] that are one micro step."""

FLAGS = ("-std=c11", "-O2", "-fomit-frame-pointer", "-ffp-contract=off", "-g0", "-w")


def library(path: Path, fmi: str, folder: Path) -> tuple[Path, str, Path]:
    """The host's library out of an FMU, its GUID and the folder of its sources."""
    extract(str(path), str(folder))
    target, said = host_target(), read_model_description(str(path))
    name = f"{said.coSimulation.modelIdentifier}{target.suffix}"
    return folder / "binaries" / target.folder(fmi) / name, said.guid, folder / "sources"


def rounds_of(fmu2: Path, fmu3: Path, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Nanoseconds to load both libraries, and a step's, (round, what): what host.c prints.

    size: of a step [s].
    """
    tunable = next(
        (
            v.valueReference
            for v in read_model_description(str(fmu2)).modelVariables
            if v.causality == "parameter" and v.variability == "tunable" and v.type == "Real"
        ),
        0,
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        two, guid2, sources = library(fmu2, "2.0", folder / "2")
        three, guid3, _ = library(fmu3, "3.0", folder / "3")
        program = folder / "host"
        files = [HERE / "fmu_step" / "host.c", sources / "block.c"]
        command = [*compiler_command(host_target()), *FLAGS, f"-I{sources}", *files]
        subprocess.run([*command, "-o", program, "-lm", "-ldl"], check=True)
        done = subprocess.run(
            [program, two, three, guid2, guid3, str(size), str(tunable)],
            check=True,
            capture_output=True,
            text=True,
        )
    load, *rounds = ([float(v) for v in line.split()] for line in done.stdout.splitlines())
    return np.array(load), np.array(rounds)


def main(repeats: int) -> None:
    head = (
        "block",
        "equations [ns]",
        "empty calls [ns]",
        "evaluation [ns]",
        "of equations, at best",
        "of equations, median",
        "of both, at best",
        "bare [ns]",
        "FMI 2.0 / bare",
        "FMI 3.0 / 2.0",
        "with exchange",
        "parameter set",
        "load 2.0, 3.0 [ms]",
    )
    rows = []
    for block in MICRO_STEP:
        files = fmu_path(block), fmu_path(block, "3.0")
        loads, rounds = zip(
            *(rounds_of(*files, MICRO_STEP[block]) for _ in range(repeats)), strict=True
        )
        times = np.concatenate(rounds)
        needed, bare, two, three, two_exchange, three_exchange, two_set, calls = times.T
        rows.append(
            (
                block,
                f"{needed.min():.0f}",
                f"{calls.min():.0f}",
                f"{two_exchange.min():.0f}",
                f"{two_exchange.min() / needed.min():.2f}",
                f"{np.median(two_exchange / needed):.2f}",
                f"{two_exchange.min() / (needed.min() + calls.min()):.2f}",
                f"{bare.min():.0f}",
                f"{np.median(two / bare):.2f}",
                f"{np.median(three / two):.2f}",
                f"{np.median(three_exchange / two_exchange):.2f}",
                f"{np.median(two_set / two):.2f}",
                ", ".join(f"{1e-6 * ns:.2f}" for ns in np.median(loads, axis=0)),
            )
        )
    table = Table(*head, title="One doStep of one micro step")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    RESULT.write_text(
        "One evaluation of a native FMU 2.0, with linear creep: inputs set, a micro step, outputs "
        "read; beside it the equations that this needs, called one after the other in a C loop "
        "with the same inputs, which change from step to step; smallest times of all rounds, and "
        "the median of the ratios in a round. `empty calls`: the same three calls of an FMU that "
        "keeps numbers by their value references and has no equations; `of both`: the evaluation "
        "over equations and empty calls. Then doStep over one micro step: "
        "smallest time of the generated step function alone, and medians of ratios in a round. "
        "`with exchange`: FMI 3.0 over 2.0 with all inputs set and the scalar outputs read in "
        "each step. `parameter set`: FMI 2.0 with a tunable parameter set before each step, to "
        "what it is, over without. `load`: median time from the unpacked FMU to an initialized "
        f"instance, the library opened included. {os.cpu_count()} processors "
        f"{platform.machine()}, load {os.getloadavg()[0]:.1f}.\n\n" + "\n".join(lines) + "\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
