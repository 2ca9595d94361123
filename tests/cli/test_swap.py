"""`tracktrain run --swap`: another FMU in a block's place, and FMUs that cannot stand there."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path

import xarray as xr
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from tracktrain.cli import main


def run(*arguments: str, out: Path) -> tuple[int, str]:
    command = ["run", *arguments, "--duration", "5ms", "--quiet", "--out", str(out / "results")]
    result = CliRunner().invoke(main, command)
    assert "Traceback" not in result.output
    return result.exit_code, result.output


def variant(
    folder: Path, block: str, edit: Callable[[str], str] = str, binaries: bool = True
) -> Path:
    """A copy of a block's FMU with its model description edited."""
    path = folder / "variant.fmu"
    with zipfile.ZipFile(fmu_path(block)) as original, zipfile.ZipFile(path, "w") as copy:
        for name in original.namelist():
            content = original.read(name)
            if name == "modelDescription.xml":
                content = edit(content.decode()).encode()
            if binaries or not name.startswith("binaries/"):
                copy.writestr(name, content)
    return path


def test_a_copy_of_a_block_in_its_place_changes_nothing(tmp_path: Path) -> None:
    copy = shutil.copy(fmu_path("truck"), tmp_path / "my_truck.fmu")
    assert run("--swap", f"truck_rear={copy}", out=tmp_path / "swapped") == (0, "")
    assert run(out=tmp_path / "original") == (0, "")
    with (
        xr.open_dataset(tmp_path / "swapped/results/results.nc") as swapped,
        xr.open_dataset(tmp_path / "original/results/results.nc") as original,
    ):
        assert swapped.equals(original)


def test_missing_file_is_named(tmp_path: Path) -> None:
    code, message = run("--swap", "truck_rear=nowhere.fmu", out=tmp_path)
    assert code == 2
    assert "the FMU 'nowhere.fmu' cannot be read: no such file or directory" in message


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
