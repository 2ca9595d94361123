"""The car of FMI 3.0 FMUs, and of both versions, moves as that of FMI 2.0."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import tolerances

from fmus.catalogue import fmu_path
from orchestrator import simulate
from orchestrator.results import Run
from tracktrain.hopper import BLOCK_OF, hopper_car

INSTANCES = tuple(BLOCK_OF)


def run_of(*in_fmi3: str, master: str = "one-pass") -> Run:
    car = hopper_car(track="fra4")
    components = {
        name: replace(component, fmu=fmu_path(BLOCK_OF[name], "3.0" if name in in_fmi3 else "2.0"))
        for name, component in car.components.items()
    }
    run = simulate(replace(car, components=components), duration=1.0, step=1e-3, master=master)
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
