"""What one evaluation of a wheelset costs, by creep law: coned, on profiles, and plain C beside it.

    python benchmarks/wheelset.py

Each round times the generated outputs and the plain C version, one after the other on the same
inputs. Figures are the smallest times, and the median of the ratios within a round. The plain one
has the table and the law alone; the block also finds the free rotation, and has the flange and all
outputs.
"""

from __future__ import annotations

import os
import platform
import subprocess
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from fmus.describe.block import Block
from fmus.describe.parameters import DEFAULT_SET, parameter_set
from fmus.export.code import sources
from fmus.export.compiler import compiler_command, host_target
from fmus.wheelrail.block import CREEP_LAWS, WheelRail
from fmus.wheelrail.creep import LAWS
from fmus.wheelrail.creep.fastsim import fastsim
from fmus.wheelrail.profiled import ProfiledWheelRail
from tracktrain.profiles.pairing import contact_table

HERE = Path(__file__).parent
RESULT = HERE / "results" / "wheelset.md"
FLAGS = ("-std=gnu11", "-O2", "-ffp-contract=off", "-g0", "-w")
COUNT = {"linear": 200_000, "polach": 50_000, "fastsim": 2_000, "fastsim 20 x 20": 1_000}
"""Evaluations in a round."""
WANTED = {"linear": 0.1, "polach": 0.4, "fastsim 20 x 20": 25.0}
"""[us]"""
SIZES = {"y": 5e-3, "yaw": 2e-3, "vy": 0.02, "wz": 0.01}


def inputs(block: Block, count: int) -> np.ndarray:
    """Rows of a wheelset in a sway, loads varied by a fifth."""
    rng = np.random.default_rng(1980)
    rows = np.array([[v.start for v in block.inputs]] * count)
    place = {v.name: i for i, v in enumerate(block.inputs)}
    phase = np.linspace(0, 2 * np.pi * 20, count)
    for n, (name, size) in enumerate(SIZES.items()):
        rows[:, place[name]] = size * np.sin(phase + n)
    for side in ("left", "right"):
        rows[:, place[f"load_{side}"]] *= rng.uniform(0.8, 1.2, count)
    return rows


def rounds_of(block: Block, law: str) -> np.ndarray:
    """Nanoseconds of one evaluation (round, 2): generated, plain."""
    number = 1 + CREEP_LAWS.index(law.partition(" ")[0])
    values = {**parameter_set(DEFAULT_SET).values(block), "creep_law": float(number)}
    count = COUNT[law]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, text in sources(block, values, "2.0", "").items():
            (folder / name).write_text(text)
        for name in ("host.c", "plain.h"):
            (folder / name).write_text((HERE / "wheelset" / name).read_text())
        data = np.concatenate([block.parameter_vector(values), inputs(block, count).ravel()])
        (folder / "data").write_bytes(data.tobytes())
        program = folder / "host"
        command = [*compiler_command(host_target()), *FLAGS, "host.c", "-o", str(program), "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        run = [str(program), str(folder / "data"), str(count), str(number)]
        done = subprocess.run(run, capture_output=True, text=True, check=True)
    return np.array([line.split() for line in done.stdout.splitlines()], float)


def main() -> None:
    table = contact_table("worn", "crown")
    poisson = parameter_set(DEFAULT_SET).entry("poisson_ratio", "wheelrail").to("1")  # type: ignore[union-attr]
    shown = Table(title="One evaluation of a wheelset [us]")
    heads = ("law", "coned", "on profiles", "plain C", "profiles / plain", "wanted, at most")
    for head in heads:
        shown.add_column(head, justify="right")
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for law in COUNT:
        own = LAWS["fastsim"]
        if "20 x 20" in law:
            LAWS["fastsim"] = partial(fastsim, strips=20, points=20)
        coned = rounds_of(WheelRail(), law)
        profiled = rounds_of(ProfiledWheelRail(table, poisson, "profiled"), law)
        LAWS["fastsim"] = own
        best = [1e-3 * t for t in (coned[:, 0].min(), *profiled.min(axis=0))]
        ratio = float(np.median(profiled[:, 0] / profiled[:, 1]))
        row = [law, *(f"{t:.3g}" for t in best), f"{ratio:.2f}", f"{WANTED.get(law, '')}"]
        shown.add_row(*row)
        lines.append(f"| {' | '.join(row)} |")
    Console().print(shown)
    load = os.getloadavg()[0]
    said = " ".join(line for line in (__doc__ or "").splitlines()[3:] if line)
    machine = f"{os.cpu_count()} processors {platform.machine()}, load {load:.1f}."
    RESULT.write_text(
        f"One evaluation of a wheelset [us]. {said} {machine}\n\n" + "\n".join(lines) + "\n"
    )


if __name__ == "__main__":
    main()
