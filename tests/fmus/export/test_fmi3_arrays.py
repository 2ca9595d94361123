"""FMI 3.0: arrays are the scalars of FMI 2.0, and both versions are the same block."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.parameters import parameter_set
from support.excitation import STEP, advance, scaled_inputs
from support.fmi3_instance import INDICATORS

EXPECTED = {
    "carbody": {
        "q": (8,), "qd": (8,), "der(qd)": (8,), "front.mode_shape": (4, 8),
        "rear.mode_shape": (4, 8),
    },
    "truck": {
        "q": (6,), "qd": (6,), "der(qd)": (6,), "spring": (6,), "friction": (6,), "slip": (6,),
        "strain_ratio": (6,),
        INDICATORS: (16,),
    },
    "truck_joints": {
        **dict.fromkeys(("q", "qd", "spring", "friction", "strain_ratio"), (6,)),
        **dict.fromkeys(("h", "hd", "der(hd)"), (14,)),
        **dict.fromkeys(("slip", "joint_strain", "joint_force"), (22,)),
        INDICATORS: (48,),
    },
    "wheelrail": {INDICATORS: (2,)},
    "track": {f"rail_{axis}_{side}": (4,) for axis in "yz" for side in ("left", "right")},
}  # fmt: skip


def array(instance, name):
    """All values of an array through one call, in its shape."""
    variable = next(v for v in instance.description.modelVariables if v.name == name)
    shape = [int(dimension.start) for dimension in variable.dimensions]
    values = instance.slave.getFloat64([variable.valueReference], int(np.prod(shape)))
    return np.array(values).reshape(shape)


@pytest.fixture
def instantiate3(instances):
    return lambda block, name="instance": instances(block, "3.0", name)


def test_arrays_are_where_the_physics_is_one(block_name):
    listed = read_model_description(str(fmu_path(block_name, "3.0"))).modelVariables
    found = {v.name: tuple(int(d.start) for d in v.dimensions) for v in listed if v.dimensions}
    assert found == EXPECTED[block_name]


def test_no_scalar_collides_with_an_element_of_an_array(block_name):
    listed = read_model_description(str(fmu_path(block_name, "3.0"))).modelVariables
    arrays = {v.name for v in listed if v.dimensions}
    assert not [v.name for v in listed if v.name.split("[")[0] in arrays and "[" in v.name]


def test_both_versions_agree_to_the_last_bit_on_every_port(instances, block_name):
    two, three = (instances(block_name, fmi).initialize() for fmi in ("2.0", "3.0"))
    assert two.names("output") == three.names("output")
    rows = [advance(each, 60, np.random.default_rng(4)) for each in (two, three)]
    assert np.array_equal(*rows)
    seed = scaled_inputs(two, np.random.default_rng(5))
    derivatives = [
        each.slave.getDirectionalDerivative(
            each.vr(*each.names("output")), each.vr(*seed), list(seed.values())
        )
        for each in (two, three)
    ]
    assert derivatives[0] == derivatives[1]


def test_rails_under_all_axles_are_the_axles_rails(instantiate3):
    track = instantiate3("track")
    track.slave.setInteger(track.vr("spectrum"), [2])
    track.initialize().set({"speed": 30.0})
    track.slave.doStep(0.0, 2.0)
    for name in EXPECTED["track"]:
        assert list(array(track, name)) == track.get(*(f"axle[{k}].{name}" for k in range(1, 5)))
        assert np.ptp(array(track, name)) > 0.0


def test_mode_shapes_turn_modal_coordinates_into_motion(instantiate3):
    carbody = instantiate3("carbody").initialize()
    advance(carbody, 40, np.random.default_rng(2))
    for end in ("front", "rear"):
        motion = array(carbody, f"{end}.mode_shape") @ array(carbody, "q")
        assert motion == pytest.approx(
            carbody.get(*(f"{end}.{name}" for name in ("y", "z", "roll", "yaw"))), rel=1e-12
        )


def test_a_heavier_body_moves_less_in_its_rigid_modes(instantiate3):
    carbody = instantiate3("carbody")
    light = array(carbody, "front.mode_shape")
    carbody.set({"body_mass": 4 * carbody.get("body_mass")[0]})
    heavy = array(carbody, "front.mode_shape")
    assert heavy[0, 0] == pytest.approx(light[0, 0] / 2, rel=1e-14)
    assert heavy[2, 2] == light[2, 2]


def test_derivatives_by_arrays_are_those_by_their_elements(instantiate3):
    truck = instantiate3("truck").initialize()
    advance(truck, 20, np.random.default_rng(3))
    q = next(v for v in truck.description.modelVariables if v.name == "q")
    rate = next(v for v in truck.description.modelVariables if v.name == "der(qd)")
    seed = np.arange(1.0, 7.0)
    together = truck.slave.getDirectionalDerivative(
        truck.vr("der(qd[2])", "der(qd[5])"), truck.vr(*(f"q[{i}]" for i in range(1, 7))), seed
    )
    base = super(type(truck.slave), truck.slave)
    whole = base.getDirectionalDerivative([rate.valueReference], [q.valueReference], seed, 6)
    assert [whole[1], whole[4]] == together
    columns = [
        base.getDirectionalDerivative([rate.valueReference], [q.valueReference], unit, 6)
        for unit in np.eye(6)
    ]
    assert whole == pytest.approx(list(np.transpose(columns) @ seed), rel=1e-12)


def test_adjoint_derivatives_are_the_transposed_ones(instantiate3, block_name):
    instance = instantiate3(block_name).initialize()
    rng = np.random.default_rng(6)
    advance(instance, 20, rng)
    inputs = instance.vr(*instance.names("input"))
    outputs = [v.valueReference for v in instance.description.modelVariables
               if v.causality == "output" and not v.dimensions]  # fmt: skip
    matrix = np.transpose(
        [instance.slave.getDirectionalDerivative(outputs, [known], [1.0]) for known in inputs]
    )
    seed = rng.uniform(-1, 1, len(outputs))
    adjoint = instance.slave.getAdjointDerivative(outputs, inputs, seed, len(inputs))
    scale = np.abs(matrix).max()
    assert np.allclose(adjoint, matrix.T @ seed, rtol=1e-12, atol=1e-13 * scale)


def test_a_count_that_does_not_fit_is_refused(instantiate3):
    carbody = instantiate3("carbody").initialize()
    q = next(v.valueReference for v in carbody.description.modelVariables if v.name == "q")
    for count in (1, 7, 9):
        with pytest.raises(FMICallException):
            carbody.slave.getFloat64([q], count)
        assert f"have 8 values in all, and the call brings {count}" in carbody.messages[-1]


def test_an_array_cannot_be_set(instantiate3):
    carbody = instantiate3("carbody").initialize()
    q = next(v.valueReference for v in carbody.description.modelVariables if v.name == "q")
    with pytest.raises(FMICallException):
        carbody.slave.setFloat64([q], [0.0] * 8)
    assert "is an output and cannot be set" in carbody.messages[-1]


def test_an_element_has_no_reference_of_its_own(instantiate3):
    carbody = instantiate3("carbody").initialize()
    listed = {v.valueReference for v in carbody.description.modelVariables}
    gaps = sorted(set(range(max(listed))) - listed)
    assert len(gaps) == 8 + 8 + 8 + 64
    for reference in (gaps[0], gaps[-1]):
        with pytest.raises(FMICallException):
            carbody.slave.getFloat64([reference])
        assert "it is an element of one" in carbody.messages[-1]


def test_mixed_units_of_an_array_are_in_its_description(block_name):
    for v in read_model_description(str(fmu_path(block_name, "3.0"))).modelVariables:
        if v.type == "Float64" and v.unit is None and v.name != INDICATORS:
            assert v.dimensions
            each = v.description.count("["), v.description.count("(rows ")
            (elements, *_) = (int(d.start) for d in v.dimensions)
            assert each in ((elements, 0), (0, 1)), v.name


def test_dependencies_element_by_element_are_those_of_the_scalars(instantiate3, block_name):
    instance = instantiate3(block_name).initialize()
    two = read_model_description(str(fmu_path(block_name)))
    expected = {
        unknown.variable.name: {v.name for v in unknown.dependencies}
        for unknown in (*two.outputs, *two.derivatives)
    }
    for v in instance.description.modelVariables:
        if v.causality != "output" and not v.name.startswith("der("):
            continue
        for name, needs in instance.dependencies(v).items():
            assert needs == expected[name], name


def test_initial_values_are_those_of_the_parameter_set(instantiate3):
    truck = instantiate3("truck")
    values = parameter_set("loaded").values(BLOCKS["truck"]())
    reals = [name for name in truck.names("parameter") if truck.variables[name].type == "Real"]
    assert truck.get(*reals) == [values[name] for name in reals]


def test_a_zero_step_in_arrays_changes_nothing(instantiate3, block_name):
    instance = instantiate3(block_name).initialize()
    advance(instance, 5, np.random.default_rng(2))
    names = [name for name in EXPECTED[block_name] if not name.startswith(INDICATORS)]
    before = [array(instance, name) for name in names]
    instance.slave.doStep(5 * STEP, 0.0)
    assert all(np.array_equal(b, array(instance, n)) for b, n in zip(before, names, strict=True))
