"""What importers do: read all variables, set states by name, hand back broken bytes."""

from __future__ import annotations

import ctypes
import math
import re
import struct
import zipfile
from collections.abc import Iterator
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from fmus.catalogue import fmu_path
from fmus.export.compiler import FLAGS
from support.excitation import STEP, advance
from support.fmu_instance import FmuInstance

HEADER = 39
"""Bytes of the GUID in front of a serialized state, with the zero at its end."""


def checksum(body: bytes) -> bytes:
    """FNV-1a of 64 bits, as the FMU computes it."""
    sum_ = 0xCBF29CE484222325
    for byte in body:
        sum_ = ((sum_ ^ byte) * 0x100000001B3) % 2**64
    return struct.pack("<Q", sum_)


@pytest.mark.parametrize("phase", ["instantiated", "running"])
def test_every_variable_can_be_read_whatever_the_interface(instances, block_name, phase):
    """fmusim records all of them, the event indicators of model exchange, too."""
    instance = instances(block_name, "3.0")
    if phase == "running":
        advance(instance.initialize(), 5, np.random.default_rng(1))
    read = {"Float64": "getFloat64", "Int32": "getInt32", "Boolean": "getBoolean"}
    for v in instance.description.modelVariables:
        count = math.prod(int(d.start) for d in v.dimensions)
        values = getattr(instance.slave, read.get(v.type, "getInt64"))([v.valueReference], count)
        assert len(values) == count, v.name


@pytest.mark.parametrize("wrong", ["guid", "type", "name"])
def test_why_there_is_no_instance_is_told_under_the_name_that_was_asked_for(block_name, wrong):
    path = fmu_path(block_name)
    description = read_model_description(str(path))
    said = []
    kind = ctypes.CFUNCTYPE(
        None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, *[ctypes.c_char_p] * 2
    )
    logger = kind(lambda _env, name, status, _category, text: said.append((name, status)))
    callbacks = fmi2CallbackFunctions(ctypes.cast(logger, fmi2CallbackLoggerTYPE))
    slave = FmuInstance(path).slave
    arguments = [b"mine", 1, description.guid.encode(), None, ctypes.byref(callbacks), 0, 0]
    arguments[{"guid": 2, "type": 1, "name": 0}[wrong]] = {"guid": b"{}", "type": 7, "name": None}[
        wrong
    ]
    assert slave.dll.fmi2Instantiate(*arguments) in (0, None)
    assert said == [(b"" if wrong == "name" else b"mine", 3)]


def broken(body: bytes) -> Iterator[bytes]:
    """The body with eight of its bytes at a time as no run leaves them; a long one in samples."""
    size = len(body) // 8 * 8
    for place in (*range(0, min(size, 2400), 8), *range(2400, size, 4000), size - 8):
        for value in (b"\xff" * 8, struct.pack("<d", math.nan), struct.pack("<d", 1e300)):
            yield body[:place] + value + body[place + 8 :]


def test_broken_bytes_are_refused_or_do_no_harm(instantiate, block_name):
    """Both with a checksum that betrays them and with one that was made for them."""
    instance = instantiate(block_name).initialize()
    slave = instance.slave
    advance(instance, 5, np.random.default_rng(1))
    state = slave.getFMUstate()
    data, before = slave.serializeFMUstate(state), instance.outputs()
    guid, body = data[:HEADER], data[HEADER + 8 :]
    own = data[HEADER : HEADER + 8]
    assert own == checksum(body)
    taken = 0
    for one in broken(body):
        with pytest.raises(FMICallException):
            slave.deSerializeFMUstate(guid + own + one)
        assert instance.messages[-1].startswith("these bytes are a damaged state: the checksum")
        try:
            slave.setFMUstate(slave.deSerializeFMUstate(guid + checksum(one) + one))
            taken += 1
            instance.outputs()
            slave.doStep(0.0, STEP)
        except FMICallException:
            assert instance.messages[-1]
        slave.setFMUstate(state)
        assert instance.outputs() == before
    assert taken
    for length in (0, HEADER, len(data) - 1):
        with pytest.raises(FMICallException):
            slave.deSerializeFMUstate(data[:length])


@pytest.mark.parametrize("mode", ["event", "continuous-time"])
def test_model_exchange_takes_states_by_their_references(instantiate2, block_name, mode):
    """As CasADi sets them."""
    by_name, by_vector = (instantiate2(block_name, n, model_exchange=True) for n in "ab")
    for instance in (by_name, by_vector):
        instance.initialize()
        instance.slave.enterContinuousTimeMode()
    names = [u.variable.derivative.name for u in by_name.description.derivatives]
    values = [1e-3 * (n + 1) for n in range(len(names))]
    by_vector.set_states(values)
    if mode == "event":
        by_name.slave.enterEventMode()
    by_name.set(dict(zip(names, values, strict=True)))
    assert by_name.states() == values
    assert by_name.outputs() == by_vector.outputs()
    assert by_name.derivatives() == by_vector.derivatives()


def test_a_state_is_set_as_a_number_while_an_integrator_runs(instantiate2):
    truck = instantiate2("truck", model_exchange=True)
    with pytest.raises(FMICallException):
        truck.set({"q[1]": 1.0})
    expected = "q[1] is a state: it is set in event mode or continuous-time mode"
    assert truck.messages[-1] == expected
    truck.initialize()
    with pytest.raises(FMICallException):
        truck.set({"q[1]": math.nan})
    assert truck.messages[-1] == "the state q[1] cannot be nan: a finite number is needed"


def test_states_and_what_an_integrator_sees_say_how_far_they_move(block_name, fmi):
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    for element in root.iter():
        causality = element.get("causality")
        real = element if fmi == "3.0" else element.find("Real")
        of_a_state = re.fullmatch(r"qd?(\[\d+\])?|distance", element.get("name") or "")
        if causality == "local" or (causality == "output" and of_a_state):
            many = element.find("Dimension") is not None  # of different units, perhaps
            assert many or real.get("nominal"), element.get("name")


def test_the_integrator_is_told_the_same(instantiate2, block_name):
    model = instantiate2(block_name, model_exchange=True).initialize()
    states = [u.variable.derivative for u in model.description.derivatives]
    told = (ctypes.c_double * len(states))()
    model.slave.fmi2GetNominalsOfContinuousStates(model.slave.component, told, len(states))
    assert list(told) == [float(v.nominal) for v in states]


def test_the_build_description_names_the_language_that_the_binaries_were_compiled_as(
    block_name, fmi
):
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        root = ElementTree.fromstring(archive.read("sources/buildDescription.xml"))
    languages = {e.get("language") for e in root.iter("SourceFileSet")}
    assert languages == {FLAGS[0].removeprefix("-std=").upper()}


def test_a_step_of_hours_is_refused_with_what_makes_it_long(instantiate):
    truck = instantiate("truck").initialize({"micro_step": 1e-6})
    with pytest.raises(FMICallException):
        truck.slave.doStep(0.0, 10.0)
    assert truck.messages[-1].startswith(
        "doStep by 10 s would take 1e+07 micro steps of 1e-06 s, and 1e+06 are the most"
    )
    truck.slave.doStep(0.0, 0.5)


def test_a_status_without_a_place_for_it_is_refused(instantiate2):
    slave = instantiate2("truck").slave
    for function, kind in ((slave.fmi2GetRealStatus, 2), (slave.fmi2GetBooleanStatus, 3)):
        with pytest.raises(FMICallException):
            function(slave.component, kind, None)
