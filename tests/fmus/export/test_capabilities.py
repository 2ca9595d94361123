"""What the model descriptions promise, flag by flag, is what the FMUs do."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.units import base_exponents
from support.fmi3_instance import INSTANCE

KINDS: dict[tuple[str, str], Any] = {
    ("2.0", "ModelExchange"): FMU2Model,
    ("2.0", "CoSimulation"): FMU2Slave,
    ("3.0", "ModelExchange"): FMU3Model,
    ("3.0", "CoSimulation"): FMU3Slave,
}
EVERYWHERE = {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True,
              "providesDirectionalDerivative": True, "canBeInstantiatedOnlyOncePerProcess": False,
              "needsExecutionTool": False}  # fmt: skip
STEPPED = {"canHandleVariableCommunicationStepSize": True}
NEWER = {"providesAdjointDerivatives": True, "providesPerElementDependencies": True,
         "providesEvaluateDiscreteStates": False}  # fmt: skip
PROMISED: dict[tuple[str, str], dict[str, Any]] = {
    ("2.0", "ModelExchange"): {**EVERYWHERE, "canNotUseMemoryManagementFunctions": True},
    ("2.0", "CoSimulation"): {
        **EVERYWHERE,
        **STEPPED,
        "canNotUseMemoryManagementFunctions": True,
        "canInterpolateInputs": True,
        "maxOutputDerivativeOrder": 0,
        "canRunAsynchronuously": False,
    },
    ("3.0", "ModelExchange"): {**EVERYWHERE, **NEWER},
    ("3.0", "CoSimulation"): {
        **EVERYWHERE,
        **NEWER,
        **STEPPED,
        "maxOutputDerivativeOrder": 0,
        "providesIntermediateUpdate": True,
        "canReturnEarlyAfterIntermediateUpdate": True,
        "mightReturnEarlyFromDoStep": False,
        "recommendedIntermediateInputSmoothness": 0,
        "hasEventMode": False,
        "fixedInternalStepSize": None,
    },
}
"""Every flag of FMI's, with FMI 2.0's spelling where both versions have it."""


def spelled(flag: str, fmi: str) -> str:
    if fmi == "2.0":
        return flag
    return flag.replace("FMUstate", "FMUState").replace(
        "providesDirectionalDerivative", "providesDirectionalDerivatives"
    )


@pytest.fixture(params=["ModelExchange", "CoSimulation"])
def interface(request) -> str:
    return request.param


@pytest.fixture
def described(block_name, fmi) -> ElementTree.Element:
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def variables(described: ElementTree.Element) -> list[tuple[dict[str, str], str]]:
    """Attributes and type of each variable, in one form for both versions."""
    found = []
    for element in described.find("ModelVariables"):
        inner = element if element.tag != "ScalarVariable" else element[0]
        found.append(({**element.attrib, **inner.attrib}, inner.tag))
    return found


def test_each_flag_is_what_is_promised_and_none_is_left_out(described, block_name, fmi, interface):
    said = dict(described.find(interface).attrib)
    assert said.pop("modelIdentifier") == block_name
    follows = bool(BLOCKS[block_name]().memory)
    if interface == "ModelExchange":
        flag = (
            "completedIntegratorStepNotNeeded" if fmi == "2.0" else "needsCompletedIntegratorStep"
        )
        assert said.pop(flag) == str(follows == (fmi == "3.0")).lower()
    for flag, value in PROMISED[fmi, interface].items():
        default = "0" if isinstance(value, int) and not isinstance(value, bool) else "false"
        found = said.pop(spelled(flag, fmi), None if value is None else default)
        assert found == (None if value is None else str(value).lower()), flag
    assert said == {}


@pytest.fixture
def opened(tmp_path, block_name, fmi, interface):
    """Makes instances that are ready to run; their value references of outputs and inputs."""
    path = fmu_path(block_name, fmi)
    description, folder = read_model_description(str(path)), extract(str(path), str(tmp_path))
    made = []

    def make() -> Any:
        fmu = KINDS[fmi, interface](
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=block_name,
            instanceName=f"number {len(made)}",
        )
        fmu.instantiate()
        made.append(fmu)
        if fmi == "2.0":
            fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        return fmu

    yield make
    for fmu in made:
        fmu.freeInstance()


def references(block: str, fmi: str, causality: str) -> list[int]:
    listed = read_model_description(str(fmu_path(block, fmi))).modelVariables
    return [v.valueReference for v in listed if v.causality == causality and not v.dimensions]


def numbers(fmu: Any) -> tuple[Callable, Callable]:
    """Functions that read and set numbers."""
    return (
        (fmu.getFloat64, fmu.setFloat64)
        if hasattr(fmu, "getFloat64")
        else (fmu.getReal, fmu.setReal)
    )


def states(fmu: Any, fmi: str) -> dict[str, Callable]:
    """The functions of saved states by what they do."""
    name = "FMUstate" if fmi == "2.0" else "FMUState"
    load = "deSerialize" if fmi == "2.0" else "deserialize"
    called = {"get": f"get{name}", "set": f"set{name}", "free": f"free{name}",
              "save": f"serialize{name}", "load": f"{load}{name}"}  # fmt: skip
    return {what: getattr(fmu, function) for what, function in called.items()}


def test_states_are_saved_restored_and_taken_over_as_bytes(opened, block_name, fmi, interface):
    one, other = opened(), opened()
    inputs, outputs = (references(block_name, fmi, c) for c in ("input", "output"))
    get, set_ = numbers(one)
    before = list(get(outputs))
    call = states(one, fmi)
    held = call["get"]()
    data = call["save"](held)
    set_(inputs, np.array(get(inputs)) + 1e-3)
    assert list(get(outputs)) != before
    call["set"](held)
    assert list(get(outputs)) == before
    call["free"](held)
    set_(inputs, np.array(get(inputs)) + 1e-3)
    across = states(other, fmi)
    if fmi == "2.0":
        from fmpy.fmi2 import fmi2FMUstate

        taken = fmi2FMUstate()
        across["load"](data, taken)
    else:
        taken = across["load"](data)
    across["set"](taken)
    assert list(numbers(other)[0](outputs)) == before
    across["free"](taken)


def test_derivatives_are_given_by_every_input_and_those_by_adjoints_are_the_same(
    opened, block_name, fmi
):
    fmu = opened()
    inputs, outputs = (references(block_name, fmi, c) for c in ("input", "output"))
    matrix = np.array([fmu.getDirectionalDerivative(outputs, [known], [1.0]) for known in inputs])
    assert np.isfinite(matrix).all()
    if fmi == "3.0":
        seed = np.linspace(1.0, 2.0, len(outputs))
        adjoint = fmu.getAdjointDerivative(outputs, inputs, seed, len(inputs))
        assert adjoint == pytest.approx(matrix @ seed, rel=1e-12, abs=1e-9 * np.abs(matrix).max())


def test_instances_live_side_by_side_in_one_process(opened, block_name, fmi):
    one, other = opened(), opened()
    inputs, outputs = (references(block_name, fmi, c) for c in ("input", "output"))
    (get, set_), (get_other, _) = numbers(one), numbers(other)
    before = list(get_other(outputs))
    set_(inputs, np.array(get(inputs)) + 1e-3)
    get(outputs)
    assert list(get_other(outputs)) == before


@pytest.mark.parametrize("interface", ["CoSimulation"], indirect=True)
def test_steps_may_be_of_any_length(opened, block_name, fmi):
    fmu, time = opened(), 0.0
    get, _ = numbers(fmu)
    for size in (1e-3, 3e-4, 0.0, 7e-3):
        fmu.doStep(time, size)
        time += size
    assert np.isfinite(get(references(block_name, fmi, "output"))).all()


@pytest.mark.parametrize("interface", ["CoSimulation"], indirect=True)
def test_there_are_no_output_derivatives_and_none_are_promised(opened, block_name, fmi):
    fmu = opened()
    outputs = references(block_name, fmi, "output")[:1]
    with pytest.raises(FMICallException):
        if fmi == "2.0":
            fmu.getRealOutputDerivatives(outputs, [1])
        else:
            fmu.getOutputDerivatives(outputs, [1])


def test_nothing_depends_on_the_reference_0_and_one_variable_is_independent(described, fmi):
    """In FMI 2.0 numbers of unknowns and dependencies are places in the list, from 1."""
    listed = variables(described)
    independent = [v["name"] for v, _ in listed if v["causality"] == "independent"]
    assert independent == ([] if fmi == "2.0" else ["time"])
    names = {int(v["valueReference"]) for v, _ in listed} if fmi == "3.0" else set(
        range(1, len(listed) + 1)
    )  # fmt: skip
    own = "valueReference" if fmi == "3.0" else "index"
    for unknown in described.find("ModelStructure").iter():
        if unknown.get("dependencies") is None:
            continue
        depends = [int(number) for number in unknown.get("dependencies").split()]
        assert len(set(depends)) == len(depends)
        assert 0 not in depends
        assert {int(unknown.get(own)), *depends} <= names


def test_units_are_defined_by_the_exponents_of_their_names(described):
    """Except the root of a mass, for which FMI has no exponent."""
    units = {unit.get("name"): unit.find("BaseUnit") for unit in described.iter("Unit")}
    used = {v["unit"] for v, _ in variables(described) if "unit" in v}
    assert used <= set(units)
    without = {name for name, base in units.items() if base is None}
    assert all("kg^(" in name for name in without), without
    for name in set(units) - without:
        found = {key: int(value) for key, value in units[name].attrib.items()}
        assert found == base_exponents(name), name


def test_a_rate_has_the_unit_of_what_it_is_the_rate_of_per_second(described, fmi):
    listed = variables(described)
    by_number = {
        v["valueReference"] if fmi == "3.0" else str(place): v
        for place, (v, _) in enumerate(listed, start=1)
    }
    rates = [v for v, _ in listed if "derivative" in v]
    assert len(rates) >= len(described.findall("ModelStructure//Derivatives/Unknown"))
    for rate in rates:
        of = by_number[rate["derivative"]]
        if "unit" not in rate or "^" in rate["unit"] + of["unit"]:
            continue
        expected = dict(base_exponents(of["unit"]))
        expected["s"] = expected.get("s", 0) - 1
        assert base_exponents(rate["unit"]) == {k: n for k, n in expected.items() if n}, rate


def test_inputs_may_vary_within_a_step_where_that_is_promised(described, fmi):
    inputs = [v for v, _ in variables(described) if v["causality"] == "input"]
    assert inputs
    for v in inputs:
        assert v["variability"] == "continuous"
        assert "start" in v
        assert (v.get("intermediateUpdate") == "true") == (fmi == "3.0"), v["name"]


def test_an_input_that_is_led_along_a_line_ends_where_the_line_does(block_name, fmi):
    """canInterpolateInputs in FMI 2.0, providesIntermediateUpdate in FMI 3.0."""
    instance = INSTANCE[fmi](fmu_path(block_name, fmi)).initialize()
    name = instance.names("input")[0]
    (begin,) = instance.get(name)
    instance.slave.setRealInputDerivatives(instance.vr(name), [1], [0.5])
    instance.slave.doStep(0.0, 1e-2)
    assert instance.get(name)[0] == pytest.approx(begin + 5e-3, rel=1e-12)
    instance.close()
