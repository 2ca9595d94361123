"""The compiled FMU and its Python twin are the same function."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus import BLOCKS
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin
from support.excitation import STEP, scaled_inputs


@pytest.mark.parametrize("seed", range(5))
def test_fmu_and_python_agree_over_random_states(instantiate2, block_name, seed):
    block = BLOCKS[block_name]()
    values = parameter_set("loaded").values(block)
    instance = instantiate2(block_name)
    twin = Twin(block, values)
    rng = np.random.default_rng(seed)
    for name, value in scaled_inputs(instance, rng).items():
        instance.set({name: value})
        twin.set(name, value)
    instance.initialize()
    twin.initialize()
    for k in range(40):
        inputs = scaled_inputs(instance, rng)
        rates = {
            name: (scaled_inputs(instance, rng)[name] - v) / STEP for name, v in inputs.items()
        }
        if "speed" in rates:
            rates["speed"] = 1.0
        instance.set(inputs)
        instance.slave.setRealInputDerivatives(
            instance.vr(*rates), [1] * len(rates), list(rates.values())
        )
        for name in inputs:
            twin.set(name, inputs[name])
            twin.set_rate(name, rates[name])
        instance.slave.doStep(k * STEP, STEP)
        twin.step(STEP)
        ours, theirs = np.array(instance.outputs()), twin.outputs()
        scale = np.maximum(np.abs(theirs), np.abs(theirs).max() * 1e-9)
        assert np.all(np.abs(ours - theirs) <= tolerances.PARITY * np.maximum(scale, 1e-9))
    direction = scaled_inputs(instance, rng)
    exact = instance.slave.getDirectionalDerivative(
        instance.vr(*instance.names("output")), instance.vr(*direction), list(direction.values())
    )
    expected = twin.directional(direction)[: len(block.outputs)]
    assert np.allclose(
        exact, expected, rtol=tolerances.PARITY, atol=tolerances.PARITY * np.abs(expected).max()
    )


def test_what_is_kept_for_a_step_size_follows_sizes_parameters_and_rollbacks(instantiate):
    """The carbody's transitions, against the twin, which keeps nothing."""
    fmu, block = instantiate("carbody").initialize(), BLOCKS["carbody"]()
    values = parameter_set("loaded").values(block)
    tuned = {"modal_damping": 0.3, "torsion_frequency": 7.0}
    twin = Twin(block, values, {"front.force_y": 1e4})
    twin.initialize()
    fmu.set({"front.force_y": 1e4})
    time = 0.0
    for k in range(12):
        size = 2e-3 if k % 3 else 1e-3
        if k == 4:
            fmu.set(tuned)
            twin.set_parameters({**values, **tuned})
        if k == 8:
            state = fmu.slave.getFMUState()
            fmu.set({"modal_damping": 0.9})
            fmu.slave.doStep(time, size)
            fmu.slave.setFMUState(state)
        fmu.slave.doStep(time, size)
        twin.step(size)
        time += size
        theirs = twin.outputs()
        assert np.abs(np.array(fmu.outputs()) - theirs).max() <= 1e-13 * np.abs(theirs).max()
