"""What a run leaves behind."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr

from orchestrator import Component, InlineModel, OrchestratorError, System, simulate
from orchestrator.results.metrics import dominant_frequency, peak, rms
from orchestrator.results.stationary import from_time, settling
from support.coupled_models import damped_mass, oscillator


def test_dataset_names_every_output_with_its_unit():
    dataset = simulate(oscillator(), duration=0.1, step=0.01).dataset
    assert {name: dataset[name].attrs["units"] for name in dataset} == {
        "one.x": "m",
        "one.v": "m/s",
        "one.a": "m/s2",
        "other.force": "N",
        "other.x2": "m",
    }
    assert dataset["one.x"].dims == ("time",)
    assert dataset["time"].attrs["units"] == "s"


def test_selection_by_name_and_pattern_keeps_the_answer():
    everything = simulate(oscillator(), duration=0.5, step=0.01).dataset
    some = simulate(oscillator(), duration=0.5, step=0.01, record=["one.?", "other.x*"]).dataset
    assert set(some) == {"one.x", "one.v", "one.a", "other.x2"}
    for name in some:
        assert np.array_equal(some[name], everything[name])


def test_open_input_is_recorded_as_what_it_stood_at():
    system = System({"m": Component(InlineModel(inputs={"force": "N"}))}).with_value(
        "m.force", "2 kN"
    )
    run = simulate(system, duration=0.1, step=0.01)
    np.testing.assert_array_equal(run.dataset["m.force"], np.full(11, 2000.0))


def test_file_holds_the_results_and_where_they_come_from(tmp_path):
    system = damped_mass(2.0)
    run = simulate(system, duration=0.1, step=0.01, command="tracktrain run")
    path = run.write(tmp_path / "new" / "folder")
    assert path == tmp_path / "new" / "folder" / "results.nc"
    with xr.open_dataset(path) as read:
        for name in run.dataset:
            assert np.array_equal(read[name], run.dataset[name])
            assert read[name].attrs["units"] == run.dataset[name].attrs["units"]
        assert read.attrs["command"] == "tracktrain run"
        assert (read.attrs["master"], read.attrs["step"]) == ("one-pass", 0.01)
        assert set(json.loads(read.attrs["fmus"])) == {"damper", "mass", "ground"}
        assert "numpy" in json.loads(read.attrs["versions"])
        assert json.loads(read.attrs["notes"]) == run.notes


def test_folder_that_cannot_be_written(tmp_path):
    run = simulate(oscillator(), duration=0.1, step=0.01)
    (tmp_path / "file").write_text("")
    with pytest.raises(OrchestratorError) as caught:
        run.write(tmp_path / "file" / "folder")
    assert str(caught.value) == (
        f"'{tmp_path / 'file' / 'folder'}' cannot be written to: not a directory; choose another "
        "folder"
    )


def response(values, step=1e-3):
    return xr.DataArray(values, dims="time", coords={"time": np.arange(len(values)) * step})


def test_metrics_of_a_sine_with_an_offset():
    t = np.arange(8001) * 1e-3
    wave = response(0.2 + 3.0 * np.sin(2 * np.pi * 1.37 * t))
    assert dominant_frequency(wave) == pytest.approx(1.37, rel=2e-3)
    assert peak(wave) == pytest.approx(3.2, rel=1e-3)
    assert rms(wave) == pytest.approx(np.hypot(0.2, 3 / np.sqrt(2)), rel=2e-2)
    assert np.isnan(dominant_frequency(response(np.ones(100))))


@pytest.mark.parametrize("written", [True, False])
def test_signals_have_what_the_dataset_has(tmp_path, written):
    run = simulate(oscillator(), duration=0.5, step=0.01, out=tmp_path if written else None)
    told, dataset = run.signals, run.dataset
    assert list(told.data_vars) == list(dataset.data_vars)
    assert (dict(told.sizes), set(told.variables)) == ({"time": 51}, set(dataset.variables))
    assert dict(told.attrs) == dataset.attrs
    for name in dataset:
        assert np.array_equal(told[name].values, dataset[name].values)
        assert dict(told[name].attrs) == dataset[name].attrs
        assert settling(told[name]) == settling(dataset[name])
    late, later = told.isel(time=slice(20, None)), abs(told["one.x"])[30:40]
    assert np.array_equal(late["one.v"].values, dataset["one.v"].values[20:])
    assert np.array_equal(later.values, np.abs(dataset["one.x"].values[30:40]))
    assert np.array_equal(later["time"].values, run.time[30:40])
    assert np.array_equal(from_time(told, 0.2)["time"].values, run.time[20:])
    assert "nothing" not in told
