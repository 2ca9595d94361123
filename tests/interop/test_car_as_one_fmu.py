"""The whole car as one FMU: ours in other tools, and another tool's in ours."""

from __future__ import annotations

import importlib
import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu

import tolerances
from orchestrator import Component, Execution, OnePass, Run, Settings, System, simulate
from support.archive_checks import findings
from support.engines import STEP, STEPS, run, unavailable
from support.tools import need
from tracktrain import hopper_car
from tracktrain.one_fmu import build_one_fmu

pytestmark = pytest.mark.slow

WATCHED = ("truck_front.axle[1].y", "wheelset_11.left.l_over_v")


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def one_fmu(request, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("one") / f"hopper_{request.param[0]}.fmu"
    return build_one_fmu(hopper_car(), path, fmi=request.param)[0]


@pytest.fixture(scope="module")
def apart() -> Run:
    return simulate(hopper_car(), duration=1.0, step=1e-3)


def test_fmpy_computes_with_it_what_a_run_does_to_the_last_bit(one_fmu, apart):
    assert findings(one_fmu) == []
    there = simulate_fmu(str(one_fmu), stop_time=1.0, step_size=1e-3, output_interval=1e-3)
    different = [n for n in apart.dataset if n in there.dtype.names and n != "time"]
    different = [n for n in different if not np.array_equal(there[n], apart.dataset[n])]
    assert different == []
    assert len(there.dtype.names) > 250


def test_a_run_with_it_goes_back_and_on_as_it_went(one_fmu, apart):
    system = System({"car": Component(one_fmu)})
    with Execution(system, OnePass(), Settings(duration=1.0, step=1e-3)) as execution:
        execution.step(300)
        saved = execution.save()
        execution.step(200)
        execution.restore(saved)
        while execution.step():
            pass
        done = execution.finish()
    for name in WATCHED:
        assert np.array_equal(done.dataset[f"car.{name}"], apart.dataset[name]), name


def test_ecos_computes_with_it_what_fmpy_does(one_fmu):
    lacking = unavailable("ecos")
    need(lacking is None, str(lacking))
    there = run("ecos", {"car": one_fmu}, [], [f"car.{n}" for n in WATCHED], STEP, STEPS)
    with_fmpy = simulate_fmu(
        str(one_fmu), stop_time=STEPS * STEP, step_size=STEP, output_interval=STEP
    )
    for column, name in enumerate(WATCHED):
        assert np.array_equal(there[:, column], with_fmpy[name][1:]), name


def test_pathsim_computes_with_it_what_a_run_does(one_fmu, apart):
    """PathSim steps at 0 and at the end, too; it gives inputs that nothing drives the value 0."""
    pathsim_fmi = pytest.importorskip("pathsim_fmi")
    pathsim, blocks = (importlib.import_module(n) for n in ("pathsim", "pathsim.blocks"))
    car = pathsim_fmi.CoSimulationFMU(str(one_fmu), dt=1e-3)
    speed = blocks.Constant(float(apart.dataset["track.speed_out"][0]))
    driven = pathsim.Connection(speed, car["track.speed"])
    pathsim.Simulation([speed, car], [driven], dt=1e-3, log=False).run(0.2)
    values = dict(zip(car.fmu_wrapper.output_refs, car.outputs.to_array(), strict=True))
    for name in WATCHED:
        assert values[name] == apart.dataset[name][201], name


def test_cofmpy_computes_with_it_what_a_run_does(one_fmu, apart, tmp_path):
    cofmupy = pytest.importorskip("cofmupy")
    file = tmp_path / "cosimulation.json"
    speed = {"type": "literal", "values": {"0": float(apart.dataset["track.speed_out"][0])}}
    target = {"id": "car", "variable": "track.speed", "unit": "", "type": "fmu"}
    given = {
        "fmus": [{"id": "car", "path": str(one_fmu), "name": "car"}],
        "connections": [{"source": speed, "target": target}],
        "data_storages": [],
    }
    file.write_text(json.dumps(given))
    coordinator = cofmupy.Coordinator()
    coordinator.start(str(file))
    for _ in range(200):
        coordinator.do_step(1e-3)
    for name in WATCHED:
        assert coordinator.get_variable(("car", name))[-1] == apart.dataset[name][200], name


def test_a_container_of_another_tool_runs_in_fmpy_and_in_ours_as_gauss_seidel_does(tmp_path):
    """fmucontainer couples in sequence, with held inputs; it starts as the FMUs do."""
    car = hopper_car()
    car = replace(car, components={n: Component(c.fmu) for n, c in car.components.items()})
    for name, component in car.components.items():
        shutil.copy(component.fmu, tmp_path / f"{name}.fmu")
    ports = [(*c.source.split(".", 1), *c.target.split(".", 1)) for c in car.connections]
    container = {
        "name": "whole.fmu",
        "fmu": sorted(f"{name}.fmu" for name in car.components),
        "link": [[f"{a}.fmu", output, f"{b}.fmu", port] for a, output, b, port in ports],
        "auto_output": True,
        "sequential": True,
        "step_size": 1e-3,
    }
    (tmp_path / "whole.json").write_text(json.dumps(container))
    program = Path(sys.executable).parent / "fmucontainer"
    command = [program, "-fmu-directory", tmp_path, "-container", "whole.json"]
    subprocess.run(command, check=True, capture_output=True)
    whole = tmp_path / "whole.fmu"
    there = simulate_fmu(str(whole), stop_time=1.0, step_size=1e-3, output_interval=1e-3)
    here = simulate(System({"car": Component(whole)}), duration=1.0, step=1e-3).dataset
    described = read_model_description(str(whole)).modelVariables
    outputs = [v.name for v in described if v.causality == "output"]
    assert [n for n in outputs if not np.array_equal(there[n], here[f"car.{n}"])] == []
    coupled = simulate(car, duration=1.0, step=1e-3, master="gauss-seidel").dataset
    moved = coupled["carbody.cg.y"].values
    assert np.abs(there["cg.y"] - moved).max() < tolerances.PARITY * np.abs(moved).max()
