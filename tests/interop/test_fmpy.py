"""Each FMU alone in FMPy's own simulation, next to our orchestrator and the Python twin."""

from __future__ import annotations

import csv
import subprocess
import sys

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu

import tolerances
from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.parameters import DEFAULT_SET, parameter_set
from fmus.describe.twin import Twin
from fmus.names import FMI_VERSIONS
from orchestrator import Component, System, simulate
from support.engines import STEP, STEPS

LEVEL = {"m": 2e-3, "rad": 1e-3, "m/s": 0.05, "rad/s": 0.02, "N": 1e4, "N.m": 5e3}


class Ramps:
    """Inputs that grow linearly from plausible levels, each at its own rate."""

    def __init__(self, block: str) -> None:
        description = read_model_description(str(fmu_path(block)))
        inputs = [v for v in description.modelVariables if v.causality == "input"]
        self.names = [v.name for v in inputs]
        self.outputs = [v.name for v in description.modelVariables if v.causality == "output"]
        start = np.array([float(v.start or 0.0) for v in inputs])
        level = np.array([LEVEL.get(v.unit, 0.0) for v in inputs])
        self.level = start + level * np.cos(np.arange(len(inputs)))
        self.rate = level * np.sin(np.arange(len(inputs)))

    def at(self, time: float) -> np.ndarray:
        return self.level + self.rate * time

    def table(self) -> np.ndarray:
        """FMPy's structured array; its rates begin at the second row, so the first is early."""
        times = np.arange(-1, STEPS + 1) * STEP
        columns = [("time", float), *((name, float) for name in self.names)]
        return np.array([(t, *self.at(t)) for t in times], dtype=columns)


def fmpy_run(block: str, outputs: list[str], **settings: object) -> np.ndarray:
    """Outputs [step, output] by FMPy, from the start on."""
    result = simulate_fmu(
        str(fmu_path(block)),
        stop_time=STEPS * STEP,
        output_interval=STEP,
        output=outputs,
        fmi_type="CoSimulation",
        **settings,
    )
    assert len(result) == STEPS + 1
    return np.array([result[name] for name in outputs]).T


def test_constant_inputs_give_what_our_orchestrator_gives_to_the_last_bit(block_name):
    ramps = Ramps(block_name)
    held = dict(zip(ramps.names, ramps.level, strict=True))
    theirs = fmpy_run(block_name, ramps.outputs, start_values=held)
    alone = System({"alone": Component(fmu_path(block_name), held)}, ())
    ours = simulate(alone, duration=STEPS * STEP, step=STEP, master="jacobi")
    assert ours.completed, ours.message
    for name, values in zip(ramps.outputs, theirs.T, strict=True):
        assert np.array_equal(ours.dataset[f"alone.{name}"], values), name


def test_inputs_that_vary_give_what_the_python_twin_gives(block_name):
    ramps = Ramps(block_name)
    table = ramps.table()
    theirs = fmpy_run(block_name, ramps.outputs, input=table)
    block = BLOCKS[block_name]()
    twin = Twin(block, parameter_set(DEFAULT_SET).values(block))

    def give(time: float) -> None:
        for name, value in zip(ramps.names, ramps.at(time), strict=True):
            twin.set(name, value)

    give(0.0)
    twin.initialize()
    ours = [twin.outputs()]
    for k in range(STEPS):
        give(k * STEP)
        twin.step(STEP)
        ours.append(twin.outputs())
    scale = np.maximum(np.abs(theirs), 1e-9 * np.abs(theirs).max())
    assert (np.abs(np.array(ours) - theirs) <= tolerances.PARITY * scale).all()


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_the_command_line_simulates_each_interface(block_name, fmi, tmp_path):
    """As its users type it, with inputs at their start values."""
    for interface in ("CoSimulation", "ModelExchange"):
        file = tmp_path / f"{interface}.csv"
        options = ("--validate", "--interface-type", interface, "--stop-time", "0.2")
        command = [sys.executable, "-m", "fmpy", *options, "--output-file", file]
        subprocess.run([*command, "simulate", fmu_path(block_name, fmi)], check=True)
        with file.open() as lines:
            header, *rows = csv.reader(lines)
        values = np.array([" ".join(row).split() for row in rows], float)  # arrays have a cell
        assert len(values) > 100 and np.isfinite(values).all()
        if block_name == "track":
            time, distance = (np.array([float(row[n]) for row in rows]) for n in (0, 1))
            assert header[:2] == ["time", "distance"]
            assert distance == pytest.approx(18.288 * time, rel=tolerances.EXCHANGE, abs=1e-12)
