"""A carbody of one's own in the car: from modal data, by file, command and Python."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import tolerances
from fmus.carbody.default_data import default_data
from fmus.carbody.modal_data import ModalData, Point
from fmus.carbody.modal_files import read_modal_data, write_modal_data
from fmus.describe.parameters import parameter_set
from orchestrator import open_results, simulate
from tracktrain import hopper_car
from tracktrain.car.carbody import carbody_of, with_carbody
from tracktrain.car.hopper import parameters_of
from tracktrain.car.linear import LinearCar
from tracktrain.cli.main import main
from tracktrain.report.motion import modes, scene

SILL = Point("end_sill", 6.4, 0.0, -1.4)


@pytest.fixture(scope="module")
def data() -> ModalData:
    """The default car's own modes, with an accelerometer on the end sill."""
    return default_data(parameters_of("loaded")["carbody"], (SILL,), "own")


def test_with_the_default_cars_own_modes_a_car_runs_as_the_default(data: ModalData) -> None:
    system = hopper_car(speed="60 ft/s", track="fra2")
    mine, notes = with_carbody(system, data)
    runs = [simulate(s, duration=0.5, step=1e-3).dataset for s in (system, mine)]
    assert len(notes) == 1 and "3 elastic modes" in notes[0]
    for name, own in runs[0].items():
        carbody = str(name).startswith("carbody.")
        bound = tolerances.OWN_MODES if carbody else tolerances.OWN_MODES_TRUCK
        difference = float(np.abs(own - runs[1][name]).max())
        assert difference <= bound * float(np.abs(own).max()), name
    tilt = runs[1]["carbody.cg.pitch"]
    assert float(np.abs(runs[1]["carbody.end_sill.z"] + SILL.x * tilt).max()) > 0.0


def test_modes_of_the_linear_car_are_those_of_its_own_modal_data(data: ModalData) -> None:
    own, mine = LinearCar("loaded"), LinearCar("loaded", carbody=data)
    found = [np.sort_complex(car.modes(20.0)[0]) for car in (own, mine)]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-8)


def test_a_table_of_frequencies_and_rows_is_a_car_in_one_command(tmp_path: Path) -> None:
    table, out = tmp_path / "mine.csv", tmp_path / "results"
    table.write_text(
        "mode,frequency [Hz],damping [%],point,y,z,roll,yaw\n"
        "torsion,5.2,1.5,front,0.005,0,0.0037,0\n"
        "torsion,5.2,1.5,rear,-0.005,0,-0.0037,0\n"
        "bending,14.5,2,front,0,0.001,0,0\n"
        "bending,14.5,2,rear,0,0.001,0,0\n"
    )
    run = CliRunner().invoke(
        main,
        ["run", "--carbody", str(table), "--duration", "0.2s", "--out", str(out), "--no-self-test"],
    )
    assert run.exit_code == 0, run.output
    assert "carbody mine: 2 elastic modes, 5.2 to 14.5 Hz" in run.output
    with open_results(out / "results.nc") as dataset:
        assert "carbody.q[7]" in dataset and "carbody.q[8]" not in dataset
        body = carbody_of(dataset)
        assert body is not None and [m.name for m in body.modes] == ["torsion", "bending"]
        _, arrays = scene(dataset) or pytest.fail("no scene")
        assert arrays["coordinates"].shape[1] == arrays["motions"].shape[0] == 7 + 12
        listed, found = modes(dataset) or pytest.fail("no modes")
        assert found["modes"].shape == (len(listed), 2, 19)


def test_a_body_too_heavy_for_its_trucks_is_told(data: ModalData) -> None:
    heavy = replace(data, body=replace(data.body, mass=1.3 * data.body.mass))
    _, notes = with_carbody(hopper_car(), heavy)
    assert "weighs" in notes[1] and "centre_plate_weight" in notes[1]


def test_the_fmu_gives_back_its_data_and_runs_with_its_own_numbers(
    data: ModalData, tmp_path: Path
) -> None:
    source, fmu = tmp_path / "own.toml", tmp_path / "my car.fmu"
    light = replace(data, body=replace(data.body, mass=0.99 * data.body.mass))
    write_modal_data(light, source)
    made = CliRunner().invoke(main, ["carbody", str(source), "-o", str(fmu)])
    assert made.exit_code == 0, made.output
    again = read_modal_data(fmu, parameter_set("loaded"))
    np.testing.assert_array_equal(again.shapes, data.shapes)
    system, _ = with_carbody(hopper_car(), fmu)
    assert not system.components["carbody"].parameters
    run = simulate(system, duration=0.01, step=1e-3, self_test=False)
    fallen = run.dataset["carbody.cg.az"] * light.body.mass
    total = sum(_vertical(run.dataset, truck) for truck in ("truck_front", "truck_rear"))
    np.testing.assert_allclose(fallen, total, rtol=1e-9, atol=1e-6)


def _vertical(dataset: xr.Dataset, truck: str) -> xr.DataArray:
    return dataset[f"{truck}.car.force_z"]
