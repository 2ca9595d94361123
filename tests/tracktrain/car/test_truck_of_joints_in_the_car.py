"""The truck of joints in the car: swapped in by name, judged, and its limit as joints stiffen."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from fmus.truck_joints.reduction import RIGID, analog
from orchestrator import Run, simulate
from tracktrain.car.changes import swapped
from tracktrain.car.hopper import hopper_car, parameters_of
from tracktrain.cli.main import main

pytestmark = pytest.mark.slow  # its FMU is built first

TRUCKS = ("truck_front", "truck_rear")
OUTPUTS = ("truck_front.q[4]", "truck_front.axle[1].y", "truck_rear.axle[2].yaw", "carbody.front.y")


def car_of_joints(values) -> Run:
    """The hopper car on the report's track with trucks of joints that have these values."""
    car = hopper_car("report-linear", "80 ft/s", "report")
    for truck in TRUCKS:
        car, _ = swapped(car, truck, fmu_path("truck_joints"))
        for name, value in values.items():
            car = car.with_value(f"{truck}.{name}", value)
    return simulate(car, duration=2.0, step=1e-3)


def test_the_car_of_stiff_joints_is_the_car_of_six_coordinates():
    """First order in the joints' compliance, with the trucks' analog in the other car."""
    own = analog(parameters_of("report-linear")["truck_joints"])
    six = hopper_car("report-linear", "80 ft/s", "report")
    for truck in TRUCKS:
        for name, given in own.items():
            for kind, value in given.items():
                six = six.with_value(f"{truck}.{name}.{kind}", value)
    expected = simulate(six, duration=2.0, step=1e-3)
    none = ("stop_stiffness", "friction_stiffness", "friction_limit")
    errors = []
    for stiffness in (1e9, 4e9, 1.6e10):
        values = {f"{name}.{kind}": 0.0 for name in RIGID for kind in none}
        run = car_of_joints(values | {f"{name}.stiffness": stiffness for name in RIGID})
        errors.append(
            max(
                float(np.abs(run.dataset[name] - expected.dataset[name]).max())
                / float(np.abs(expected.dataset[name]).max())
                for name in OUTPUTS
            )
        )
    orders = [np.log(a / b) / np.log(4) for a, b in pairwise(errors)]
    assert errors[-1] < 2e-3
    assert orders == pytest.approx([1.0, 1.0], abs=0.15)


def test_the_car_with_the_shipped_joints_runs_and_is_trusted():
    run = car_of_joints({})
    assert run.completed
    assert run.verdict.level.value == "good", run.verdict
    assert float(np.abs(run.dataset["truck_front.joint_force[11]"]).max()) > 0.0


def test_it_is_swapped_in_and_built_by_its_name(tmp_path):
    for line in (
        f"build truck_joints --fmi 2.0 --out {tmp_path}",
        f"run --swap truck_front=truck_joints --duration 0.01s --out {tmp_path / 'run'}",
        f"fmu check {tmp_path / 'truck_joints.fmu'} --as truck",
        f"fmu test {tmp_path / 'truck_joints.fmu'}",
    ):
        result = CliRunner().invoke(main, line.split())
        assert result.exit_code == 0, result.output
    assert [path.name for path in tmp_path.glob("*.fmu")] == ["truck_joints.fmu"]
