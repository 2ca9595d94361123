"""The car of FMI 3.0 FMUs, and of both versions, moves as that of FMI 2.0."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tolerances
from fmus.catalogue import fmu_path
from fmus.export.python.flavor import build_python
from orchestrator import Port, PortMap, resume, simulate
from orchestrator.results.run import Run
from tracktrain.car.changes import swapped
from tracktrain.car.hopper import HOPPER, hopper_car

INSTANCES = tuple(HOPPER.blocks)


def run_of(*in_fmi3: str, master: str = "one-pass", **options: Any) -> Run:
    car = hopper_car(speed="60 ft/s", track="fra4")
    components = {
        name: replace(
            component, fmu=fmu_path(HOPPER.blocks[name], "3.0" if name in in_fmi3 else "2.0")
        )
        for name, component in car.components.items()
    }
    car = replace(car, components=components)
    run = simulate(car, **{"duration": 1.0, "step": 1e-3, **options}, master=master)
    assert run.completed, run.message
    return run


def inputs_led(run: Run) -> list[str]:
    return [note for note in run.notes if " inputs " in note]


@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
def test_car_of_either_version_or_both_is_the_same(master: str) -> None:
    reference = run_of(master=master)
    for names in (INSTANCES, INSTANCES[::2]):
        run = run_of(*names, master=master)
        assert inputs_led(run) == inputs_led(reference)
        for name in reference.dataset:
            expected = reference.dataset[name].values
            np.testing.assert_allclose(
                run.dataset[name],
                expected,
                atol=tolerances.VERSIONS_OF_FMI * np.abs(expected).max(),
                rtol=0.0,
                err_msg=str(name),
            )


def test_python_wheelset_in_a_mirror_between_fmus_of_both_versions(tmp_path: Path) -> None:
    """With a truck of FMI 3.0 a Python FMU behind a map does what it does with one of FMI 2.0."""
    names = ("y", "yaw", "vy", "wz", "force_y", "moment_z")
    ports = {name: Port(name, -1.0) for name in names}
    sides = ("left", "right")
    for side, other in (sides, sides[::-1]):
        ports[f"load_{side}"] = Port(f"load_{other}")
        ports[f"rail_y_{side}"] = Port(f"rail_y_{other}", -1.0)
    wheelset = build_python("wheelrail", tmp_path)
    car, _ = swapped(hopper_car(track="fra4"), "wheelset_11", wheelset, PortMap(ports))
    runs = [
        simulate(car.with_fmu("truck_front", fmu_path("truck", version)), duration=0.1)
        for version in ("2.0", "3.0")
    ]
    assert all(run.completed for run in runs)
    forces = [run.dataset["wheelset_11.force_y"].values for run in runs]
    assert np.abs(forces[0]).max() > 1.0
    np.testing.assert_allclose(
        forces[1], forces[0], rtol=0.0, atol=tolerances.VERSIONS_OF_FMI * np.abs(forces[0]).max()
    )


def test_fmi3_car_goes_on_from_a_checkpoint_to_the_same_bits(tmp_path: Path) -> None:
    """With what its adaptors remember, too: the last positions of a differentiated velocity."""
    car = hopper_car(speed="60 ft/s", track="fra4")
    components = {
        name: replace(component, fmu=fmu_path(HOPPER.blocks[name], "3.0"))
        for name, component in car.components.items()
    }
    components["carbody"] = replace(
        components["carbody"], ports=PortMap({}, {"front.differentiated": "front.y"})
    )
    system = replace(car, components=components)

    def stop(time: float, wall: float) -> None:
        if time > 0.15:
            raise KeyboardInterrupt

    whole = simulate(system, duration=0.3, step=1e-3)
    options = {"duration": 0.3, "step": 1e-3, "checkpoint": 0.05, "out": tmp_path}
    assert not simulate(system, progress=stop, **options).completed
    resumed = resume(tmp_path)
    assert resumed.completed
    assert np.array_equal(np.asarray(resumed.record, float), whole.record)
    velocity = whole.dataset["carbody.front.vy"]
    error = np.abs(whole.dataset["carbody.front.differentiated"] - velocity)[2:]
    assert error.max() < tolerances.DIFFERENCE * np.abs(velocity).max()


def test_steps_are_repeated_through_adaptors_too() -> None:
    """Differentiated velocities forget what was undone: each run meets the one that is not."""
    car = hopper_car(speed="60 ft/s", track="fra4")
    components = {
        name: replace(
            component,
            fmu=fmu_path(HOPPER.blocks[name], "3.0"),
            ports=PortMap({}, {"front.differentiated": "front.y"}) if name == "carbody" else None,
        )
        for name, component in car.components.items()
    }
    in_fmi3 = replace(car, components=components)
    reference, run = (simulate(s, duration=0.1, master="iterated") for s in (car, in_fmi3))
    assert run.completed, run.message
    force = reference.dataset["wheelset_11.force_y"]
    error = np.abs(run.dataset["wheelset_11.force_y"] - force).max()
    assert error < tolerances.ITERATED_VERSIONS * np.abs(force).max()
    y = run.dataset["carbody.front.y"].values
    expected = (3.0 * y[2:] - 4.0 * y[1:-1] + y[:-2]) / 2e-3
    found = run.dataset["carbody.front.differentiated"].values[2:]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.skipif(os.name != "posix", reason="isolation needs Linux or macOS")
@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
def test_fmi3_fmus_in_processes_of_their_own_move_to_the_same_bits(master: str) -> None:
    alone = ("truck_front", "wheelset_11")
    here = run_of(*INSTANCES, master=master, duration=0.1)
    apart = run_of(*INSTANCES, master=master, duration=0.1, isolate=alone)
    assert here.dataset.equals(apart.dataset)
