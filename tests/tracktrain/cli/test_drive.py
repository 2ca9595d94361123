"""Inputs that follow a table, on the command line."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from tracktrain.cli.main import main

RUN_DOWN = "time [s],speed [mph]\n0,70\n0.2,70\n0.5,40\n"


def invoke(*arguments):
    return CliRunner().invoke(main, [*arguments])


@pytest.fixture
def profile(tmp_path):
    path = tmp_path / "run_down.csv"
    path.write_text(RUN_DOWN)
    return path


def test_speed_profile_leads_the_car_for_as_long_as_it_goes(tmp_path, profile):
    out = tmp_path / "out"
    said = invoke("run", "--speed-profile", str(profile), "--out", str(out))
    assert said.exit_code == 0, said.output
    speed = xr.load_dataset(out / "results.nc")["track.speed_out"]
    assert float(speed.time[-1]) == pytest.approx(0.5)
    expected = 0.44704 * np.interp(speed.time, (0, 0.2, 0.5), (70, 70, 40))
    assert speed.values == pytest.approx(expected, rel=1e-12)


def test_an_exported_profile_runs_as_the_car_itself(tmp_path, profile):
    made = invoke("export", str(tmp_path / "car.ssp"), "--speed-profile", str(profile))
    assert made.exit_code == 0, made.output
    for arguments, name in (
        (["--speed-profile", str(profile)], "car"),
        ([str(tmp_path / "car.ssp")], "ssp"),
    ):
        said = invoke("run", *arguments, "--out", str(tmp_path / name), "--quiet")
        assert said.exit_code == 0, said.output
    car, ssp = (xr.load_dataset(tmp_path / name / "results.nc") for name in ("car", "ssp"))
    name = "truck_front.axle[1].y"
    assert np.array_equal(car[name], ssp[name])


def test_drive_takes_any_input_and_a_column(tmp_path):
    path = tmp_path / "many.csv"
    path.write_text("time [s],a [m/s],b [m/s]\n0,20,10\n1,20,10\n")
    out = tmp_path / "out"
    said = invoke(
        *("run", "--drive", f"track.speed={path}:b", "--duration", "20ms"),
        *("--out", str(out), "--quiet"),
    )
    assert said.exit_code == 0, said.output
    assert float(xr.load_dataset(out / "results.nc")["track.speed_out"][0]) == 10.0
    said = invoke("run", "--drive", f"track.speed={path}", "--out", str(out))
    assert said.exit_code != 0 and "no column 'track.speed'; choose one of: a, b" in said.output


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--speed", "60 ft/s"], "leave out --speed"),
        (["--duration", "2s"], "from 0 to 0.5 s"),
        (["--drive", "track.speed=none.csv"], "driven by the table none.csv"),
    ],
)
def test_what_contradicts_a_profile_is_refused(tmp_path, profile, arguments, message):
    said = invoke(
        "run", "--speed-profile", str(profile), *arguments, "--out", str(tmp_path / "out")
    )
    assert said.exit_code != 0
    assert "Traceback" not in said.output
    assert message.split(" table ")[0] in " ".join(said.output.split()) or "none.csv" in said.output
