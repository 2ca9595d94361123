"""Single sentences of the FMI standard, each as a claim about the FMUs."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from support.fmu_instance import FmuInstance

STEP = 1e-3


def refused(instance: FmuInstance, function, *arguments) -> str:
    """The message of a call that has to fail."""
    with pytest.raises(FMICallException):
        function(*arguments)
    return instance.messages[-1]


@pytest.fixture
def instance(instantiate, block_name):
    return instantiate(block_name)


@pytest.fixture
def instance2(instantiate2, block_name):
    """For what FMI 2.0 alone has, or calls by another name."""
    return instantiate2(block_name)


def run(instance: FmuInstance, steps: int = 3) -> FmuInstance:
    instance.initialize()
    for k in range(steps):
        instance.set({name: 2e-3 * (k + 1) for name in instance.names("input")})
        instance.slave.doStep(k * STEP, STEP)
    return instance


def test_freeing_no_instance_does_nothing(instance2):
    instance2.slave.dll.fmi2FreeInstance(None)


@pytest.mark.parametrize("phase", ["instantiated", "initializing", "running", "terminated"])
def test_lists_of_length_zero_may_be_null(instance2, phase):
    slave, c = instance2.slave, instance2.slave.component
    if phase != "instantiated":
        slave.enterInitializationMode()
    if phase in ("running", "terminated"):
        slave.exitInitializationMode()
    if phase == "terminated":
        slave.terminate()
    slave.fmi2GetReal(c, None, 0, None)
    slave.fmi2GetInteger(c, None, 0, None)
    slave.fmi2GetBoolean(c, None, 0, None)
    slave.fmi2GetString(c, None, 0, None)
    slave.fmi2GetRealOutputDerivatives(c, None, 0, None, None)
    slave.fmi2GetDirectionalDerivative(c, None, 0, None, 0, None, None)
    slave.fmi2SetDebugLogging(c, 0, 0, None)
    if phase != "terminated":
        slave.fmi2SetReal(c, None, 0, None)
        slave.fmi2SetInteger(c, None, 0, None)
        slave.fmi2SetBoolean(c, None, 0, None)
        slave.fmi2SetString(c, None, 0, None)
        slave.fmi2SetRealInputDerivatives(c, None, 0, None, None)


def test_a_list_that_is_not_there_is_refused(instance2):
    slave, c = instance2.slave, instance2.slave.component
    for function, arguments in (
        (slave.fmi2GetReal, (c, None, 1, None)),
        (slave.fmi2SetReal, (c, None, 1, None)),
        (slave.fmi2GetInteger, (c, None, 1, None)),
        (slave.fmi2SetBoolean, (c, None, 1, None)),
        (slave.fmi2SetRealInputDerivatives, (c, None, 1, None, None)),
        (slave.fmi2GetDirectionalDerivative, (c, None, 1, None, 0, None, None)),
        (slave.fmi2GetDirectionalDerivative, (c, None, 0, None, 1, None, None)),
    ):
        assert "it is NULL" in refused(instance2, function, *arguments)


def test_nothing_steps_past_the_stop_time(instance):
    instance.slave.setupExperiment(startTime=0.0, stopTime=2 * STEP)
    instance.slave.enterInitializationMode()
    instance.slave.exitInitializationMode()
    instance.slave.doStep(0.0, STEP)
    before = instance.slave.getRealStatus(2)
    message = refused(instance, instance.slave.doStep, STEP, 2 * STEP)
    assert "goes past the stop time of 0.002 s" in message
    assert instance.slave.getRealStatus(2) == before
    instance.slave.doStep(STEP, STEP * (1 + 1e-12))  # a master's rounding is not past it


def test_a_step_goes_on_from_where_the_instance_is(instance):
    slave = instance.initialize().slave
    slave.doStep(0.0, STEP)
    before = instance.outputs()
    for time in (0.0, STEP / 2, STEP * 1.001, 0.5, -STEP):
        message = refused(instance, slave.doStep, time, STEP)
        assert message == (
            f"doStep from t = {time:.17g} s by 0.001 s, and this instance is at "
            f"t = {STEP:.17g} s: step from there, or restore a state that was saved at the "
            "other time"
        )
        assert instance.outputs() == before
    slave.doStep(STEP * (1 + 1e-10), STEP)  # a master's rounding


def test_a_step_goes_on_from_the_time_of_a_restored_state(instance):
    slave = instance.initialize().slave
    slave.doStep(0.0, STEP)
    save, restore = (
        (slave.getFMUstate, slave.setFMUstate)
        if hasattr(slave, "getFMUstate")
        else (slave.getFMUState, slave.setFMUState)
    )
    state = save()
    slave.doStep(STEP, STEP)
    after = instance.outputs()
    restore(state)
    assert "is at t = 0.001 s" in refused(instance, slave.doStep, 2 * STEP, STEP)
    slave.doStep(STEP, STEP)
    assert instance.outputs() == after


def test_a_reset_forgets_the_stop_time(instance):
    instance.slave.setupExperiment(startTime=0.0, stopTime=STEP)
    instance.slave.reset()
    instance.initialize()
    instance.slave.doStep(0.0, 2 * STEP)


def test_a_stop_time_before_the_start_is_refused(instance2):
    message = refused(instance2, instance2.slave.setupExperiment, None, 1.0, 0.5)
    assert "stop time lies before the start time" in message


def test_a_start_time_that_is_not_finite_is_refused(instance):
    instance.slave.setupExperiment(startTime=math.nan)
    assert "must be finite" in refused(instance, instance.slave.enterInitializationMode)


def test_time_never_overflows(instance):
    instance.initialize()
    assert "must be finite" in refused(instance, instance.slave.doStep, 1.7e308, 1.7e308)


def test_nothing_is_set_after_the_end(instance2):
    run(instance2).slave.terminate()
    before = instance2.outputs()
    name = instance2.names("input")[0]
    parameter = next(
        v.name
        for v in instance2.variables.values()
        if v.causality == "parameter" and v.type == "Real"
    )
    slave = instance2.slave
    for function, *arguments in (
        (instance2.set, {name: 1.0}),
        (instance2.set, {parameter: instance2.get(parameter)[0]}),
        (slave.setInteger, [1], [1]),
        (slave.setBoolean, [1], [1]),
        (slave.setRealInputDerivatives, instance2.vr(name), [1], [1.0]),
    ):
        assert "the run has ended" in refused(instance2, function, *arguments)
    assert instance2.outputs() == before


def test_a_run_can_go_back_from_after_its_end(instance):
    run(instance)
    state, before = instance.slave.getFMUstate(), instance.outputs()
    instance.slave.terminate()
    instance.slave.setFMUstate(state)
    assert instance.outputs() == before
    instance.slave.doStep(3 * STEP, STEP)
    instance.slave.freeFMUstate(state)


@pytest.mark.parametrize(
    "phase", ["instantiated", "initializing", "running", "terminated", "failed"]
)
def test_a_reset_comes_from_anywhere(instance, instantiate, block_name, phase):
    slave = instance.slave
    if phase == "initializing":
        slave.enterInitializationMode()
    elif phase != "instantiated":
        run(instance)
    if phase == "terminated":
        slave.terminate()
    elif phase == "failed":
        refused(instance, slave.doStep, 3 * STEP, -STEP)
    slave.reset()
    assert run(instance).outputs() == run(instantiate(block_name, "fresh")).outputs()


def test_a_run_can_be_ended_after_an_error(instance):
    run(instance)
    refused(instance, instance.slave.doStep, 3 * STEP, math.nan)
    instance.slave.terminate()


def test_a_state_goes_into_a_fresh_instance(instance, instantiate, block_name):
    """Also its phase: the fresh instance goes on without initialization of its own."""
    state = run(instance).slave.getFMUstate()
    fresh = instantiate(block_name, "fresh")
    fresh.slave.setFMUstate(state)
    for each in (instance, fresh):
        each.slave.doStep(3 * STEP, STEP)
    assert fresh.outputs() == instance.outputs()
    instance.slave.freeFMUstate(state)


def test_directional_derivatives_follow_a_restored_state(instance):
    outputs, inputs = instance.vr(*instance.names("output")), instance.vr(*instance.names("input"))

    def derivatives() -> list[list[float]]:
        asked = (outputs, outputs[:1])  # some blocks have the first outputs' by a way of their own
        derive, seed = instance.slave.getDirectionalDerivative, [1.0] * len(inputs)
        return [derive(unknowns, inputs, seed) for unknowns in asked]

    run(instance).outputs()
    state, before = instance.slave.getFMUstate(), derivatives()
    instance.set({name: 5e-3 for name in instance.names("input")})
    instance.slave.doStep(3 * STEP, 0.5)
    instance.outputs()
    instance.slave.setFMUstate(state)
    assert derivatives() == before
    instance.slave.freeFMUstate(state)


def test_input_derivatives_may_be_given_before_the_run(instantiate):
    """In the instantiated state as in initialization; they hold for the first step."""
    ends = []
    for early in (True, False):
        carbody = instantiate("carbody", f"early {early}")
        vr = carbody.vr("front.force_z")
        if early:
            carbody.slave.setRealInputDerivatives(vr, [1], [1e6])
        carbody.slave.enterInitializationMode()
        if not early:
            carbody.slave.setRealInputDerivatives(vr, [1], [1e6])
        carbody.slave.exitInitializationMode()
        carbody.slave.doStep(0.0, 0.1)
        ends.append(carbody.outputs())
        assert carbody.get("front.force_z")[0] == pytest.approx(1e5, rel=1e-14)
    assert ends[0] == ends[1]


def test_outputs_can_be_read_before_the_run(instance):
    """With start values, as an importer shows them; what is set then shows at once."""
    assert np.isfinite(instance.outputs()).all()
    instance.slave.enterInitializationMode()
    early = instance.outputs()
    instance.slave.exitInitializationMode()
    assert instance.outputs() == early


def test_a_value_that_was_set_can_be_read_when_the_model_has_no_outputs(instantiate):
    """Parameters that contradict each other must be seen to be corrected."""
    carbody = instantiate("carbody")
    kept = carbody.get("half_truck_spacing")[0]
    carbody.set({"half_truck_spacing": 1e308})
    assert "no finite model" in refused(carbody, carbody.outputs)
    assert carbody.get("half_truck_spacing") == [1e308]
    carbody.set({"half_truck_spacing": kept})
    assert np.isfinite(carbody.outputs()).all()


def test_a_value_is_read_as_the_type_that_it_has(instantiate):
    track = instantiate("track")
    message = refused(track, track.get, "seed")
    assert message == "seed is of type integer and cannot be read as real"
    speed = track.vr("speed")
    assert "cannot be read as integer" in refused(track, track.slave.getInteger, speed)
    assert track.slave.getInteger(track.vr("seed")) == [1]


def test_a_tunable_parameter_changes_a_run_from_then_on(instantiate):
    one, other = (instantiate("wheelrail", name).initialize() for name in ("one", "other"))
    motion = {"y": 1e-3, "vy": 0.02, "load_left": 1e5, "load_right": 1e5}
    for each in (one, other):
        each.set(motion)
    before = other.outputs()
    assert one.outputs() == before
    tuned = ("friction_coefficient", "lateral_creep_coefficient")  # whatever the creep law reads
    kept = one.get(*tuned)
    one.set({name: 0.1 * value for name, value in zip(tuned, kept, strict=True)})
    assert abs(one.get("force_y")[0]) < 0.5 * abs(other.get("force_y")[0])
    assert other.outputs() == before
    one.set(dict(zip(tuned, kept, strict=True)))
    assert one.outputs() == before


def test_no_step_runs_in_the_background(instance2):
    run(instance2)
    assert "no step runs in the background" in refused(instance2, instance2.slave.cancelStep)
    assert instance2.slave.getRealStatus(2) == pytest.approx(3 * STEP)
    assert instance2.slave.getBooleanStatus(3) is False


def test_the_start_time_is_where_the_run_begins(instance2):
    instance2.slave.setupExperiment(startTime=2.5)
    instance2.slave.setupExperiment(startTime=3.5)
    instance2.slave.enterInitializationMode()
    assert instance2.slave.getRealStatus(2) == 3.5
    instance2.slave.exitInitializationMode()
    assert "before initialization" in refused(instance2, instance2.slave.setupExperiment)


def test_without_an_instance_every_call_is_an_error(instance2):
    library = instance2.slave.dll
    for name in ("Reset", "Terminate", "EnterInitializationMode", "ExitInitializationMode"):
        assert getattr(library, f"fmi2{name}")(ctypes.c_void_p()) == 3
