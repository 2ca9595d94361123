"""`tracktrain run` on the hopper car: what it writes, prints, and keeps when it stops."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result
from matplotlib.image import imread

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from tracktrain.car.hopper import HOPPER
from tracktrain.cli.main import main

PICTURES = ("lateral_force.png", "displacement.png", "track.png", "carbody.png")

MOTION = {"y": "m", "z": "m", "roll": "rad", "yaw": "rad"}
RATE = {"vy": "m/s", "vz": "m/s", "wx": "rad/s", "wz": "rad/s"}
FORCE = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
WHEEL = {"force_x": "N", "force_y": "N", "creep_x": "1", "creep_y": "1", "l_over_v": "1"}


def port_table() -> dict[str, str]:
    """Unit of each output of physics.md section 2."""
    units = {"track.distance": "m", "track.speed_out": "m/s"}
    for end in ("front", "rear"):
        at_centre_plate = {**MOTION, **RATE, "ay": "m/s2", "az": "m/s2"}
        units |= {f"carbody.{end}.{name}": unit for name, unit in at_centre_plate.items()}
        units |= {f"truck_{end}.car.{name}": unit for name, unit in FORCE.items()}
        for axle in (1, 2):
            at_axle = {"y": "m", "yaw": "rad", "vy": "m/s", "wz": "rad/s"}
            at_axle |= {"load_left": "N", "load_right": "N"}
            units |= {f"truck_{end}.axle[{axle}].{name}": unit for name, unit in at_axle.items()}
        coordinates = ("m", "rad", "rad", "rad", "m", "m")
        pulls = ("N", "N.m", "N.m", "N", "N", "N.m")
        for i, (length, pull) in enumerate(zip(coordinates, pulls, strict=True), start=1):
            units |= {f"truck_{end}.q[{i}]": length, f"truck_{end}.qd[{i}]": f"{length}/s"}
            units |= {f"truck_{end}.spring[{i}]": pull, f"truck_{end}.friction[{i}]": pull}
    cg = {"y": "m", "z": "m", "roll": "rad", "pitch": "rad", "yaw": "rad", "ay": "m/s2"}
    units |= {f"carbody.cg.{name}": unit for name, unit in {**cg, "az": "m/s2"}.items()}
    for wheelset in ("wheelset_11", "wheelset_12", "wheelset_21", "wheelset_22"):
        units |= {f"{wheelset}.force_y": "N", f"{wheelset}.moment_z": "N.m"}
        units |= {f"{wheelset}.y_rel": "m"}
        for side in ("left", "right"):
            units |= {f"{wheelset}.{side}.{name}": unit for name, unit in WHEEL.items()}
    for axle in (1, 2, 3, 4):
        for direction in ("y", "z"):
            for side in ("left", "right"):
                units[f"track.axle[{axle}].rail_{direction}_{side}"] = "m"
    return units


def run(*arguments: str) -> Result:
    result = CliRunner().invoke(main, ["run", *arguments])
    assert "Traceback" not in result.output
    return result


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Result]:
    """Half a second of the car, at the report's lowest speed."""
    folder = tmp_path_factory.mktemp("run") / "results"
    result = run(
        "--duration", "0.5s", "--speed", "60 ft/s", "--track", "report", "--out", str(folder)
    )
    assert result.exit_code == 0, result.output
    return folder, result


@pytest.fixture(scope="module")
def dataset(finished: tuple[Path, Result]) -> xr.Dataset:
    with xr.open_dataset(finished[0] / "results.nc") as opened:
        return opened.load()


def test_results_hold_every_output_of_the_port_table_in_its_unit(dataset: xr.Dataset) -> None:
    expected = port_table()
    found = {n: dataset[n].attrs["units"] for n in expected if n in dataset}
    assert found == expected


def test_results_hold_every_output_and_the_inputs_that_nothing_drives(dataset: xr.Dataset) -> None:
    outputs = {
        f"{instance}.{port.name}"
        for instance, block in HOPPER.blocks.items()
        for port in BLOCKS[block].outputs
    }
    inputs = {
        f"{instance}.{port.name}"
        for instance, block in HOPPER.blocks.items()
        for port in BLOCKS[block].inputs
        if "_per_" not in port.name  # partial derivatives, which masters give
    }
    driven = {c.target for c in (*HOPPER.connections(), *HOPPER.optional_connections())}
    assert set(dataset.data_vars) == outputs | inputs - driven
    assert {"track.speed", "wheelset_11.torque"} <= inputs - driven


def test_results_hold_every_macro_step(dataset: xr.Dataset) -> None:
    assert dataset["time"].attrs["units"] == "s"
    np.testing.assert_array_equal(dataset["time"].values, np.arange(501) * 1e-3)


def test_results_say_where_they_come_from(dataset: xr.Dataset) -> None:
    assert dataset.attrs["command"].startswith("tracktrain run --duration 0.5s --speed ")
    parameters = json.loads(dataset.attrs["parameters"])
    assert parameters["carbody.body_mass"] == pytest.approx(201_000 * 0.45359237)
    for instance, block in HOPPER.blocks.items():
        digest = hashlib.sha256(fmu_path(block).read_bytes()).hexdigest()
        assert json.loads(dataset.attrs["fmus"])[instance]["sha256"] == digest


def test_car_runs_at_the_speed_that_was_asked_for(dataset: xr.Dataset) -> None:
    np.testing.assert_allclose(dataset["track.distance"], 18.288 * dataset["time"], atol=1e-9)


def test_rear_truck_meets_the_irregularities_of_the_front_one_later(dataset: xr.Dataset) -> None:
    """The trailing axle of a truck runs 68 in behind the leading one."""
    delay = 2 * 34 * 0.0254 / 18.288
    time = dataset["time"].values
    leading, trailing = (dataset[f"track.axle[{k}].rail_y_left"].values for k in (1, 2))
    late = time > 0.3  # beyond the fade-in
    seen = np.interp(time[late] - delay, time, leading)
    assert np.max(np.abs(leading)) > 1e-4
    np.testing.assert_allclose(trailing[late], seen, atol=0.02 * np.max(np.abs(leading)))


def test_pictures_have_curves_in_them(finished: tuple[Path, Result]) -> None:
    for name in PICTURES:
        image = imread(finished[0] / name)[..., :3]
        assert 0.005 < np.mean(image.min(axis=-1) < 0.9) < 0.5


def test_table_shows_forces_displacements_accelerations_and_energy(
    finished: tuple[Path, Result],
) -> None:
    table = finished[1].stdout
    for words in (
        *("rms", "peak", "dominant", "lateral force", "displacement", "L/V", "carbody"),
        *("energy residual", "real-time factor", "results.nc"),
    ):
        assert words in table


def test_inputs_that_the_blocks_can_do_without_are_not_remarked(
    finished: tuple[Path, Result],
) -> None:
    assert "note: " in finished[1].stdout
    assert "nothing drives" not in finished[1].stdout


def test_quiet_run_prints_nothing(tmp_path: Path) -> None:
    result = run("--duration", "20ms", "--quiet", "--out", str(tmp_path))
    assert (result.exit_code, result.output) == (0, "")
    assert (tmp_path / "results.nc").exists()


def test_initial_yaw_is_where_the_truck_starts(tmp_path: Path) -> None:
    yawed = ("--track", "perfect", "--initial", "truck_front.yaw=0.005 deg")
    result = run(*yawed, "--duration", "10ms", "--quiet", "--out", str(tmp_path))
    assert result.exit_code == 0, result.output
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert dataset["truck_front.q[2]"][0] == pytest.approx(np.deg2rad(0.005), rel=1e-12)
        assert dataset["truck_rear.q[2]"][0] == 0.0
        assert np.all(dataset["track.axle[1].rail_y_left"] == 0.0)


def test_speed_may_be_given_in_any_unit(tmp_path: Path) -> None:
    result = run("--speed", "90 km/h", "--duration", "10ms", "--quiet", "--out", str(tmp_path))
    assert result.exit_code == 0, result.output
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert dataset["wheelset_11.force_y"].size == 11
        np.testing.assert_allclose(dataset["track.speed_out"], 25.0, rtol=1e-12)


def test_a_page_of_an_earlier_run_does_not_stay_beside_the_results_of_another(tmp_path):
    (tmp_path / "report.html").write_text("of the run before")
    (tmp_path / "assessment.csv").write_text("of the run before")
    (tmp_path / "mine.txt").write_text("of the user")
    asked = ["run", "--duration", "0.05s", "--track", "perfect", "--out", str(tmp_path)]
    result = CliRunner().invoke(main, asked)
    assert result.exit_code == 0, result.output
    assert not (tmp_path / "report.html").exists() and not (tmp_path / "assessment.csv").exists()
    assert (tmp_path / "mine.txt").exists()
    said = " ".join(result.output.split())
    assert "report.html, assessment.csv in" in said and "were of the run before" in said
