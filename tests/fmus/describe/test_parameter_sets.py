"""Parameter sets: the numbers of the three cars in SI, and what the loader refuses."""

from __future__ import annotations

import math

import pytest

import tolerances
from fmus import BLOCKS, FmusError, ParameterError
from fmus.describe.parameters import FOLDER, NO_STOP, PARAMETER_SETS, TABLES, load, parameter_set
from fmus.describe.units import GAINS, parse, registry
from fmus.wheelrail.block import WheelRail

LBF, INCH, POUND = 4.4482216152605, 0.0254, 0.45359237


@pytest.mark.parametrize("name", PARAMETER_SETS)
@pytest.mark.parametrize("block", BLOCKS)
def test_every_set_has_a_finite_value_for_every_parameter(name, block):
    values = parameter_set(name).values(BLOCKS[block]())
    assert set(values) == {parameter.name for parameter in BLOCKS[block].parameters}
    assert all(math.isfinite(value) for value in values.values())


@pytest.mark.parametrize(
    ("block", "name", "expected"),
    [
        ("carbody", "body_mass", 201_000 * POUND),
        ("carbody", "roll_inertia", 9.0e5 * LBF * INCH),
        ("carbody", "gravity_centre_height", 58.25 * INCH),
        ("carbody", "torsion_frequency", 4.89),
        ("truck", "axle_load", 55_000 * LBF),
        ("truck", "wheelset_mass", 2650 * POUND),
        ("truck", "bolster_vertical.stiffness", 4.5e4 * LBF / INCH),
        ("truck", "bolster_roll.friction_limit", 2.73e5 * LBF * INCH),
        ("truck", "warp.friction_stiffness", 2.574e8 * LBF * INCH),
        ("truck", "warp.free_play", 0.00218),
        ("truck", "bolster_roll.free_play", NO_STOP),
        ("wheelrail", "lateral_creep_coefficient", 1.65e6 * LBF),
        ("wheelrail", "flange_stiffness", 1e5 * LBF / INCH),
    ],
)
def test_published_units_become_si_exactly(values_of, block, name, expected):
    assert values_of(block)[name] == pytest.approx(expected, rel=1e-14)


def test_the_empty_car_differs_from_the_loaded_one_where_it_should(values_of):
    differ = {
        name
        for block in ("carbody", "truck", "wheelrail")
        for name, value in values_of(block).items()
        if values_of(block, "empty")[name] != value
    }
    assert differ == {
        "body_mass",
        "roll_inertia",
        "pitch_inertia",
        "yaw_inertia",
        "gravity_centre_height",
        "torsion_frequency",
        "lateral_bending_frequency",
        "vertical_bending_frequency",
        "axle_load",
        "centre_plate_weight",
        "centre_plate_lateral.friction_limit",
        "centre_plate_yaw.friction_limit",
        "longitudinal_creep_coefficient",
        "lateral_creep_coefficient",
    }


def test_the_empty_cars_centre_plate_friction_scales_with_the_body_weight(values_of):
    weight = values_of("carbody", "empty")["body_mass"] / values_of("carbody")["body_mass"]
    for name in ("centre_plate_lateral.friction_limit", "centre_plate_yaw.friction_limit"):
        limits = (values_of("truck", car)[name] for car in ("empty", "loaded"))
        assert next(limits) == pytest.approx(weight * next(limits), rel=1e-12)


def test_report_linear_has_stiffer_creep_no_flange_and_a_plate_that_holds(values_of):
    linear = values_of("wheelrail", "report-linear")
    changed = {n: v for n, v in values_of("wheelrail").items() if linear[n] != v}
    assert set(changed) == {
        "longitudinal_creep_coefficient",
        "lateral_creep_coefficient",
        "flange_stiffness",
    }
    assert linear["flange_stiffness"] == 0.0
    assert linear["lateral_creep_coefficient"] == pytest.approx(2.5e6 * LBF, rel=1e-14)
    assert values_of("carbody", "report-linear") == values_of("carbody")
    bilateral = values_of("truck") | {"centre_plate_contact": 2.0}
    assert values_of("truck", "report-linear") == bilateral


def test_the_loads_on_the_rails_carry_the_car(values_of):
    """Body and trucks of 9500 lb weigh what the axles carry."""
    for car, on_rail in (("loaded", 220_000), ("empty", 60_000)):
        body = values_of("carbody", car)["body_mass"] / POUND
        axles = 4 * values_of("truck", car)["axle_load"] / LBF
        assert axles == pytest.approx(on_rail, rel=1e-12)
        assert body + 2 * 9500 == pytest.approx(on_rail, rel=1e-12)


def test_a_parameter_name_stands_in_one_table_only():
    entries = parameter_set("loaded").entries
    names = [name for table in TABLES for name in entries[table]]
    assert len(names) == len(set(names))


def test_every_entry_is_described_as_in_its_block():
    entries = parameter_set("loaded")
    for block in BLOCKS.values():
        for parameter in block.parameters:
            entry = entries.entry(parameter.name, block.name)
            if entry:
                assert entry.symbol == parameter.symbol, parameter.name
                assert len(entry.source) > 5, parameter.name


def test_an_entry_is_found_by_its_name():
    entry = parameter_set("empty").entry("body_mass")
    assert entry is not None
    assert (entry.value, entry.unit, entry.symbol) == (41_000, "lb", "m")
    assert entry.description == parameter_set("loaded").entry("body_mass").description
    assert parameter_set("loaded").entry("micro_step") is None


ENTRY = 'symbol = "c", basis = "estimate", source = "a guess", description = "Clearance"'
BROKEN = {
    "mu = 1": (
        "car.toml: [wheelrail] mu is a bare 1",
        "{ value = ..., unit = ..., symbol = ..., basis = ...",
    ),
    'mu = { value = 1, unit = "1", basis = "estimate" }': (
        "car.toml: [wheelrail] mu lacks symbol, source, description; add it",
    ),
    f'mu = {{ value = 1, {ENTRY}, unit = "" }}': ("[wheelrail] mu lacks unit",),
    f'mu = {{ value = 1, unit = "1", colour = "red", {ENTRY} }}': (
        "mu has the unknown field colour; the fields are value, unit, symbol",
    ),
    f'mu = {{ value = "much", unit = "1", {ENTRY} }}': ("the value 'much' is no number",),
    f'mu = {{ value = nan, unit = "1", {ENTRY} }}': ("the value nan is no number",),
    f'mu = {{ value = true, unit = "1", {ENTRY} }}': ("the value True is no number",),
    f'mu = {{ value = inf, unit = "1", {ENTRY} }}': ("only a free play may be inf",),
    f'mu = {{ value = 1, unit = "furlongs/lbz", {ENTRY} }}': (
        "the unit 'furlongs/lbz' is not known; write it like lbf*in/rad",
    ),
    f'mu = {{ value = 1, unit = "1", {ENTRY.replace("estimate", "rumour")} }}': (
        "the basis 'rumour' is not known; it is one of published, measured, derived",
    ),
}


def written(folder, text):
    path = folder / "car.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("line", BROKEN)
def test_a_broken_entry_is_refused_with_its_place(tmp_path, line):
    with pytest.raises(ParameterError) as error:
        load(written(tmp_path, f"[wheelrail]\n{line}\n"))
    for phrase in BROKEN[line]:
        assert phrase in str(error.value)


def refused(values_or_load, *phrases):
    with pytest.raises(ParameterError) as error:
        values_or_load()
    for phrase in phrases:
        assert phrase in str(error.value), str(error.value)


def extended(folder, table, line):
    return load(written(folder, f'extends = "loaded"\n[{table}]\n{line}\n'))


OVERRIDE = 'basis = "estimate", source = "a guess"'


def test_a_mass_where_a_force_belongs_is_refused(tmp_path):
    line = f'lateral_creep_coefficient = {{ value = 1e6, unit = "lb", {OVERRIDE} }}'
    car = extended(tmp_path, "wheelrail", line)
    refused(
        lambda: car.values(WheelRail()),
        "car.toml: lateral_creep_coefficient of the block 'wheelrail' is given in 'lb'",
        "[mass]",
        "give it in a unit of N",
        "lb is a mass, lbf a force",
    )


def test_a_value_out_of_range_is_refused(tmp_path):
    line = f'rolling_radius = {{ value = -16.5, unit = "in", {OVERRIDE} }}'
    car = extended(tmp_path, "wheelrail", line)
    refused(lambda: car.values(WheelRail()), "rolling_radius", "is -0.4191 m", "from 0.001 to any")


def test_a_gap_is_refused_with_the_table_to_fill(tmp_path):
    car = load(written(tmp_path, "[wheelrail]\n"))
    refused(
        lambda: car.values(WheelRail()),
        "car.toml: half_contact_spacing of the block 'wheelrail' has no value",
        "add it to [wheelrail], in a unit of m, or to [vehicle]",
    )


def test_a_name_that_the_block_does_not_know_is_refused(tmp_path):
    text = f'[wheelrail]\nstickiness = {{ value = 1, unit = "1", {ENTRY} }}\n'
    car = load(written(tmp_path, text))
    refused(
        lambda: car.values(WheelRail()),
        "[wheelrail] gives 'stickiness', which is no parameter of this block; it has "
        "adhesion_reduction",
    )


def test_an_override_of_what_is_not_there_is_refused(tmp_path):
    line = f'conicty = {{ value = 0.1, unit = "1", {OVERRIDE} }}'
    refused(
        lambda: extended(tmp_path, "wheelrail", line),
        "car.toml: [wheelrail] gives 'conicty', which loaded.toml lacks; correct the name",
        "conicity",
    )


def test_an_override_states_its_own_basis_and_source(tmp_path):
    line = 'conicity = { value = 0.1, unit = "1" }'
    refused(lambda: extended(tmp_path, "wheelrail", line), "conicity lacks basis, source")


def test_an_override_changes_its_parameter_alone(tmp_path):
    line = f'conicity = {{ value = 0.1, unit = "1", {OVERRIDE} }}'
    values = extended(tmp_path, "wheelrail", line).values(WheelRail())
    expected = parameter_set("loaded").values(WheelRail()) | {"conicity": 0.1}
    assert values == expected


def test_an_unknown_table_is_refused(tmp_path):
    refused(
        lambda: load(written(tmp_path, "[wheelrails]\n")),
        "car.toml: [wheelrails] is no table of a parameter set; there are vehicle, carbody",
    )


def test_an_unknown_set_is_refused_with_the_choice():
    refused(lambda: parameter_set("half-full"), "'half-full'", "loaded, empty, report-linear")


def test_a_set_cannot_extend_what_is_not_there(tmp_path):
    refused(
        lambda: load(written(tmp_path, 'extends = "ghost"\n')),
        "car.toml: extends 'ghost', which is neither a file beside it",
    )


def test_files_that_are_missing_or_no_toml_are_refused(tmp_path):
    refused(lambda: load(tmp_path / "none.toml"), "none.toml cannot be read: No such file")
    refused(lambda: load(written(tmp_path, "[wheelrail\n")), "car.toml is no TOML")


def test_options_that_no_file_gives_keep_the_blocks_default(values_of):
    values = values_of("truck")
    assert values["wedge_law"] == 1.0 and values["micro_step"] == 2.5e-4
    assert values["initial.yaw"] == 0.0


def test_an_error_of_the_loader_is_one_of_the_package():
    assert issubclass(ParameterError, FmusError)


def test_all_sets_ship_as_files():
    assert {path.stem for path in FOLDER.glob("*.toml")} == set(PARAMETER_SETS)


@pytest.mark.parametrize(("unit", "target"), GAINS)
def test_gains_of_the_shipped_sets_are_what_pint_says(unit, target):
    said = registry().Quantity(1.0, unit).to(parse(target)).magnitude
    assert GAINS[unit, target] == pytest.approx(said, rel=tolerances.ROUNDING)
