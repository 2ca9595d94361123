"""The track study: the FMU's rails have the distribution and the spectrum of their target."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

import tolerances
from tracktrain.cli.main import main
from tracktrain.studies.track import track


@pytest.fixture(scope="module")
def fra5():
    return track("fra5", seed=3, length=10000.0)


def test_spectrum_of_the_rails_follows_its_target(fra5):
    inside = (fra5.dataset.frequency > 0.03) & (fra5.dataset.frequency < 0.3)
    for channel in ("alignment", "profile", "cross_level", "gauge"):
        measured = fra5.dataset[f"{channel}_density"][inside].values
        ratio = measured / fra5.dataset[f"{channel}_target"][inside].values
        assert np.mean(ratio) == pytest.approx(1.0, rel=tolerances.WELCH_MEAN)


def test_rms_of_the_rails_is_the_published_one_of_class_5(fra5):
    # Published for waves of 3 to 41.7 m, which is the block's band.
    published = {"alignment": 3.06, "profile": 5.08, "cross level": 3.88, "gauge": 3.88}
    for channel, rms in published.items():
        row = fra5.tables["rms"].loc[channel]
        assert row["target [mm]"] == pytest.approx(rms, abs=0.005)
        assert row["rms [mm]"] == pytest.approx(rms, rel=tolerances.WELCH_MEAN)


def test_irregularity_is_normally_distributed(fra5):
    heights = fra5.dataset["profile"].values
    assert abs(stats.skew(heights)) < tolerances.NORMAL_SHAPE
    assert abs(stats.kurtosis(heights)) < tolerances.NORMAL_SHAPE


def test_report_track_has_an_alignment_of_0_088_in_and_nothing_else():
    table = track("report", length=5000.0).tables["rms"]
    assert table.loc["alignment", "target [mm]"] == pytest.approx(25.4 * 0.088)
    assert (table.drop("alignment")["rms [mm]"] == 0.0).all()


def test_command_prints_the_table_and_writes_data_tables_and_pictures(tmp_path):
    result = CliRunner().invoke(
        main, ["study", "track", "--length", "500 m", "--out", str(tmp_path / "out")]
    )
    assert result.exit_code == 0, result.output
    assert "alignment" in result.output and "[mm]" in result.output
    assert {p.name for p in (tmp_path / "out").iterdir()} == {
        "data.nc",
        "rms.csv",
        "figure_5_3.png",
        "figure_5_4.png",
        "figure_5_5.png",
    }


def test_unknown_study_is_answered_with_the_closest():
    result = CliRunner().invoke(main, ["study", "trak"])
    assert result.exit_code == 2
    assert (
        "there is no study 'trak'; did you mean track or tracks? choose one of: " in result.output
    )
