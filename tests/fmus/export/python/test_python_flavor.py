"""The Python flavour of each block: the same numbers as the native FMU, and as well behaved."""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2ValueReference

import tolerances
from fmus.catalogue import fmu_path
from fmus.export.python import build_python
from fmus.names import CAR
from orchestrator import Component, System, describe, simulate
from support.archive_checks import findings
from support.excitation import STEP, advance, scaled_inputs
from support.fmu_instance import FmuInstance
from support.python_process import TESTS, run_script
from tracktrain.car.changes import swapped
from tracktrain.car.hopper import HOPPER, hopper_car

NOT_NEEDED = ("fmus", "orchestrator", "tracktrain", "pythonfmu", "pint", "scipy")
DISCARDED = "status 2"
ERROR = "status 3"


class Flavors(dict[str, Path]):
    """The Python FMUs by block; those of further blocks are built when they are asked for."""

    def __init__(self, folder: Path) -> None:
        super().__init__({name: build_python(name, folder) for name in CAR})
        self.folder = folder

    def __missing__(self, name: str) -> Path:
        self[name] = build_python(name, self.folder)
        return self[name]


@pytest.fixture(scope="module")
def flavors(tmp_path_factory) -> Flavors:
    return Flavors(tmp_path_factory.mktemp("python"))


@pytest.fixture
def make(flavors):
    """Instantiate a block's Python FMU; all are freed when the test ends."""
    open_instances: list[FmuInstance] = []

    def instance(block: str) -> FmuInstance:
        open_instances.append(FmuInstance(flavors[block]))
        return open_instances[-1]

    yield instance
    for one in open_instances:
        one.close()


def refused(instance: FmuInstance, function, *arguments, status: str = ERROR) -> str:
    """What an instance says to a call that it refuses."""
    before = len(instance.messages)
    with pytest.raises(FMICallException, match=status):
        function(*arguments)
    return instance.messages[before]


def test_python_and_native_agree_on_every_port(make, instantiate, block_name):
    pair = (make(block_name), instantiate(block_name))
    runs = []
    for instance in pair:
        rng = np.random.default_rng(1)
        instance.set(scaled_inputs(instance, rng))
        start = instance.initialize().outputs()
        runs.append(np.array([start, *advance(instance, 60, rng)]))
    ours, native = runs
    scale = np.abs(native).max(0)
    assert (np.abs(ours - native) <= tolerances.PARITY * np.maximum(scale, 1e-12)).all()
    assert (scale > 0).any()


def test_parameters_are_taken_before_and_tunable_ones_during_a_run(make, instantiate):
    runs = []
    for instance in (make("truck"), instantiate("truck")):
        rng = np.random.default_rng(2)
        instance.slave.setInteger(instance.vr("wedge_law"), [2])
        instance.initialize({"bolster_mass": 600.0, "initial.yaw": 1e-3})
        first = advance(instance, 10, rng)
        instance.set({"bolster_lateral.friction_limit": 1e3})
        runs.append(np.array([*first, *advance(instance, 10, rng, 10)]))
    ours, native = runs
    assert (np.abs(ours - native) <= tolerances.PARITY * np.abs(native).max(0)).all()


def test_checkers_find_nothing(flavors, block_name):
    assert findings(flavors[block_name]) == []


def test_ports_and_parameters_are_described_as_in_the_native_fmu(flavors, block_name):
    native, ours = (describe(path) for path in (fmu_path(block_name), flavors[block_name]))
    inputs = {v.name for v in native.inputs}
    for name, variable in ours.variables.items():
        twin = native.variables[name]
        if twin.causality == "output":
            twin = replace(twin, dependencies=twin.dependencies & inputs)  # without states
        assert variable == twin
    further = ("local", "calculatedParameter")
    ports = {v.name for v in native.variables.values() if v.causality not in further}
    assert set(ours.variables) == ports
    assert ours.tangents == native.tangents


def test_what_the_binary_cannot_do_is_declared_and_refused(make, block_name):
    instance = make(block_name).initialize()
    said = instance.description.coSimulation
    assert not said.needsExecutionTool
    assert not said.canInterpolateInputs
    assert not said.providesDirectionalDerivative
    assert said.canGetAndSetFMUstate
    assert said.canSerializeFMUstate
    inputs, outputs = (instance.vr(instance.names(c)[0]) for c in ("input", "output"))
    with pytest.raises(FMICallException):
        instance.slave.setRealInputDerivatives(inputs, [1], [0.0])
    with pytest.raises(FMICallException):
        instance.slave.getDirectionalDerivative(outputs, inputs, [1.0])


def test_the_bytes_are_the_same_on_every_build(flavors, tmp_path):
    again = build_python("truck", tmp_path)
    assert again.read_bytes() == flavors["truck"].read_bytes()


def test_all_that_python_imports_is_one_package_with_a_name_of_its_own(flavors):
    for path in flavors.values():
        names = zipfile.ZipFile(path).namelist()
        top = {n.split("/")[1] for n in names if n.startswith("resources/")} - {"model.txt"}
        assert len(top) == 1
        assert re.fullmatch(rf"{path.stem}_[0-9a-f]{{12}}", top.pop())
        needs = zipfile.ZipFile(path).read("documentation/externalDependencies.txt").decode()
        assert {line.split()[0] for line in needs.splitlines()[5:]} == {"casadi", "numpy"}


def test_it_runs_where_only_casadi_and_numpy_are_installed(flavors, tmp_path):
    script = f"""
from fmpy import simulate_fmu
for path in {[str(p) for p in flavors.values()]!r}:
    simulate_fmu(path, stop_time=0.01, output_interval=0.001)
print("ran")
"""
    assert "ran" in run_script(script, tmp_path, hidden=NOT_NEEDED)


def test_blocks_and_versions_of_a_block_share_a_process(flavors, tmp_path):
    """A second version with another law in the same file of the same name: each computes its own.

    Each also lives on when the folder that it was first imported from is gone.
    """
    other = with_creep_doubled(flavors["wheelrail"], tmp_path)
    script = f"""
import sys
sys.path.insert(0, {TESTS!r})
from support.fmu_instance import FmuInstance
paths = {[str(p) for p in (flavors["wheelrail"], other, flavors["truck"], flavors["track"])]!r}
FmuInstance(paths[0]).initialize().close()
instances = [FmuInstance(path) for path in paths for _ in range(2)]
for k, instance in enumerate(instances):
    instance.initialize()
for instance in instances[:4]:
    instance.set({{"yaw": 1e-3}})
print([instance.get("force_y")[0] for instance in instances[:4]])
print([len(instance.outputs()) for instance in instances[4:]])
assert not [place for place in sys.path if "resources" in place]
"""
    forces, counts = map(json.loads, run_script(script, tmp_path).splitlines())
    assert forces[0] == forces[1] != 0.0
    assert forces[2:] == pytest.approx([2.0 * forces[0]] * 2, rel=1e-12)
    assert counts == [51, 51, 26, 26]


def with_creep_doubled(original: Path, folder: Path) -> Path:
    """An FMU whose sources, and hence whose hash, differ."""
    old = zipfile.ZipFile(original)
    changed = {name: old.read(name) for name in old.namelist()}
    for name, content in changed.items():
        changed[name] = content.replace(
            b"""-p["lateral_creep_coefficient"] * creep_y""",
            b"""-2 * p["lateral_creep_coefficient"] * creep_y""",
        )
    hashed = old.read("resources/model.txt").split()[0].rpartition(b"_")[2]
    digest = hashlib.sha256(repr(changed).encode()).hexdigest()[: len(hashed)].encode()
    path = folder / "doubled.fmu"
    with zipfile.ZipFile(path, "w") as new:
        for name, content in changed.items():
            place = name.replace(hashed.decode(), digest.decode())
            new.writestr(place, content.replace(hashed, digest))
    return path


def test_rollback_is_complete(make, block_name):
    instance = make(block_name).initialize()
    advance(instance, 10, np.random.default_rng(2))
    state = instance.slave.getFMUstate()
    first = advance(instance, 15, np.random.default_rng(3), 10)
    instance.slave.setFMUstate(state)
    assert np.array_equal(first, advance(instance, 15, np.random.default_rng(3), 10))
    instance.slave.freeFMUstate(state)


def test_a_state_as_bytes_continues_in_another_instance(make, block_name):
    one, other = make(block_name), make(block_name)
    one.initialize()
    advance(one, 10, np.random.default_rng(2))
    data = one.slave.serializeFMUstate(one.slave.getFMUstate())
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    expected = advance(one, 15, np.random.default_rng(3), 10)
    assert np.array_equal(expected, advance(other, 15, np.random.default_rng(3), 10))


def test_foreign_bytes_are_no_state(make):
    instance, other = make("truck").initialize(), make("track").initialize()
    slave = instance.slave
    data = bytearray(slave.serializeFMUstate(slave.getFMUstate()))
    data[40] ^= 0xFF
    message = refused(instance, slave.deSerializeFMUstate, bytes(data))
    assert message == "these bytes are no state of this FMU"
    foreign = other.slave.serializeFMUstate(other.slave.getFMUstate())
    message = refused(instance, slave.deSerializeFMUstate, foreign)
    assert re.fullmatch(r"this is a state of track_python_\w+, another FMU", message)


def test_wrong_values_are_refused_with_a_message_and_do_no_harm(make):
    instance = make("wheelrail")
    slave, vr = instance.slave, instance.vr
    assert refused(instance, instance.set, {"speed": float("nan")}) == (
        "speed cannot be nan: a finite number is needed"
    )
    assert refused(instance, instance.set, {"axle_load": -1.0}) == (
        "axle_load cannot be -1 N: it must be at least 0.001 N"
    )
    assert refused(instance, slave.setInteger, vr("creep_law"), [9]) == (
        "creep_law cannot be 9: it must be at least 1 and at most 5"
    )
    assert refused(instance, instance.set, {"creep_law": 1.0}) == (
        "creep_law is of type integer and cannot be set as real"
    )
    assert refused(instance, instance.set, {"force_y": 1.0}) == (
        "force_y is an output and cannot be set"
    )
    assert refused(instance, slave.getReal, [999]).startswith("there is no value reference 999")
    instance.initialize()
    assert refused(instance, instance.set, {"axle_load": 1e5}) == (
        "axle_load is a fixed parameter: set it before the run starts"
    )
    assert refused(instance, slave.doStep, 0.0, float("nan")).endswith(
        "must be finite and not negative"
    )
    instance.set({"yaw": 1e-3})
    slave.doStep(0.0, STEP)
    assert instance.get("force_y")[0] > 0.0


def test_a_step_that_diverges_is_discarded_and_leaves_the_state(make):
    instance = make("truck").initialize()
    instance.set({"axle[1].force_y": 1.0})
    before = instance.outputs()
    instance.set({"axle[1].force_y": 1.7e308})
    message = refused(instance, instance.slave.doStep, 0.0, 1.0, status=DISCARDED)
    assert message.startswith("doStep from t = 0 s by 1 s: ")
    assert message.endswith("take a smaller step")
    instance.set({"axle[1].force_y": 1.0})
    assert instance.outputs() == before
    instance.slave.doStep(0.0, STEP)


def test_null_lists_are_no_reason_to_crash(make):
    slave = make("track").slave
    slave.fmi2GetReal(slave.component, None, 0, None)
    slave.fmi2SetReal(slave.component, (fmi2ValueReference * 0)(), 0, None)


def test_the_orchestrator_tells_what_stopped_it(flavors):
    truck = Component(flavors["truck"], {"axle[1].force_y": 1.7e308})
    done = simulate(System({"truck": truck}, ()), duration=1.0, step=0.5)
    assert not done.completed
    assert "would no longer be finite" in done.message


@pytest.mark.parametrize("instance", ["carbody", "truck_front", "wheelset_11", "track"])
def test_the_car_runs_the_same_with_a_block_in_python(flavors, instance):
    """With held inputs both flavours get the same calls."""

    def run(car: System) -> np.ndarray:
        done = simulate(car, duration=0.02, step=1e-3, master="jacobi")
        assert done.completed, done.message
        return np.array([done.dataset[name].values for name in sorted(done.dataset.data_vars)])

    car = hopper_car()
    swap, lacking = swapped(car, instance, flavors[HOPPER.blocks[instance]])
    assert lacking == []
    native, ours = run(car), run(swap)
    scale = np.abs(native).max(1, keepdims=True)
    assert (np.abs(ours - native) <= tolerances.FLAVORS_IN_THE_CAR * np.maximum(scale, 1e-12)).all()
