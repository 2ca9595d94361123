"""Sentences of the FMI 3.0 standard, and both of its interfaces in a simulator of others."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3ScheduledExecution, FMU3Slave

import tolerances
from fmus.catalogue import fmu_path
from support.functions import FUNCTIONS

STEP = 1e-3
INPUTS = {
    "carbody": {"front.force_y": 2e4, "rear.moment_z": -1e4},
    "truck": {"axle[1].force_y": 3e4, "car.y": 2e-3},
    "truck_joints": {"axle[1].force_y": 3e4, "car.y": 2e-3},
    "wheelrail": {"y": 2e-3, "vy": 0.02, "load_left": 1e5, "load_right": 1e5},
    "track": {"speed": 31.0},
}


@pytest.fixture
def instance(instances, block_name):
    return instances(block_name, "3.0")


@pytest.fixture
def opened(tmp_path, block_name):
    """Makes an instance of one of FMPy's kinds, and the list of what it logs."""
    path = str(fmu_path(block_name, "3.0"))
    description, folder = read_model_description(path), extract(path, str(tmp_path))
    made = []

    def make(kind, **more):
        messages: list[str] = []
        fmu = kind(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=block_name,
            instanceName="opened",
        )
        fmu.instantiate(logMessage=lambda _e, _s, _c, text: messages.append(text.decode()), **more)
        made.append(fmu)
        return fmu, messages

    yield make
    for fmu in made:
        fmu.freeInstance()


def refused(messages, function, *arguments) -> str:
    """The message of a call that has to fail."""
    with pytest.raises(FMICallException):
        function(*arguments)
    return messages[-1]


@pytest.mark.parametrize("fmi_type", ["CoSimulation", "ModelExchange"])
def test_a_simulator_gets_from_either_version_the_same(block_name, fmi_type):
    outputs = ["front.y", "q", "axle[1].vy", "force_y", "axle[1].rail_y_left", "distance"]
    two, three = (fmu_path(block_name, fmi) for fmi in ("2.0", "3.0"))
    listed = {v.name for v in read_model_description(str(three)).modelVariables if not v.dimensions}
    settings = {
        "fmi_type": fmi_type,
        "stop_time": 0.2,
        "output_interval": 0.01,
        "start_values": INPUTS[block_name],
        "output": [name for name in outputs if name in listed],
    }
    if fmi_type == "ModelExchange":
        settings |= {"relative_tolerance": 1e-9}
    one, other = (simulate_fmu(str(path), **settings) for path in (two, three))
    for name in settings["output"]:
        assert np.array_equal(one["time"], other["time"])
        assert other[name] == pytest.approx(one[name], rel=tolerances.EXCHANGE, abs=1e-12), name
        assert np.isfinite(other[name]).all()


def test_states_and_derivatives_go_by_the_order_of_the_description(opened, block_name):
    model, _ = opened(FMU3Model)
    model.enterInitializationMode()
    model.exitInitializationMode()
    description = read_model_description(str(fmu_path(block_name, "3.0")))

    def sizes(variables):
        return [v.valueReference for v in variables], sum(
            int(v.dimensions[0].start) if v.dimensions else 1 for v in variables
        )

    count = model.getNumberOfContinuousStates()
    rates = [unknown.variable for unknown in description.derivatives]
    x, dx = (ctypes.c_double * count)(), (ctypes.c_double * count)()
    model.getContinuousStates(x, count)
    references, total = sizes([v.derivative for v in rates])
    assert total == count
    assert model.getFloat64(references, total) == list(x)
    model.updateDiscreteStates()
    model.enterContinuousTimeMode()
    model.setContinuousStates((ctypes.c_double * count)(*np.linspace(1e-3, 2e-3, count)), count)
    model.getContinuousStateDerivatives(dx, count)
    references, total = sizes(rates)
    assert model.getFloat64(references, total) == list(dx)


def test_event_indicators_are_variables_too(opened, block_name):
    description = read_model_description(str(fmu_path(block_name, "3.0")))
    model, _ = opened(FMU3Model)
    model.enterInitializationMode()
    model.exitInitializationMode()
    count = model.getNumberOfEventIndicators()
    indicators = (ctypes.c_double * max(count, 1))()
    model.getEventIndicators(indicators, count)
    references = [unknown.variable.valueReference for unknown in description.eventIndicators]
    assert (count == 0) == (references == [])
    if count:
        assert model.getFloat64(references, count) == list(indicators)


def test_only_the_independent_variable_has_the_reference_0(block_name):
    description = read_model_description(str(fmu_path(block_name, "3.0")))
    (time,) = (v for v in description.modelVariables if v.causality == "independent")
    assert (time.name, time.valueReference) == ("time", 0)
    unknowns = (*description.outputs, *description.derivatives, *description.initialUnknowns)
    assert all(time not in unknown.dependencies for unknown in unknowns)


def test_time_is_where_the_run_is(instance):
    instance.slave.setupExperiment(startTime=2.5)
    instance.slave.enterInitializationMode()
    instance.slave.exitInitializationMode()
    assert instance.slave.getFloat64([0]) == [2.5]
    instance.slave.doStep(2.5, STEP)
    assert instance.slave.getFloat64([0]) == [2.5 + STEP]


def test_a_stop_time_before_the_start_is_refused(instance):
    instance.slave.setupExperiment(startTime=1.0, stopTime=0.5)
    message = refused(instance.messages, instance.slave.enterInitializationMode)
    assert "stop time lies before the start time" in message


def test_nothing_is_set_after_the_end(instance):
    instance.initialize().slave.terminate()
    before = instance.outputs()
    name = instance.names("input")[0]
    assert "the run has ended" in refused(instance.messages, instance.set, {name: 1.0})
    for setter in (instance.slave.setInt32, instance.slave.setInt64, instance.slave.setBoolean):
        assert "the run has ended" in refused(instance.messages, setter, [1], [1])
    assert instance.outputs() == before


def test_an_enumeration_is_of_64_bits_and_an_integer_of_32(instances):
    track = instances("track", "3.0")
    (spectrum,), (seed,) = track.vr("spectrum"), track.vr("seed")
    track.slave.setInt64([spectrum], [2])
    assert track.slave.getInt64([spectrum]) == [2]
    message = refused(track.messages, track.slave.setInt32, [spectrum], [2])
    assert message == "spectrum is of type enumeration and cannot be set as integer"
    message = refused(track.messages, track.slave.getInt64, [seed])
    assert message == "seed is of type integer and cannot be read as enumeration"


def test_event_mode_and_scheduled_execution_are_not_offered(opened):
    for kind, more in ((FMU3Slave, {"eventModeUsed": True}), (FMU3ScheduledExecution, {})):
        with pytest.raises(Exception, match="instantiate"):
            opened(kind, **more)


def test_what_is_not_offered_says_so_and_takes_empty_lists(instance):
    slave, c = instance.initialize().slave, instance.slave.component
    for kind in ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "String"):
        getter, setter = (getattr(slave, f"fmi3{way}{kind}") for way in ("Get", "Set"))
        for function in (getter, setter):
            function(c, None, 0, None, 0)
            message = refused(instance.messages, function, c, None, 1, None, 1)
            assert message == f"this FMU has no variables of type {kind}"
    for function, arguments, words in (
        (slave.fmi3EnterConfigurationMode, (), "no structural parameters"),
        (slave.fmi3ExitConfigurationMode, (), "no structural parameters"),
        (slave.fmi3EvaluateDiscreteStates, (), "nothing to evaluate"),
        (slave.fmi3EnterStepMode, (), "no event mode in co-simulation"),
        (slave.fmi3GetClock, (None, 0, None), "no clocks"),
        (slave.fmi3ActivateModelPartition, (0, 0.0), "no model partitions"),
    ):
        assert words in refused(instance.messages, function, c, *arguments)


def test_a_list_that_is_not_there_is_refused(instance):
    slave, c = instance.initialize().slave, instance.slave.component
    for function, arguments in (
        (slave.fmi3GetFloat64, (None, 1, None, 1)),
        (slave.fmi3SetFloat64, (None, 1, None, 1)),
        (slave.fmi3GetInt32, (None, 1, None, 1)),
        (slave.fmi3SetBoolean, (None, 1, None, 1)),
        (slave.fmi3GetDirectionalDerivative, (None, 1, None, 0, None, 0, None, 1)),
        (slave.fmi3GetAdjointDerivative, (None, 0, None, 1, None, 0, None, 1)),
        (slave.fmi3DoStep, (0.0, STEP, True, None, None, None, None)),
    ):
        assert "it is NULL" in refused(instance.messages, function, c, *arguments)


def test_without_an_instance_every_call_is_an_error(instance):
    library = ctypes.CDLL(instance.slave.dll._name)  # without FMPy's types of the arguments
    library.fmi3FreeInstance(None)
    other = {"fmi3GetVersion", "fmi3FreeInstance"}
    nothing = [ctypes.c_void_p()] * 12  # as many as any function takes
    for name in FUNCTIONS["3.0"] - other:
        if "Instantiate" not in name:
            assert getattr(library, name)(*nothing) == 3, name


def test_co_simulation_refuses_the_calls_of_model_exchange(instance):
    slave, c = instance.initialize().slave, instance.slave.component
    for function, arguments in (
        (slave.fmi3EnterEventMode, ()),
        (slave.fmi3EnterContinuousTimeMode, ()),
        (slave.fmi3SetTime, (0.0,)),
    ):
        message = refused(instance.messages, function, c, *arguments)
        assert "is for model exchange, and this instance for co-simulation" in message
