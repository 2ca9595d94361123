"""`--set` and `--initial`: what is taken, and what is refused with what there is to choose from."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner

from tracktrain.cli.main import main


def run(*arguments: str, out: Path) -> tuple[int, str]:
    command = ["run", *arguments, "--duration", "5ms", "--quiet", "--out", str(out)]
    result = CliRunner().invoke(main, command)
    assert "Traceback" not in result.output
    return result.exit_code, result.output


@pytest.mark.parametrize(
    ("option", "assignment", "message"),
    [
        ("--set", "truck_front.wheelset_mass=-5 kg", "cannot be -5 kg: it must be at least"),
        ("--set", "carbody.body_mass=nan kg", "carbody.body_mass cannot be nan: a finite number"),
        ("--set", "carbody.body_mass=inf kg", "carbody.body_mass cannot be inf: a finite number"),
        ("--set", "carbody.body_mass=5 kgg", "'kgg' is not a known unit; its unit is kg"),
        ("--set", "carbody.body_mass=5 m", "m cannot be converted to its unit, kg"),
        ("--set", "carbody.body_mas=5 kg", "has no variable 'body_mas'; did you mean body_mass?"),
        (
            "--set",
            "carbody.body_mass=201000",
            "carbody.body_mass cannot be '201000': the unit is missing; write it in kg or a unit "
            'that measures the same, as in "201000 kg"',
        ),
        ("--set", "wheelset_11.conicity=-0.1", "wheelset_11.conicity cannot be -0.1"),
        ("--set", "track.spectrum=fra9", "track.spectrum cannot be 'fra9'; write it like one of: "),
        ("--set", "track.seed=1.5", "track.seed cannot be 1.5: it is a whole number"),
        ("--set", "wheelset_11.speed=1 m/s", "it is driven by track.speed_out"),
        ("--set", "wheelset_11.force_y=1 N", "cannot be given a value: it is a continuous output"),
        (
            "--initial",
            "truck_front.ya=1 deg",
            "truck_front has no initial coordinate 'ya'; did you mean yaw or yaw_rate? choose one "
            "of: lateral, yaw, roll, warp, bolster_lateral, bolster_vertical",
        ),
        (
            "--initial",
            "wheelset_11.y=1 mm",
            "wheelset_11 has no initial coordinates; carbody, truck_front and truck_rear have",
        ),
        ("--initial", "truck_rear.yaw=1 mm", "mm cannot be converted to its unit, rad"),
        ("--initial", "carbody.yaw=1", "carbody.initial.yaw cannot be '1': the unit is missing"),
    ],
)
def test_value_that_does_not_fit_is_refused(
    option: str, assignment: str, message: str, tmp_path: Path
) -> None:
    code, output = run(option, assignment, out=tmp_path)
    assert code == 2
    assert message in output


@pytest.mark.parametrize("coordinate", ["lateral", "vertical", "roll", "yaw", "pitch"])
def test_carbody_starts_where_it_is_put(coordinate: str, tmp_path: Path) -> None:
    port = {"lateral": "y", "vertical": "z"}.get(coordinate, coordinate)
    value = "2 mm" if port in "yz" else "2 mrad"
    assert run("--initial", f"carbody.{coordinate}={value}", out=tmp_path) == (0, "")
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        start = dataset.isel(time=0)
        for name in ("y", "z", "roll", "pitch", "yaw"):
            expected = 2e-3 if name == port else 0.0
            assert start[f"carbody.cg.{name}"] == pytest.approx(expected, rel=1e-12)


def test_set_takes_a_parameter_in_any_unit_of_its_kind(tmp_path: Path) -> None:
    """The contact forces of a lifted carbody accelerate half the mass twice as much."""
    lifted = ("--initial", "carbody.vertical=1 mm")
    acceleration = {}
    for name, mass in (("100 klb", "100000 lb"), ("50 klb", "22.6796185 t")):
        change = ("--set", f"carbody.body_mass={mass}")
        assert run(*lifted, *change, out=tmp_path / name) == (0, "")
        with xr.open_dataset(tmp_path / name / "results.nc") as dataset:
            acceleration[name] = float(dataset["carbody.cg.az"][0])
    assert acceleration["50 klb"] < -1.0
    assert acceleration["50 klb"] / acceleration["100 klb"] == pytest.approx(2.0, rel=1e-9)


def test_zero_needs_no_unit(tmp_path: Path) -> None:
    assert run("--initial", "truck_front.yaw=0", out=tmp_path) == (0, "")


def test_seed_and_spectrum_are_the_tracks_own_parameters(tmp_path: Path) -> None:
    assert run("--track", "fra4", "--seed", "7", out=tmp_path / "options") == (0, "")
    settings = ("--set", "track.spectrum=fra4", "--set", "track.seed=7")
    assert run(*settings, out=tmp_path / "settings") == (0, "")
    with (
        xr.open_dataset(tmp_path / "options/results.nc") as options,
        xr.open_dataset(tmp_path / "settings/results.nc") as settings_,
    ):
        assert options.equals(settings_)
