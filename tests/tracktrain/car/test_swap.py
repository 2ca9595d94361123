"""`tracktrain run --swap`: another FMU in a block's place, and FMUs that cannot stand there."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner

import tolerances
from fmus.catalogue import fmu_path
from support.variants import variant
from tracktrain.car.hopper import HOPPER
from tracktrain.cli.main import main

POSITIONS = ("y", "z", "roll", "yaw")
REPORT = ("--speed", "60 ft/s", "--track", "report")
MOTIONS = (*POSITIONS, "vy", "vz", "wx", "wz")


def run(*arguments: str, out: Path, duration: str = "5ms") -> tuple[int, str]:
    command = ["run", *REPORT, *arguments, "--duration", duration, "--quiet"]
    command += ["--out", str(out / "results")]
    result = CliRunner().invoke(main, command)
    assert "Traceback" not in result.output
    return result.exit_code, result.output


def test_a_copy_of_a_block_in_its_place_changes_nothing(tmp_path: Path) -> None:
    copy = shutil.copy(fmu_path("truck"), tmp_path / "my_truck.fmu")
    assert run("--swap", f"truck_rear={copy}", out=tmp_path / "swapped") == (0, "")
    assert run(out=tmp_path / "original") == (0, "")
    with (
        xr.open_dataset(tmp_path / "swapped/results/results.nc") as swapped,
        xr.open_dataset(tmp_path / "original/results/results.nc") as original,
    ):
        assert swapped.equals(original)


@pytest.mark.parametrize(
    "instance", ["carbody", "truck_front", "wheelset_11", "track"], ids=lambda name: name
)
def test_an_fmu_that_says_no_units_is_taken_to_be_in_those_of_the_block(
    tmp_path: Path, instance: str
) -> None:
    block = HOPPER.blocks[instance]
    bare = variant(tmp_path, block, lambda xml: re.sub(r' unit="[^"]*"', "", xml))
    assert run("--swap", f"{instance}={bare}", out=tmp_path / "bare") == (0, "")
    assert run(out=tmp_path / "own") == (0, "")
    with (
        xr.open_dataset(tmp_path / "bare/results/results.nc") as swapped,
        xr.open_dataset(tmp_path / "own/results/results.nc") as own,
    ):
        assert all((swapped[name].values == own[name].values).all() for name in own)
        assert all(swapped[name].units == own[name].units for name in own)
        assert f"{bare} as {instance} says no units of " in swapped.notes


def test_a_wheelset_on_profiles_stands_in_for_one_on_cones(tmp_path: Path) -> None:
    profiled = tmp_path / "worn.fmu"
    built = CliRunner().invoke(main, ["profile", "build", "worn", "crown", "-o", str(profiled)])
    assert built.exit_code == 0, built.output
    assert run("--swap", f"wheelset_11={profiled}", out=tmp_path) == (0, "")


def test_missing_file_is_named(tmp_path: Path) -> None:
    code, message = run("--swap", "truck_rear=nowhere.fmu", out=tmp_path)
    assert code == 2
    assert "the FMU 'nowhere.fmu' cannot be read: no such file or directory" in message


def test_a_block_stands_in_by_its_name_and_a_wrong_name_is_told_the_blocks(tmp_path: Path) -> None:
    assert run("--swap", "truck_rear=truck", out=tmp_path) == (0, "")
    code, message = run("--swap", "truck_rear=truck_joint", out=tmp_path)
    assert code == 2
    assert (
        "'truck_joint' is neither a file nor one of our blocks; did you mean truck_joints? "
        "choose one of: carbody, truck, wheelrail, track" in message
    )


def test_a_folder_of_the_name_of_a_block_is_not_in_its_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "truck").mkdir()
    assert run("--swap", "truck_rear=truck", out=tmp_path) == (0, "")


def test_file_that_is_no_zip_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "text.fmu"
    path.write_text("not an archive")
    code, message = run("--swap", f"truck_rear={path}", out=tmp_path)
    assert code == 2
    assert f"'{path}' is no FMU: it is not a zip archive" in message


def test_fmu_without_a_binary_for_this_platform_is_refused(tmp_path: Path) -> None:
    path = variant(tmp_path, "truck", binaries=False)
    code, message = run("--swap", f"truck_rear={path}", out=tmp_path)
    assert code == 2
    assert f"'{path}' has no binary for this platform (" in message


def test_fmu_of_fmi_1_is_refused(tmp_path: Path) -> None:
    path = variant(
        tmp_path, "truck", lambda xml: xml.replace('fmiVersion="2.0"', 'fmiVersion="1.0"')
    )
    code, message = run("--swap", f"truck_rear={path}", out=tmp_path)
    assert code == 2
    assert f"'{path}' is an FMU of FMI 1.0; FMI 2.0 and 3.0 can be coupled" in message


def test_fmu_that_lacks_ports_is_refused_with_the_ports_it_lacks(tmp_path: Path) -> None:
    path = variant(
        tmp_path, "wheelrail", lambda xml: xml.replace('name="load_left"', 'name="load_port"')
    )
    code, message = run("--swap", f"wheelset_12={path}", out=tmp_path)
    assert code == 2
    assert (
        f"'{path}' cannot stand in for wheelset_12: it lacks the ports load_left; "
        "give an FMU with all ports of the block 'wheelrail'"
    ) in message


def test_block_of_another_kind_has_none_of_the_ports(tmp_path: Path) -> None:
    code, message = run("--swap", f"carbody={fmu_path('track')}", out=tmp_path)
    assert code == 2
    assert "cannot stand in for carbody: it lacks the ports front.ay" not in message
    assert "cannot stand in for carbody: it lacks the ports front.force_y, front.force_z" in message


def test_port_in_a_unit_that_measures_something_else_is_refused(tmp_path: Path) -> None:
    def in_newton_metres(xml: str) -> str:
        before, name, after = xml.partition('name="force_y"')
        return before + name + after.replace('unit="N"', 'unit="N.m"', 1)

    path = variant(tmp_path, "wheelrail", in_newton_metres)
    code, message = run("--swap", f"wheelset_11={path}", out=tmp_path)
    assert code == 2
    assert "truck_front.axle[1].force_y [N]" in message
    assert "wheelset_11.force_y [N.m]" in message


def test_parameters_that_the_other_fmu_lacks_are_listed(tmp_path: Path) -> None:
    path = variant(
        tmp_path, "wheelrail", lambda xml: xml.replace('name="conicity"', 'name="taper"')
    )
    swap = ["--swap", f"wheelset_11={path}", "--duration", "5ms", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, ["run", *swap])
    assert result.exit_code == 0
    assert "as wheelset_11 lacks the parameters conicity" in " ".join(result.stdout.split())


MIRROR = """
y = { name = "y", sign = -1 }
yaw = { name = "yaw", sign = -1 }
vy = { name = "vy", sign = -1 }
wz = { name = "wz", sign = -1 }
force_y = { name = "force_y", sign = -1 }
moment_z = { name = "moment_z", sign = -1 }
load_left = "load_right"
load_right = "load_left"
rail_y_left = { name = "rail_y_right", sign = -1 }
rail_y_right = { name = "rail_y_left", sign = -1 }
"""


def results(folder: Path) -> xr.Dataset:
    return xr.load_dataset(folder / "results/results.nc")


def test_wheelset_seen_in_a_mirror_runs_as_before(tmp_path: Path) -> None:
    """A wheelset is symmetric: with signs turned and sides exchanged it is the same one."""
    path = tmp_path / "mirror.toml"
    path.write_text(MIRROR)
    swap = ("--swap", f"wheelset_11={fmu_path('wheelrail')}", "--map", f"wheelset_11={path}")
    assert run(*swap, out=tmp_path / "mirrored", duration="0.2s")[0] == 0
    assert run(out=tmp_path / "original", duration="0.2s")[0] == 0
    mirrored, original = results(tmp_path / "mirrored"), results(tmp_path / "original")
    for name in ("wheelset_11.force_y", "truck_front.axle[1].y", "carbody.cg.ay"):
        scale = float(abs(original[name]).max())
        assert float(abs(mirrored[name] - original[name]).max()) < tolerances.ROUNDING * scale


def test_velocities_that_a_foreign_carbody_does_not_give_are_differentiated(tmp_path: Path) -> None:
    """A carbody that gives positions alone, in its own words; the car moves nearly as before."""
    names = {f"{end}.{port}": f"{end}_{port}" for end in ("front", "rear") for port in MOTIONS}

    def renamed(xml: str) -> str:
        for name, other in names.items():
            xml = xml.replace(f'name="{name}"', f'name="{other}"')
        return xml

    given = {name: other for name, other in names.items() if name.partition(".")[2] in POSITIONS}
    path = tmp_path / "carbody.toml"
    path.write_text("".join(f'"{name}" = "{other}"\n' for name, other in given.items()))
    swap = ["--swap", f"carbody={variant(tmp_path, 'carbody', renamed)}"]
    swap += ["--map", f"carbody={path}"]
    where = ["--duration", "0.5s", "--out", str(tmp_path / "foreign/results")]
    result = CliRunner().invoke(main, ["run", *REPORT, *swap, *where])
    said = " ".join(result.output.split())
    assert result.exit_code == 0, said
    assert "front.vy, front.vz, front.wx, front.wz, rear.vy" in said
    assert "differentiated from front.y, front.z, front.roll, front.yaw, rear.y" in said
    assert run(out=tmp_path / "original", duration="0.5s")[0] == 0
    foreign, original = results(tmp_path / "foreign"), results(tmp_path / "original")
    for name in ("carbody.front.y", "truck_front.axle[1].y"):
        error = float(abs(foreign[name] - original[name]).max() / abs(original[name]).max())
        assert 0.0 < error < tolerances.DIFFERENTIATED_VELOCITY


def test_map_for_an_instance_that_is_not_swapped(tmp_path: Path) -> None:
    code, message = run("--map", "truck_rear=map.toml", out=tmp_path)
    assert code == 2
    assert (
        "the map 'map.toml' is for truck_rear, which no --swap replaces; add --swap truck_rear=FMU"
    ) in message


def test_check_takes_the_map_into_account(tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    path.write_text('load_left = "load_port"')
    fmu = variant(
        tmp_path, "wheelrail", lambda xml: xml.replace('name="load_left"', 'name="load_port"')
    )
    command = ["fmu", "check", str(fmu), "--as", "wheelrail"]
    assert CliRunner().invoke(main, command).exit_code == 1
    result = CliRunner().invoke(main, [*command, "--map", str(path)])
    assert result.exit_code == 0
    assert "load_left is load_port" in result.output
