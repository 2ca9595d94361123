"""How the FMUs behave under the calls of the standard, and the messages of refused calls."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from support.excitation import STEP, advance, scaled_inputs
from support.fmi3_instance import INSTANCE


def test_the_same_calls_give_the_same_results(instantiate, block_name):
    a, b = (instantiate(block_name, n).initialize() for n in "ab")
    ra, rb = np.random.default_rng(1), np.random.default_rng(1)
    assert np.array_equal(advance(a, 50, ra), advance(b, 50, rb))


def test_saved_state_is_restored_to_the_last_bit(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    advance(instance, 20, np.random.default_rng(2))
    state = instance.slave.getFMUstate()
    first = advance(instance, 30, np.random.default_rng(3), 20)
    instance.slave.setFMUstate(state)
    assert np.array_equal(first, advance(instance, 30, np.random.default_rng(3), 20))
    instance.slave.freeFMUstate(state)


def test_serialized_state_continues_in_another_instance(instantiate, block_name):
    one, other = (instantiate(block_name, n).initialize() for n in "ab")
    advance(one, 20, np.random.default_rng(2))
    state = one.slave.getFMUstate()
    data = one.slave.serializeFMUstate(state)
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    expected = advance(one, 30, np.random.default_rng(3), 20)
    assert np.array_equal(expected, advance(other, 30, np.random.default_rng(3), 20))


def test_foreign_bytes_are_no_state(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    data = bytearray(instance.slave.serializeFMUstate(instance.slave.getFMUstate()))
    data[3] ^= 0xFF
    with pytest.raises(FMICallException):
        instance.slave.deSerializeFMUstate(bytes(data))
    assert "no state of this FMU" in instance.messages[-1]


def test_reset_brings_back_the_start(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    first = advance(instance, 20, np.random.default_rng(2))
    instance.slave.reset()
    instance.initialize()
    assert np.array_equal(first, advance(instance, 20, np.random.default_rng(2)))


def test_directional_derivatives_agree_with_differences(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    rng = np.random.default_rng(5)
    advance(instance, 20, rng)
    base = scaled_inputs(instance, rng)
    outputs, inputs = instance.names("output"), instance.names("input")
    for name in inputs:
        nudge = 1e-6 * max(abs(base[name]), 1e-3)
        low, high = (
            np.array(instance.set({**base, name: base[name] + s * nudge}) or instance.outputs())
            for s in (-1, 1)
        )
        instance.set(base)
        exact = np.array(
            instance.slave.getDirectionalDerivative(instance.vr(*outputs), instance.vr(name), [1.0])
        )
        difference = (high - low) / (2 * nudge)
        scale = np.abs(exact).max() + np.abs(np.array(instance.outputs())).max() * 1e-9 / nudge
        assert np.abs(exact - difference).max() <= 1e-5 * scale + 1e-12, name


def test_outputs_move_only_with_the_inputs_they_declare(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    rng = np.random.default_rng(7)
    advance(instance, 20, rng)
    base = scaled_inputs(instance, rng)
    outputs = instance.names("output")
    declared = instance.declared()
    instance.set(base)
    before = np.array(instance.outputs())
    for name in instance.names("input"):
        instance.set({**base, name: base[name] * 1.3 + 1e-4})
        moved = {
            o for o, same in zip(outputs, instance.outputs() == before, strict=True) if not same
        }
        assert moved <= {o for o in outputs if name in declared[o]}, name


def test_inputs_may_vary_linearly_over_a_step(instantiate):
    """A force that grows linearly moves the free carbody by its double integral, exactly."""
    carbody = instantiate("carbody").initialize()
    mass = carbody.get("body_mass")[0]
    rate, time = 1e6, 0.25
    vr = carbody.vr("front.force_z")
    carbody.slave.setRealInputDerivatives(vr, [1], [rate / 2])
    carbody.slave.setRealInputDerivatives(carbody.vr("rear.force_z"), [1], [rate / 2])
    carbody.slave.doStep(0.0, time)
    velocity = carbody.get("qd[2]")[0] / math.sqrt(mass)  # the vertical mode has unit modal mass
    assert velocity == pytest.approx(rate * time**2 / (2 * mass), rel=1e-12)
    assert carbody.get("front.force_z")[0] == pytest.approx(rate / 2 * time, rel=1e-14)


def test_a_rate_lasts_for_one_step(instantiate):
    carbody = instantiate("carbody").initialize()
    carbody.slave.setRealInputDerivatives(carbody.vr("front.force_z"), [1], [1e6])
    carbody.slave.doStep(0.0, 0.1)
    carbody.slave.doStep(0.1, 0.1)
    assert carbody.get("front.force_z")[0] == pytest.approx(1e5, rel=1e-14)


def test_a_step_of_zero_length_changes_nothing(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    advance(instance, 5, np.random.default_rng(2))
    before = instance.outputs()
    instance.slave.doStep(5 * STEP, 0.0)
    assert instance.outputs() == before


def test_a_state_that_becomes_infinite_is_named_with_the_time(instantiate):
    truck = instantiate("truck").initialize()
    truck.set({"axle[1].force_y": 1e308, "axle[2].force_y": 1e308})
    with pytest.raises(FMICallException):
        for k in range(1000):
            truck.slave.doStep(k * STEP, STEP)
    assert "is no longer finite after the step from t = " in truck.messages[-1]
    assert truck.messages[-1].startswith(("q[", "qd[", "slip["))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_input_that_is_not_finite_is_refused(instantiate, block_name, value):
    instance = instantiate(block_name).initialize()
    name = instance.names("input")[0]
    with pytest.raises(FMICallException):
        instance.set({name: value})
    assert name in instance.messages[-1] and "finite number is needed" in instance.messages[-1]


def test_a_negative_mass_is_refused_with_its_range(instantiate):
    truck = instantiate("truck", "truck_front")
    with pytest.raises(FMICallException):
        truck.set({"wheelset_mass": -3.0})
    assert truck.messages[-1] == "wheelset_mass cannot be -3 kg: it must be at least 1 kg"


def test_a_fixed_parameter_cannot_change_during_a_run(instantiate):
    truck = instantiate("truck").initialize()
    with pytest.raises(FMICallException):
        truck.set({"wheelset_mass": 1000.0})
    assert "wheelset_mass is a fixed parameter" in truck.messages[-1]


def test_an_output_cannot_be_set(instantiate, block_name):
    instance = instantiate(block_name).initialize()
    name = instance.names("output")[0]
    with pytest.raises(FMICallException):
        instance.set({name: 1.0})
    assert f"{name} is an output and cannot be set" in instance.messages[-1]


def test_unknown_value_references_are_refused(instantiate, block_name):
    slave = (instance := instantiate(block_name).initialize()).slave
    for call in (
        lambda: slave.getReal([100000]),
        lambda: slave.setReal([100000], [0.0]),
        lambda: slave.getDirectionalDerivative(
            [100000], instance.vr(instance.names("input")[0]), [1.0]
        ),
        lambda: slave.setRealInputDerivatives([100000], [1], [0.0]),
    ):
        with pytest.raises(FMICallException):
            call()
        assert "100000" in instance.messages[-1]


def test_a_real_parameter_is_not_set_as_an_integer(instantiate):
    track = instantiate("track")
    with pytest.raises(FMICallException):
        track.slave.setReal(track.vr("seed"), [1.0])
    assert "seed is of type integer and cannot be set as real" in track.messages[-1]


def test_an_enumeration_takes_its_items_only(instantiate):
    track = instantiate("track")
    with pytest.raises(FMICallException):
        track.slave.setInteger(track.vr("spectrum"), [99])
    assert "spectrum cannot be 99: it must be at least 1 and at most" in track.messages[-1]


def test_calls_out_of_order_are_refused(instantiate, block_name):
    instance = instantiate(block_name)
    slave = instance.slave
    with pytest.raises(FMICallException):
        slave.doStep(0.0, STEP)
    assert "finished initialization" in instance.messages[-1]
    with pytest.raises(FMICallException):
        slave.exitInitializationMode()
    with pytest.raises(FMICallException):
        slave.terminate()
    instance.initialize()
    with pytest.raises(FMICallException):
        slave.enterInitializationMode()
    with pytest.raises(FMICallException):
        slave.doStep(0.0, -STEP)
    assert "not negative" in instance.messages[-1]
    slave.terminate()


def test_a_guid_of_another_build_is_refused(block_name, fmi):
    with pytest.raises(Exception, match="instantiate"):
        INSTANCE[fmi](fmu_path(block_name, fmi), guid="{wrong}")


def test_a_higher_input_derivative_is_refused(instantiate2):
    carbody = instantiate2("carbody").initialize()
    with pytest.raises(FMICallException):
        carbody.slave.setRealInputDerivatives(carbody.vr("front.force_z"), [2], [1.0])
    assert "order 1" in carbody.messages[-1]


def test_blocks_are_those_of_the_catalogue():
    from fmus.names import NAMES

    assert tuple(BLOCKS) == NAMES
