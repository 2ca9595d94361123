"""A car whose instances have other names runs through every command and study."""

from __future__ import annotations

import json

import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from orchestrator import simulate
from tracktrain.assessment import assess
from tracktrain.car.hopper import CARS, HOPPER, Vehicle, hopper_car, layout_of
from tracktrain.car.layout import Layout, Truck
from tracktrain.cli.main import main

OTHER = Layout(
    carbody="box",
    trucks=(Truck("bogie_a", "front", ("w1", "w2")), Truck("bogie_b", "rear", ("w3", "w4"))),
    track="line",
)


@pytest.fixture(scope="module")
def command(tmp_path_factory):
    """Runs a command where there is a car `other`; its output."""
    folder = tmp_path_factory.mktemp("renamed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(CARS, "other", Vehicle(OTHER, "loaded"))
        patch.chdir(folder)

        def run(line: str) -> str:
            result = CliRunner().invoke(main, line.split())
            assert result.exit_code == 0, result.output
            return result.output

        yield run


@pytest.fixture(scope="module")
def ran(command, tmp_path_factory):
    """Folder of a run of the renamed car."""
    folder = tmp_path_factory.mktemp("run")
    out = command(
        f"run --car other --duration 0.5s --set w1.conicity=0.1 --initial bogie_a.yaw=0.1mrad "
        f"--no-self-test --out {folder}"
    )
    assert "leading axle" in out and "carbody acceleration" in out
    return folder


def test_motion_is_that_of_the_hopper_car_to_the_bit():
    usual = simulate(hopper_car(), duration=0.2)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(CARS, "other", Vehicle(OTHER, "loaded"))
        other = simulate(hopper_car("other"), duration=0.2)
    assert (usual.record == other.record).all()
    names = dict(zip(HOPPER.blocks, OTHER.blocks, strict=True))
    for (name, _), (own, _) in zip(usual.variables, other.variables, strict=True):
        instance, _, variable = name.partition(".")
        assert own == f"{names[instance]}.{variable}"


def test_run_draws_assesses_and_reports(command, ran):
    names = {path.name for path in ran.iterdir()}
    assert {"lateral_force.png", "displacement.png", "track.png", "carbody.png"} <= names
    command(f"assess {ran}")
    places = pd.read_csv(ran / "assessment.csv")["place"].dropna()
    assert places.str.contains("w1|w2|w3|w4").any() and not places.str.contains("wheelset").any()
    command(f"report {ran}")
    page = (ran / "report.html").read_text()
    known = json.loads(page.split('id="known">')[1].split("<")[0])
    assert known["scene"]["coordinates"] == list(OTHER.coordinates())
    assert known["modes"] and known["first"][0] == "w1.force_y"


def test_exported_car_is_run_and_known_again_by_what_its_instances_give(command, tmp_path):
    command(f"export {tmp_path}/other.ssp --car other --duration 0.5s")
    with pytest.MonkeyPatch.context() as patch:
        patch.delitem(CARS, "other")
        out = command(
            f"run {tmp_path}/other.ssp --set line.seed=7 --no-self-test --out {tmp_path}/run"
        )
        with xr.open_dataset(tmp_path / "run/results.nc") as dataset:
            assert layout_of(dataset) == OTHER
        command(f"assess {tmp_path}/run")
        command(f"report {tmp_path}/run")
    assert "leading axle" in out


def test_sweep_takes_what_a_run_prints(command, tmp_path):
    command(
        "sweep --car other --over seed=1:2 --over w2.conicity=0.05,0.1 --duration 0.2s "
        f"--workers 1 --out {tmp_path}"
    )
    table = pd.read_csv(tmp_path / "sweep.csv")
    assert len(table) == 4 and table["message"].isna().all()
    assert {"w1.force_y.rms [N]", "box.cg.ay.peak [m/s2]"} <= {*table.columns}


@pytest.mark.parametrize(
    "line",
    [
        "sensitivity",
        "stability --no-animation",
        "response --seeds 2 --duration 1s --set line.report_rms=0.05in",
        "truck-hysteresis --load 50 --period 2",
        pytest.param("stability --no-animation --ring-down 50ft/s", marks=pytest.mark.slow),
        pytest.param(
            "hunting --speed 80ft/s --duration 20s --no-staircase", marks=pytest.mark.slow
        ),
        pytest.param("hunting --staircase 60ft/s 65ft/s --longest 10s", marks=pytest.mark.slow),
        pytest.param("carbody-survey", marks=pytest.mark.slow),
        pytest.param("wheelset", marks=pytest.mark.slow),
    ],
)
def test_every_study_of_a_car_runs(command, tmp_path, line):
    command(f"study {line} --car other --out {tmp_path}")
    assert (tmp_path / "data.nc").exists()


def test_prefixed_cars_join_into_a_train_that_moves_as_each_alone():
    """Each is on a track of its own; of the two the first is assessed."""
    one = hopper_car()
    train = one.prefixed("a").joined(one.prefixed("b"))
    both, alone = simulate(train, duration=0.2).dataset, simulate(one, duration=0.2).dataset
    for prefix in ("a", "b"):
        assert (both[f"{prefix}:wheelset_22.force_y"] == alone["wheelset_22.force_y"]).all()
    assert layout_of(train) == layout_of(both) == HOPPER.prefixed("a")
    places = [place for place in assess(both)["place"] if place]
    assert places and all(place.startswith("a:") for place in places)
