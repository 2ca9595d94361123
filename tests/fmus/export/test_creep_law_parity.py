"""Each creep law's branch in the compiled FMU is the Python twin's."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import tolerances
from fmus import BLOCKS
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin
from fmus.wheelrail.block import CREEP_LAWS
from support.excitation import scaled_inputs


@pytest.mark.parametrize("law", CREEP_LAWS)
def test_fmu_and_python_agree_under_each_creep_law(instantiate, law):
    number = 1 + CREEP_LAWS.index(law)
    block = BLOCKS["wheelrail"]()
    twin = Twin(block, parameter_set("loaded").values(block) | {"creep_law": number})
    twin.initialize()
    instance = instantiate("wheelrail")
    instance.slave.setInteger(instance.vr("creep_law"), [number])
    instance.initialize()
    rng = np.random.default_rng(number)
    outputs = instance.vr(*instance.names("output"))
    for _ in range(20):
        inputs = scaled_inputs(instance, rng)
        instance.set(inputs)
        for name, value in inputs.items():
            twin.set(name, value)
        theirs = twin.outputs()
        error = np.abs(np.array(instance.outputs()) - theirs)
        assert error.max() <= tolerances.PARITY * np.abs(theirs).max()
        direction = scaled_inputs(instance, rng)
        exact = instance.slave.getDirectionalDerivative(
            outputs, instance.vr(*direction), list(direction.values())
        )
        expected = twin.directional(direction)
        error = np.abs(np.array(exact) - expected)
        assert error.max() <= tolerances.PARITY * np.abs(expected).max()
        led = instance.slave.getDirectionalDerivative(  # from the slopes of these alone
            outputs[: len(block.led)], instance.vr(*direction), list(direction.values())
        )
        error = np.abs(np.array(led) - expected[: len(block.led)])
        assert error.max() <= tolerances.PARITY * np.abs(expected).max()


def test_a_tread_hollower_than_the_crown_is_refused(instantiate):
    instance = instantiate("wheelrail")
    crown = parameter_set("loaded").values(BLOCKS["wheelrail"]())["rail_transverse_radius"]
    with pytest.raises(FMICallException):
        instance.initialize({"wheel_transverse_curvature": -1.1 / crown}).outputs()
    assert "no finite model; check for zero or contradicting" in instance.messages[-1]
