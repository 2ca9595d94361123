"""A run in other tools' formats, read back by what reads them; what commands found as JSON."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner
from scipy.io import loadmat

from orchestrator import open_results
from tracktrain.cli.main import main
from tracktrain.convert import convert
from tracktrain.errors import TracktrainError
from tracktrain.studies.common.command import study_command
from tracktrain.studies.common.outcome import Outcome

NAME = "truck_front.axle[1].y"


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """A short run's folder, and what `run --json` says of it."""
    folder = tmp_path_factory.mktemp("run")
    given = ["run", "--duration", "0.2s", "--no-self-test", "--json", "--out", str(folder)]
    result = CliRunner().invoke(main, given)
    assert result.exit_code == 0, result.output
    return folder, json.loads(result.stdout)


@pytest.fixture(scope="module")
def lateral(said):
    with open_results(said[0]) as dataset:
        return dataset[NAME].load()


def test_matlab_finds_every_signal_by_a_name_that_it_takes(said, lateral, tmp_path):
    found = loadmat(convert(said[0], tmp_path / "run.mat"), squeeze_me=True)
    at = list(found["names"]).index(NAME)
    assert found["units"][at] == "m" and found["fields"][at] == "truck_front_axle_1_y"
    assert np.array_equal(found["signals"]["truck_front_axle_1_y"].item(), lateral)
    assert np.array_equal(found["time"], lateral.time)
    assert all(len(field) <= 63 and field.isidentifier() for field in found["fields"])


def test_hdf5_keeps_values_and_units(said, lateral, tmp_path):
    with xr.open_dataset(convert(said[0], tmp_path / "run.h5"), engine="netcdf4") as found:
        assert found[NAME].identical(lateral)


def test_csv_has_the_signals_and_the_span_that_were_asked_for(said, lateral, tmp_path):
    file = convert(said[0], tmp_path / "run.csv", ["truck_front.axle*.y", NAME], 0.05, 0.1)
    table = pd.read_csv(file)
    assert list(table)[:2] == ["time [s]", f"{NAME} [m]"]
    assert np.allclose(table[f"{NAME} [m]"], lateral.sel(time=slice(0.05, 0.1)), rtol=1e-15)


def test_parquet_has_the_signals_as_columns(said, lateral, tmp_path):
    pytest.importorskip("pyarrow")
    table = pd.read_parquet(convert(said[0], tmp_path / "run.parquet"))
    assert np.array_equal(table[NAME], lateral)


@pytest.mark.parametrize(
    ("file", "signals", "begin", "message"),
    [
        ("run.xls", (), None, r"no known format; .*\.csv"),
        ("run.csv", ("wheelset_11.forcey",), None, "no signal.*did you mean wheelset_11.force_y"),
        ("run.csv", (), 9.0, "has no rows in that time"),
    ],
)
def test_what_cannot_be_converted_is_said(said, tmp_path, file, signals, begin, message):
    with pytest.raises(TracktrainError, match=message):
        convert(said[0], tmp_path / file, signals, begin)


def test_a_run_as_json_has_statistics_with_intervals_and_a_verdict_in_parts(said, lateral):
    _, found = said
    assert found["completed"] is True and found["message"] is None
    assert {part["name"] for part in found["verdict"]} >= {"coupling", "answer", "range"}
    force = found["statistics"]["wheelset_11.force_y"]
    assert force["unit"] == "N" and force["rms"]["value"] > 0.0
    assert force["rms"].keys() == {"value", "low", "high"}


@pytest.mark.parametrize("command", ["assess", "compare"])
def test_other_commands_print_nothing_but_json_when_asked(said, command, tmp_path):
    copy = shutil.copytree(said[0], tmp_path / "copy")
    given = [copy] if command == "assess" else [said[0], copy, "--out", tmp_path / "out"]
    result = CliRunner().invoke(main, [command, *map(str, given), "--json"])
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["assessment" if command == "assess" else "numbers"]


def test_a_study_as_json_has_its_tables_and_null_for_what_is_no_number(tmp_path):
    table = pd.DataFrame({"speed [m/s]": [1.0, np.nan]}, index=pd.Index(["a", "b"], name="case"))
    command = study_command("small")(
        lambda: Outcome("A study", xr.Dataset(), tables={"speeds": table})
    )
    result = CliRunner().invoke(command, ["--json", "--out", str(tmp_path)])
    found = json.loads(result.stdout)
    assert found["title"] == "A study" and found["folder"] == str(tmp_path)
    assert found["tables"]["speeds"] == [
        {"case": "a", "speed [m/s]": 1.0},
        {"case": "b", "speed [m/s]": None},
    ]
