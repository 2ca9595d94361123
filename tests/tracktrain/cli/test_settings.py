"""`--set` and `--initial`: what is taken, and what is refused with what there is to choose from."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import xarray as xr
from click.testing import CliRunner

from fmus.wheelrail.block import CREEP_LAWS
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
        ("--set", "wheel?.conicity=0.1", "no instance fits 'wheel?'; choose one of: carbody,"),
        (
            "--set",
            "wheelset_*.conicty=0.1",
            "no instance that fits 'wheelset_*' has a parameter 'conicty'; did you mean conicity?",
        ),
        ("--set", "wheelset_*.conicity=-0.1", "wheelset_11.conicity cannot be -0.1"),
        ("--initial", "truck_*.yaw=1 deg", "there is no instance 'truck_*'; did you mean truck_"),
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


def parameters(folder: Path) -> dict[str, object]:
    with xr.open_dataset(folder / "results.nc") as dataset:
        return json.loads(dataset.attrs["parameters"])


def test_a_pattern_sets_all_that_fit_and_have_it_and_a_full_name_stands_above_it(tmp_path: Path):
    given = ("--set", "wheelset_12.conicity=0.2", "--set", "wheelset_*.conicity=0.1")
    everywhere = ("--set", "*.creep_law=polach")
    assert run(*given, *everywhere, out=tmp_path) == (0, "")
    found = parameters(tmp_path)
    of_axles = {f"wheelset_{n}": found[f"wheelset_{n}.conicity"] for n in (11, 12, 21, 22)}
    expected = {"wheelset_11": 0.1, "wheelset_12": 0.2, "wheelset_21": 0.1, "wheelset_22": 0.1}
    assert of_axles == expected
    assert {found[f"{name}.creep_law"] for name in expected} == {1 + CREEP_LAWS.index("polach")}


def test_two_patterns_that_say_unlike_things_of_one_are_refused(tmp_path: Path):
    given = ("--set", "wheelset_*.conicity=0.1", "--set", "wheelset_1?.conicity=0.2")
    code, output = run(*given, out=tmp_path)
    assert code == 2
    assert "wheelset_11.conicity is '0.1' by 'wheelset_*' and '0.2' by 'wheelset_1?'" in output


def test_a_pattern_sets_the_instances_of_a_file_and_is_kept_in_a_file_of_options(tmp_path: Path):
    car, options, direct = tmp_path / "car.ssp", tmp_path / "run.toml", tmp_path / "direct"
    assert CliRunner().invoke(main, ["export", str(car), "--duration", "5ms"]).exit_code == 0
    given = ("--set", "wheelset_*.conicity=0.1")
    assert run(str(car), *given, "--save", str(options), out=direct) == (0, "")
    assert '"wheelset_*.conicity" = "0.1"' in options.read_text()
    assert run(str(options), out=tmp_path / "again") == (0, "")
    assert parameters(direct)["wheelset_22.conicity"] == 0.1
    assert parameters(tmp_path / "again") == parameters(direct)
    code, output = run(str(car), "--set", "axle?.conicity=0.1", out=direct)
    assert code == 2
    assert "no instance fits 'axle?'" in output


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
