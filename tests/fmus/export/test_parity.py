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
