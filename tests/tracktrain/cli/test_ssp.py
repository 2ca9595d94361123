"""`tracktrain export` and `tracktrain run FILE`: the hopper car as a file of the standard SSP."""

from __future__ import annotations

import zipfile
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from tracktrain.car.hopper import HOPPER
from tracktrain.cli.commands import run as command
from tracktrain.cli.main import main

SHAPE = (
    *("--car", "empty", "--speed", "80 ft/s", "--track", "fra4", "--seed", "3"),
    *("--set", "truck_front.bolster_lateral.friction_limit=3000 lbf"),
    *("--initial", "truck_rear.yaw=0.01 deg", "--duration", "50ms", "--step", "0.5ms"),
)


def tracktrain(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(main, arguments)
    assert "Traceback" not in result.output
    return result.exit_code, " ".join(result.output.split())


@pytest.fixture(scope="module")
def archive(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("export") / "hopper.ssp"
    code, said = tracktrain("export", str(path), *SHAPE)
    assert (code, said.startswith(str(path))) == (0, True)
    return path


def results(folder: Path) -> xr.Dataset:
    with xr.open_dataset(folder / "results.nc") as opened:
        return opened.load()


def test_exported_car_runs_to_the_last_bit_as_the_car_itself(archive, tmp_path):
    from_file, direct = tmp_path / "file", tmp_path / "direct"
    assert tracktrain("run", str(archive), "--quiet", "--out", str(from_file)) == (0, "")
    assert tracktrain("run", *SHAPE, "--quiet", "--out", str(direct)) == (0, "")
    assert len(results(direct).time) == 101
    assert results(from_file).equals(results(direct))
    assert (from_file / "displacement.png").exists()


def test_archive_holds_the_fmus_once_and_the_values_in_their_units(archive):
    with zipfile.ZipFile(archive) as opened:
        members = opened.namelist()
        values = opened.read("resources/truck_front.ssv").decode()
        experiment = opened.read("SystemStructure.ssd").decode()
    assert members[0] == "SystemStructure.ssd"
    assert [m for m in members if m.endswith(".fmu")] == [
        f"resources/{block}.fmu" for block in ("carbody", "truck", "wheelrail", "track")
    ]
    assert '<ssv:Real value="3000" unit="lbf" />' in values
    assert '<ssd:DefaultExperiment startTime="0.0" stopTime="0.05">' in experiment
    assert 'baseStepSize="0.0005"' in experiment


def test_swapped_fmu_goes_along(tmp_path):
    own = tmp_path / "my_wheelset.fmu"
    own.write_bytes(fmu_path("wheelrail").read_bytes())
    path = tmp_path / "swapped.ssp"
    assert tracktrain("export", str(path), "--swap", f"wheelset_12={own}")[0] == 0
    with zipfile.ZipFile(path) as opened:
        assert "resources/my_wheelset.fmu" in opened.namelist()


def test_car_of_fmi_3_blocks_goes_through_ssp_2_to_the_last_bit(tmp_path):
    swaps = [f"{name}={fmu_path(block, '3.0')}" for name, block in HOPPER.blocks.items()]
    shape = [*(part for swap in swaps for part in ("--swap", swap)), "--duration", "50ms"]
    path, direct, from_file = tmp_path / "three.ssp", tmp_path / "direct", tmp_path / "file"
    assert tracktrain("export", str(path), *shape)[0] == 0
    with zipfile.ZipFile(path) as opened:
        written = opened.read("SystemStructure.ssd").decode()
    assert '<ssd:SystemStructureDescription version="2.0"' in written
    assert '<ssc:Float64 unit="N" />' in written
    assert tracktrain("run", str(path), "--quiet", "--out", str(from_file)) == (0, "")
    assert tracktrain("run", *shape, "--quiet", "--out", str(direct)) == (0, "")
    assert results(from_file).equals(results(direct))


def test_options_change_what_the_file_says(archive, tmp_path):
    out = tmp_path / "out"
    change = ("--set", "track.seed=9", "--swap", f"track={fmu_path('track')}")
    code, said = tracktrain(
        "run", str(archive), *change, "--duration", "10ms", "--step", "1ms", "--out", str(out)
    )
    assert code == 0, said
    changed = results(out)
    assert len(changed.time) == 11
    assert '"track.seed": 9' in changed.attrs["parameters"]
    assert "leading axle" in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--car", "empty"), "the car is the one that '{file}' describes; leave out --car"),
        (
            ("--seed", "2", "--initial", "truck_rear.yaw=1 deg"),
            "the car is the one that '{file}' describes; leave out --seed and --initial",
        ),
        (("--ssd", "other"), "'{file}' has no variant 'other'; choose one of: SystemStructure.ssd"),
        (("--set", "truk.mass=3"), "there is no instance 'truk'; did you mean track?"),
        (("--swap", "truk=a.fmu"), "there is no instance 'truk'; did you mean track?"),
        (("--step", "1s"), "a step of 1 s is longer than the run of 0.05 s; "),
        (("--set", "track.speed=20"), "track.speed cannot be '20': the unit is missing; "),
    ],
)
def test_options_that_do_not_go_with_the_file(archive, arguments, message):
    code, said = tracktrain("run", str(archive), *arguments)
    assert code == 2
    assert message.format(file=archive) in said


def test_other_mistakes(archive, tmp_path):
    for arguments, message in (
        (("run", "none.ssp"), "the system 'none.ssp' cannot be read: no such file or directory"),
        (("run", "--ssd", "x"), "there is no file to choose a system of; leave out --ssd"),
        (
            ("export", "hopper.zip"),
            "'hopper.zip' is no name for an archive or an FMU; it must end in .ssp or .fmu",
        ),
        (("export", str(archive / "a.ssp")), "a.ssp' cannot be written (not a directory)"),
        (("export", "a.ssp", "--standard", "3"), "there is no version of SSP '3'; "),
    ):
        code, said = tracktrain(*arguments)
        assert code == 2
        assert message in said


def test_system_that_is_no_hopper_car_is_summed_up_by_its_outputs(tmp_path):
    (tmp_path / "track.fmu").write_bytes(fmu_path("track").read_bytes())
    (tmp_path / "rails.ssd").write_text(
        '<ssd:SystemStructureDescription version="1.0" name="rails" '
        'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription">'
        '<ssd:System name="rails"><ssd:Elements><ssd:Component name="rails" source="track.fmu"/>'
        "</ssd:Elements></ssd:System></ssd:SystemStructureDescription>"
    )
    file, out = str(tmp_path / "rails.ssd"), str(tmp_path / "out")
    code, said = tracktrain("run", file, "--out", out)
    assert (code, said) == (2, f"Error: '{file}' does not say how long to run; give --duration")
    code, said = tracktrain("run", file, "--duration", "10ms", "--out", out)
    assert code == 0
    assert "first 12 outputs" in said
    assert "rails.distance m" in said


def test_run_of_an_archive_goes_on_from_its_checkpoint(archive, tmp_path, monkeypatch):
    """The FMUs wait beside it, so that the archive may be gone; at the end they go, too."""
    own, out = tmp_path / "own.ssp", tmp_path / "out"
    own.write_bytes(archive.read_bytes())

    @contextmanager
    def stopping(*_: object):
        def progress(time: float, _: float) -> None:
            if time > 0.03:
                raise KeyboardInterrupt

        yield (lambda name: None), progress

    with monkeypatch.context() as patch:
        patch.setattr(command, "_progress", stopping)
        keeping = ("--checkpoint", "10ms", "--duration", "4s", "--quiet", "--out", str(out))
        code, said = tracktrain("run", str(own), *keeping)
    assert (code, f"go on with --resume {out}" in said) == (1, True)
    own.unlink()
    assert [*(out / "checkpoint-fmus").rglob("truck.fmu")]
    assert tracktrain("run", "--resume", str(out), "--quiet") == (0, "")
    assert float(results(out).time[-1]) == 4.0
    assert not (out / "checkpoint-fmus").exists()
