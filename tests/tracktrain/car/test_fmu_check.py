"""`tracktrain fmu check`: whether an FMU can stand in for a block, and what the car loses by it."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy
import pytest
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from orchestrator.plan.plan import make_plan
from support.variants import variant
from tracktrain.car.changes import swapped
from tracktrain.car.hopper import hopper_car
from tracktrain.car.stand_in import compare
from tracktrain.cli.main import main


def check(path: Path, block: str) -> tuple[int, str, str]:
    """Exit code, what stands above the verdict with single spaces, and the verdict."""
    result = CliRunner().invoke(main, ["fmu", "check", str(path), "--as", block])
    assert result.stderr == ""
    above, _, verdict = result.stdout.rstrip("\n").rpartition("\n")
    return result.exit_code, " ".join(above.split()), verdict


def with_unit(xml: str, port: str, unit: str) -> str:
    """The model description with another unit of one port."""
    before, name, after = xml.partition(f'name="{port}"')
    assert name
    return before + name + re.sub(r'unit="[^"]*"', f'unit="{unit}"', after, count=1)


def without(xml: str, pattern: str) -> str:
    """The model description without what matches."""
    changed = re.sub(pattern, "", xml)
    assert changed != xml
    return changed


@pytest.mark.parametrize("block", ["carbody", "truck", "wheelrail", "track"])
def test_each_block_stands_in_for_itself_without_loss(block: str) -> None:
    code, said, verdict = check(fmu_path(block), block)
    assert code == 0
    assert verdict == f"{block}.fmu can stand in for the block {block}."
    assert "(runs on this machine)" in said
    assert not {"missing", "unusable", "converted", "coupling", "effect"} & set(said.split())


def test_required_ports_are_those_that_the_car_connects() -> None:
    counts = {b: compare(fmu_path(b), b).required for b in ("carbody", "truck", "wheelrail")}
    assert counts == {"carbody": 24, "truck": 32, "wheelrail": 11}
    optional = compare(fmu_path("track"), "track").optional
    assert [name for name in optional if "rail_az" not in name] == ["speed", "distance"]
    assert len(optional) == 2 + 8  # the accelerations of the rails


def test_block_of_another_kind_lacks_every_port() -> None:
    code, said, verdict = check(fmu_path("track"), "carbody")
    assert code == 1
    assert "ports 0 of 24 required ones fit as they are" in said
    assert "missing inputs front.force_y [N], front.force_z [N]," in said
    assert "outputs front.y [m]," in said
    assert verdict == (
        "track.fmu cannot stand in for the block carbody: it lacks 24 required ports."
    )


def test_missing_port_is_named_with_one_that_looks_like_it(tmp_path: Path) -> None:
    path = variant(
        tmp_path, "wheelrail", lambda xml: xml.replace('name="load_left"', 'name="load_port_left"')
    )
    code, said, verdict = check(path, "wheelrail")
    assert code == 1
    assert "missing inputs load_left [N] (it has load_port_left)" in said
    assert "note inputs that nothing drives stay at their start: load_port_left" in said
    assert verdict == (
        "variant.fmu cannot stand in for the block wheelrail: it lacks 1 required port."
    )


def test_missing_optional_port_and_parameter_do_not_keep_it_out(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        return xml.replace('name="y_rel"', 'name="y_off"').replace('"conicity"', '"taper"')

    code, said, verdict = check(variant(tmp_path, "wheelrail", edit), "wheelrail")
    assert code == 0
    assert "optional 22 of 23; without y_rel" in said
    assert re.search(r"parameters (\d+) of (\d+); without conicity", said)
    assert verdict == "variant.fmu can stand in for the block wheelrail."


def test_units_are_converted_with_the_factor_of_their_direction(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        return with_unit(with_unit(xml, "axle[1].y", "mm"), "axle[1].force_y", "lbf")

    code, said, verdict = check(variant(tmp_path, "truck", edit), "truck")
    assert code == 0
    assert "ports 30 of 32 required ones fit as they are" in said
    assert "axle[1].y: mm -> m, times 0.001" in said
    assert "axle[1].force_y: N -> lbf, times 0.2248089431" in said
    assert verdict == ("variant.fmu can stand in for the block truck; 2 ports are converted.")


def test_unit_that_the_fmu_defines_itself_is_converted_with_its_offset(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        unit = '<Unit name="inch_up"><BaseUnit m="1" factor="0.0254" offset="1.0"/></Unit>'
        return with_unit(xml, "y", "inch_up").replace("</UnitDef", f"{unit}</UnitDef")

    # its signs are not those of a wheelset: the binary knows nothing of such a unit
    _, said, verdict = check(variant(tmp_path, "wheelrail", edit), "wheelrail")
    assert "y: m -> inch_up, times 39.37007874, minus 39.37007874" in said
    assert "wheelrail; 1 port is converted." in verdict


def test_port_without_a_unit_is_taken_to_be_in_the_blocks(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        before, name, after = xml.partition('name="vy"')
        return before + name + after.replace(' unit="m/s"', "", 1)

    code, said, _ = check(variant(tmp_path, "wheelrail", edit), "wheelrail")
    assert code == 0
    assert "unitless taken to be in the block's unit: vy [m/s]" in said


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            lambda xml: with_unit(xml, "force_y", "N.m"),
            "force_y is in N.m, which measures something else than N",
        ),
        (
            lambda xml: with_unit(xml, "force_y", "quux.x"),
            "force_y: 'quux.x' is not a known unit; define it in the FMU's UnitDefinitions",
        ),
        (
            lambda xml: re.sub(
                r'(name="load_left".*?causality=)"input" variability="continuous"',
                r'\1"parameter" variability="tunable"',
                xml,
                flags=re.S,
            ),
            "load_left is a parameter, not an input",
        ),
        (
            lambda xml: re.sub(
                r'(name="force_y".*?causality=)"output"(.*?)"calculated"',
                r'\1"input"\2"exact"',
                xml,
                count=1,
                flags=re.S,
            ),
            "force_y is an input, not an output",
        ),
        (
            lambda xml: re.sub(
                r'(name="yaw".*?variability=)"continuous">\s*<Real[^>]*>',
                r'\1"discrete"><Integer start="0"/>',
                xml,
                count=1,
                flags=re.S,
            ),
            "yaw is of type Integer; the port is of type Real",
        ),
    ],
)
def test_port_that_cannot_be_used_says_why(tmp_path: Path, edit, message: str) -> None:
    code, said, verdict = check(variant(tmp_path, "wheelrail", edit), "wheelrail")
    assert code == 1
    assert f"unusable {message}" in said
    assert verdict == (
        "variant.fmu cannot stand in for the block wheelrail: 1 port cannot be used."
    )


def test_inputs_that_cannot_move_cost_every_way_that_leads_them(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", lambda xml: without(xml, ' canInterpolateInputs="true"'))
    code, said, verdict = check(path, "truck")
    assert code == 0
    assert "coupling takes no input derivatives: its inputs are constant over each step" in said
    assert "mean instead of declared rate: truck_front.car.y, truck_front.car.z," in said
    assert "mean instead of tangent: truck_front.axle[1].force_y," in said
    assert "mean instead of known end: truck_front.axle[1].rail_z_left," in said
    assert verdict.endswith("for the block truck; the coupling is less accurate.")


def test_wheelset_without_directional_derivatives_gives_the_truck_no_tangent(
    tmp_path: Path,
) -> None:
    path = variant(
        tmp_path, "wheelrail", lambda xml: without(xml, ' providesDirectionalDerivative="true"')
    )
    code, said, _ = check(path, "wheelrail")
    assert code == 0
    assert "coupling gives no directional derivatives of force_y, moment_z" in said
    assert (
        "extrapolated instead of tangent: truck_front.axle[1].force_y, "
        "truck_front.axle[1].moment_z" in said
    )


def test_truck_without_tangents_has_its_axle_forces_led_otherwise(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", lambda xml: without(xml, r"<Tangent [^>]*>"))
    code, said, verdict = check(path, "truck")
    assert code == 0
    assert "takes no tangents of axle[1].force_y, axle[1].moment_z, axle[2].force_y," in said
    assert re.search(r"effect \S+( \S+)? instead of tangent: truck_front\.axle\[1\]", said)
    assert verdict.endswith("the coupling is less accurate.")


def test_rates_that_nothing_uses_are_no_loss_in_effect(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", lambda xml: without(xml, r' derivative="\d+"'))
    code, said, verdict = check(path, "truck")
    assert code == 0
    assert "declares no rates of axle[1].y, axle[1].yaw, axle[2].y, axle[2].yaw" in said
    assert "effect none: every input of the car is led as before" in said
    assert verdict == "variant.fmu can stand in for the block truck."


def test_carbody_without_rates_leaves_the_trucks_to_extrapolate(tmp_path: Path) -> None:
    path = variant(tmp_path, "carbody", lambda xml: without(xml, r' derivative="\d+"'))
    code, said, _ = check(path, "carbody")
    assert code == 0
    assert "declares no rates of front.roll, front.vy, front.vz, front.wx, front.wz," in said
    assert re.search(r"\w+ instead of declared rate: truck_front\.car\.y", said)


def test_undeclared_feedthrough_closes_a_loop(tmp_path: Path) -> None:
    path = variant(
        tmp_path,
        "truck",
        lambda xml: re.sub(r'(<Unknown index="\d+") dependencies="[^"]*"', r"\1", xml),
    )
    code, said, _ = check(path, "truck")
    assert code == 0
    assert "does not declare the feedthrough of axle[1].load_left, axle[1].load_right," in said
    assert "car.moment_z: taken to depend on all inputs" in said
    assert (
        "algebraic loop, solved in every step, through truck_front, wheelset_11, wheelset_12"
        in said
    )


def test_fmu_without_a_binary_cannot_stand_in_on_this_machine(tmp_path: Path) -> None:
    code, said, verdict = check(variant(tmp_path, "truck", binaries=False), "truck")
    assert code == 1
    assert "ports 32 of 32 required ones fit as they are" in said
    assert f"platforms none ({fmpy.platform} is needed)" in said
    assert verdict == (
        "variant.fmu cannot stand in for the block truck: it has no binary for this platform "
        f"({fmpy.platform}); it has none at all."
    )


def test_model_exchange_cannot_stand_in(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        return re.sub(
            r"<CoSimulation .*?</CoSimulation>",
            '<ModelExchange modelIdentifier="truck"/>',
            xml,
            flags=re.S,
        )

    code, _, verdict = check(variant(tmp_path, "truck", edit), "truck")
    assert code == 1
    assert verdict == (
        "variant.fmu cannot stand in for the block truck: it offers model exchange only; an FMU "
        "for co-simulation is needed."
    )


def test_version_that_cannot_be_coupled_is_said(tmp_path: Path) -> None:
    text = """<fmiModelDescription fmiVersion="1.0" modelName="a" modelIdentifier="a" guid="g"
     numberOfContinuousStates="0" numberOfEventIndicators="0"><ModelVariables/>
     </fmiModelDescription>"""
    code, _, verdict = check(variant(tmp_path, "track", lambda _: text), "track")
    assert code == 1
    assert verdict == (
        "variant.fmu cannot stand in for the block track: it lacks 17 required ports; it is an "
        "FMU of FMI 1.0; FMI 2.0 and 3.0 can be coupled."
    )


def test_array_is_no_port(tmp_path: Path) -> None:
    text = """<fmiModelDescription fmiVersion="3.0" modelName="a" instantiationToken="t">
    <CoSimulation modelIdentifier="a"/><ModelVariables>
    <Float64 name="speed_out" valueReference="1" causality="output" unit="m/s">
    <Dimension start="2"/><Dimension start="3"/></Float64></ModelVariables></fmiModelDescription>"""
    code, said, _ = check(variant(tmp_path, "track", lambda _: text), "track")
    assert code == 1
    assert "unusable speed_out is an array of 2 x 3; the port is one number" in said


def test_parameter_that_measures_something_else_cannot_take_the_cars_value(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", lambda xml: with_unit(xml, "wheelset_mass", "s"))
    code, _, verdict = check(path, "truck")
    assert code == 1
    assert verdict == (
        "variant.fmu cannot stand in for the block truck: it takes the car's values in other "
        "units: wheelset_mass [s instead of kg]."
    )


def test_parameter_in_another_unit_of_its_kind_is_converted(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", lambda xml: with_unit(xml, "wheelset_mass", "lb"))
    assert check(path, "truck")[0] == 0
    system, _ = swapped(hopper_car(), "truck_rear", path)
    plan = make_plan(system)
    given = {v.name: value for v, value in plan.values[plan.names.index("truck_rear")]}
    assert given["wheelset_mass"] == pytest.approx(2650, rel=1e-12)  # lb, as published


def test_value_of_the_car_outside_the_fmus_range_is_refused(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        before, name, after = xml.partition('name="wheelset_mass"')
        return before + name + re.sub(r'min="[^"]*"', 'min="1e9"', after, count=1)

    code, _, verdict = check(variant(tmp_path, "truck", edit), "truck")
    assert code == 1
    assert verdict.startswith(
        "variant.fmu cannot stand in for the block truck: the car refuses it: "
        "truck_front.wheelset_mass cannot be "
    )


def test_single_instance_and_a_needed_tool_are_noted(tmp_path: Path) -> None:
    def edit(xml: str) -> str:
        return xml.replace(
            'canBeInstantiatedOnlyOncePerProcess="false"',
            'canBeInstantiatedOnlyOncePerProcess="true" needsExecutionTool="true"',
        )

    code, said, _ = check(variant(tmp_path, "truck", edit), "truck")
    assert code == 0
    assert "note it can be instantiated only once in a process: for one of truck_front," in said
    assert "it needs the tool that made it on this machine" in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("a.fmu", "--as", "trcuk"),
            "there is no block 'trcuk'; did you mean truck or track? choose one of: "
            "carbody, truck, wheelrail, track",
        ),
        (("a.fmu",), "--as is missing; choose one of: carbody, truck, wheelrail, track"),
        (
            ("nowhere.fmu", "--as", "truck"),
            "the FMU 'nowhere.fmu' cannot be read: no such file or directory",
        ),
    ],
)
def test_nothing_to_check_is_bad_input(arguments: tuple[str, ...], message: str) -> None:
    result = CliRunner().invoke(main, ["fmu", "check", *arguments])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.strip().endswith(message)


MOVED = {
    "carbody": ("front.force_y", "rear.moment_x", "front.y", "rear.wz"),
    "truck": ("car.y", "car.roll", "axle[2].moment_z", "axle[1].rail_z_left", "car.force_z"),
    "wheelrail": ("y", "yaw", "vy", "wz", "rail_y_left", "force_y", "moment_z"),
}


@pytest.mark.parametrize(
    ("block", "port"), [(block, port) for block, ports in MOVED.items() for port in ports]
)
def test_port_whose_sign_is_turned_is_found(tmp_path: Path, block: str, port: str) -> None:
    turned = tmp_path / "turned.toml"
    turned.write_text(f'"{port}" = {{ name = "{port}", sign = -1 }}')
    command = ["fmu", "check", str(fmu_path(block)), "--as", block, "--map", str(turned)]
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 1
    said = " ".join(result.stdout.split())
    assert re.search(rf"signs .*{re.escape(port)}.* answer", said) or (
        re.search(rf"signs .* answers .*{re.escape(port)}", said)
    )
    assert "with the other sign than the block's: turn what is wrong" in said


def test_another_model_of_the_same_thing_has_its_signs() -> None:
    joints = compare(fmu_path("truck_joints"), "truck")
    assert joints.possible
    assert joints.opposed == []
