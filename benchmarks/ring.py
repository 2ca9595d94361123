"""A ring of eight FMUs: our Jacobi against the least that any master does, in plain C.

    python benchmarks/ring.py [rounds]

8 instances of one block, in FMI 2.0 and in FMI 3.0, 48 connections, 8000 macro steps of 1 ms, 64
outputs recorded. In each round both run once in a fresh process, in turn; every result is compared
to the last bit.
"""

from __future__ import annotations

import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import fmpy
import numpy as np
from rich.console import Console
from rich.table import Table

from orchestrator import Component, Connection, System, simulate

HERE = Path(__file__).parent
BLOCKS, STEPS, STEP = 8, 8000, 1e-3
INPUTS = ("left_x", "left_vx", "left_y", "right_x", "right_vx", "right_y")
OUTPUTS = ("x", "vx", "y", "vy", "angle", "spin", "energy", "ground_force")
PARAMETERS = {
    "mass": 1000.0,
    "inertia": 400.0,
    "stiffness": 4e5,
    "damping": 2e3,
    "ground_stiffness": 8e4,
    "ground_damping": 1e3,
    "start_x": 0.0,
    "start_y": 0.0,
}
FLAGS = ("-O2", "-ffp-contract=off", "-fPIC", "-Wall", "-Wextra")
OTHERS = {
    "ecos, recording nothing": 3.8,
    "libcosim, 64 in memory": 8.6,
    "FMPy, own loop": 13.0,
    "OMSimulator, recording nothing": 18.0,
    "PyFMI, 64 in memory": 38.0,
}
"""Ratios of other masters to a C floor on such a ring, measured once on another day."""


PROMISED = {2: 1.15, 3: 1.15}
"""Our largest ratio by version of FMI."""


def values(block: int) -> dict[str, float]:
    """Masses and starts that differ, so that every block moves differently."""
    side = 1.0 if block % 2 else -0.5
    return {
        "mass": 1000.0 + 40.0 * block,
        "start_x": 0.01 * (block - 3.5) * side,
        "start_y": 0.004 * (block % 3),
    }


def description(version: int) -> str:
    names = (*INPUTS, *OUTPUTS, *PARAMETERS)
    variables = []
    for reference, name in enumerate(names):
        start = PARAMETERS.get(name, 0.0)
        if name in INPUTS:
            kind, value = 'causality="input"', f'start="{start!r}"'
        elif name in OUTPUTS:
            kind, value = 'causality="output"', ""
        else:
            kind, value = 'causality="parameter" variability="fixed"', f'start="{start!r}"'
        known = f'name="{name}" valueReference="{reference}" {kind}'
        variables.append(
            f"<ScalarVariable {known}><Real {value}/></ScalarVariable>"
            if version == 2
            else f"<Float64 {known} {value}/>"
        )
    if version == 2:
        unknowns = "".join(
            f'<Unknown index="{names.index(n) + 1}" dependencies=""/>' for n in OUTPUTS
        )
        head, structure = 'fmiVersion="2.0" guid="ring"', f"<Outputs>{unknowns}</Outputs>"
    else:
        variables.append(
            f'<Float64 name="time" valueReference="{len(names)}" causality="independent"/>'
        )
        structure = "".join(
            f'<Output valueReference="{names.index(n)}" dependencies=""/>' for n in OUTPUTS
        )
        head = 'fmiVersion="3.0" instantiationToken="ring"'
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        f'<fmiModelDescription {head} modelName="Block">'
        '<CoSimulation modelIdentifier="block" canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )


def compiler() -> list[str]:
    return ["cc"] if shutil.which("cc") else [sys.executable, "-m", "ziglang", "cc"]


def build(folder: Path, version: int) -> None:
    """The block's FMU and library, and the floor, by one compiler with the same flags."""
    library = folder / f"block{fmpy.sharedLibraryExtension}"
    compile_ = [*compiler(), *FLAGS, *(["-DFMI3"] if version == 3 else [])]
    subprocess.run([*compile_, "-shared", HERE / "ring/block.c", "-o", library], check=True)
    subprocess.run([*compile_, HERE / "ring/floor.c", "-o", folder / "floor", "-ldl"], check=True)
    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(folder / "block.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", description(version))
        archive.write(library, f"binaries/{platform}/{library.name}")


def ring(fmu: Path, blocks: int = BLOCKS) -> System:
    connections = [
        Connection(f"block_{(i + way) % blocks}.{name}", f"block_{i}.{side}_{name}")
        for i in range(blocks)
        for side, way in (("left", -1), ("right", 1))
        for name in ("x", "vx", "y")
    ]
    components = {f"block_{i}": Component(fmu, values(i % BLOCKS)) for i in range(blocks)}
    return System(components, tuple(connections))


def ours(folder: Path) -> None:
    """One run in this process; prints what it took, and keeps the record."""
    run = simulate(ring(folder / "block.fmu"), duration=STEPS * STEP, step=STEP, master="jacobi")
    run.record.astype("<f8").tofile(folder / "ours.bin")
    print(json.dumps([run.statistics.wall_stepping, run.statistics.wall_load]))


def measure(folder: Path, rounds: int) -> tuple[list[float], list[float]]:
    """Seconds that the floor and our master took in each round."""
    starts = "\n".join(" ".join(map(repr, values(i).values())) for i in range(BLOCKS))
    library = folder / f"block{fmpy.sharedLibraryExtension}"
    floor_command = [folder / "floor", library, str(STEPS), repr(STEP), folder / "floor.bin"]
    our_command = [sys.executable, __file__, "--ours", str(folder)]
    floor_spent, our_spent = [], []
    for _ in range(rounds):
        done = subprocess.run(
            floor_command, input=starts, capture_output=True, text=True, check=True
        )
        floor_spent.append(float(done.stdout))
        done = subprocess.run(our_command, capture_output=True, text=True, check=True)
        our_spent.append(json.loads(done.stdout)[0])
        floor_record, our_record = (
            np.fromfile(folder / f"{n}.bin", "<f8") for n in ("floor", "ours")
        )
        if floor_record.tobytes() != our_record.tobytes():
            raise SystemExit("the two records differ")
    return floor_spent, our_spent


def compare(version: int, rounds: int) -> tuple[list[tuple[str, ...]], list[float]]:
    """Rows of the table for a version of FMI, and our ratio to the floor in each round."""
    with tempfile.TemporaryDirectory() as name:
        build(Path(name), version)
        measure(Path(name), 1)  # compiles the macro loop
        floor_spent, our_spent = measure(Path(name), rounds)
    ratios = [b / a for a, b in zip(floor_spent, our_spent, strict=True)]
    step = [1e6 * statistics.median(spent) / STEPS for spent in (floor_spent, our_spent)]
    shown = f"FMI {version}.0, 64 outputs recorded"
    rows = [
        (f"C floor, {shown}", f"{step[0]:.2f}", "1"),
        (f"tracktrain, Jacobi, {shown}", f"{step[1]:.2f}", f"{statistics.median(ratios):.2f}"),
    ]
    return rows, ratios


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 15
    ratios: dict[int, list[float]] = {}
    rows: list[tuple[str, ...]] = []
    for version in (2, 3):
        found, ratios[version] = compare(version, rounds)
        rows += found
    rows += [(label, "", f"{value:g}") for label, value in OTHERS.items()]
    table = Table("master", "us per macro step", "ratio to the floor")
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    spread = " and ".join(
        f"{min(found):.2f} and {max(found):.2f} in FMI {version}.0"
        for version, found in ratios.items()
    )
    lines = [
        f"Ring of {BLOCKS} FMUs, 48 connections, {STEPS} steps of 1 ms; median of {rounds} rounds, "
        f"each in a fresh process, the floor first; our ratio between {spread}. All records are "
        "equal to the last bit. The other masters' ratios were measured on a ring of the same "
        "shape, against a floor of their own run.",
        "",
        "| master | us per macro step | ratio to the floor |",
        "|---|---|---|",
        *(f"| {' | '.join(row)} |" for row in rows),
    ]
    path = HERE / "results" / "ring.md"
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(lines) + "\n")
    for version, found in ratios.items():
        if (ratio := statistics.median(found)) > PROMISED[version]:
            raise SystemExit(
                f"our ratio is {ratio:.2f} in FMI {version}.0; at most {PROMISED[version]} was "
                "promised"
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--ours"]:
        ours(Path(sys.argv[2]))
    else:
        main()
