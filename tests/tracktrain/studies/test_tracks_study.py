"""The tracks study: every track beside the others, its gauge against the law."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from tracktrain.cli.main import main
from tracktrain.studies.tracks import tracks


@pytest.fixture(scope="module")
def outcome():
    return tracks(length=250.0, seeds=4)


def test_gauge_of_every_class_is_legal(outcome):
    gauge = outcome.tables["gauge"].loc["fra1":"fra6"]
    assert (gauge["least [in]"] > gauge["legal from [in]"]).all()
    assert (gauge["most [in]"] < gauge["to [in]"]).all()
    assert gauge["mean [in]"].is_monotonic_decreasing


def test_report_has_its_rms_in_waves_that_excite_the_car(outcome):
    waves = outcome.tables["waves"]
    assert waves.loc["report", "70 to 310 m [mm]"] == 0.0
    assert (waves.drop("report-grid")["largest line [%]"] < 5.0).all()
    assert waves.loc["report-grid", "largest line [%]"] == pytest.approx(69.2, abs=0.1)


def test_default_seed_is_one_of_many(outcome):
    rms = tracks(length=250.0).tables["report_seeds"]["rms [mm]"]
    assert rms.quantile(0.05) < rms[1] < rms.quantile(0.95)


def test_command_prints_the_tables(tmp_path):
    command = ["study", "tracks", "--length", "50 m", "--seeds", "2", "--out", str(tmp_path)]
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 0, result.output
    assert "legal" in result.output
    assert (tmp_path / "report_seeds.csv").exists()
