"""The way from dimensions to the car that runs, beside the report's numbers."""

from __future__ import annotations

import sys

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from fmus.carbody.modal_files import read_modal_data
from structures.errors import StructureError
from structures.scaling import scale_factors
from structures.survey import Survey
from tracktrain.cli.main import main
from tracktrain.studies.structure.analysis import analysed, beam_table, check_table, reduction_table
from tracktrain.studies.structure.cars import shape_table
from tracktrain.studies.structure.correlated import compared, correlated, scaled_table
from tracktrain.studies.structure.printed import names, printed
from tracktrain.studies.structure.study import drawing

pytestmark = pytest.mark.xdist_group("structure")  # one worker makes what all share


@pytest.fixture(scope="module")
def found():
    return analysed()


@pytest.fixture(scope="module")
def empty(found):
    return correlated("empty", found.data["empty"])


def test_the_reports_scale_factor_follows_from_its_tables():
    factors = scale_factors(printed("test", "empty").values, printed("analysis", "empty").values)
    ours = np.sqrt(factors.squared_mean) * np.array(printed("analysis", "empty").values)
    assert ours == pytest.approx(printed("scaled", "empty").values, abs=0.005)


def test_each_measured_mode_finds_its_own(empty):
    table = compared(empty)
    assert tuple(table.index) == names()
    assert list(table["our mode"]) == list(names())
    assert (abs(table["ours over report"] - 1) < 0.25).all()


def test_scaled_frequencies_have_the_tests_mean_ratio(empty):
    table = scaled_table(empty)
    ratio = table["test [Hz]"] / table["by mean ratio, squared [Hz]"]
    assert ratio.mean() == pytest.approx(1.0, rel=1e-9)


def test_measured_frequencies_are_kept_with_the_models_shapes(empty):
    data = empty.with_test_frequencies()
    kept = {mode.name: mode for mode in data.modes}
    assert [kept[name].frequency for name in names()] == list(printed("test", "empty").values)
    assert np.array_equal(data.shapes, empty.data.shapes)
    assert any("29.57 Hz, report Table 4-2" in line for line in data.provenance)


def test_a_survey_of_other_axes_is_refused_in_words(found):
    data = found.data["empty"]
    shapes = data.shapes[:1].copy()
    shapes[:, :, :3] = np.random.default_rng(0).normal(size=shapes[:, :, :3].shape)
    wrong = correlated("empty", data, Survey("wrong", data.modes[:1], data.points, shapes))
    with pytest.raises(StructureError, match="no mode of wrong is like one of hopper car"):
        _ = wrong.factors


def test_checks_and_reduction_are_as_good_as_the_report_asks(found):
    checks, reduction = check_table(found), reduction_table(found)
    assert checks.loc["mass [t]", "empty, model"] == pytest.approx(
        checks.loc["mass [t]", "empty, sum of parts"], rel=1e-9
    )
    assert checks.loc["mass [t]", "loaded, model"] == pytest.approx(
        checks.loc["mass [t]", "loaded, sum of parts"], rel=1e-9
    )
    below = reduction[reduction["full [Hz]"] < 30.0]
    assert (below["off [%]"] > 0).all() and (below["off [%]"] < 1).all()
    assert (abs(below["mass formed: off [%]"]) > below["off [%]"]).sum() > 3


def test_a_beam_is_too_crude_for_the_car(found):
    """The report's 71 Hz by (4-1), against 29.6 Hz measured."""
    table = beam_table(found)["ours [Hz]"]
    assert table["uniform beam (4-1)"] > 1.3 * table["finite elements"]


def test_the_drawing_has_every_element(found):
    drawn = drawing(found.structures["empty"], found.data["empty"])
    assert len(drawn.faces) + len(drawn.lines) == 2 * len(found.half.elements)
    assert np.linalg.norm(drawn.moved, axis=2).max(axis=1) == pytest.approx(1.0)


def test_a_file_of_dimensions_that_is_none_is_refused_in_words(tmp_path):
    (tmp_path / "mine.toml").write_text("name = 'x'")
    command = ["study", "structure", "--model", str(tmp_path / "mine.toml")]
    result = CliRunner().invoke(main, [*command, "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "mine.toml lacks [material]" in result.output


def test_the_default_torsion_has_the_reports_factor(empty):
    table = shape_table("empty", empty.with_test_frequencies())
    assert table.loc["torsion, roll", "default"] == pytest.approx(1.204)
    assert 1.0 < table.loc["torsion, roll", "model"] < 1.6


@pytest.mark.slow
def test_one_command_leads_from_dimensions_to_the_car(tmp_path):
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["study", "structure", "--quiet", "--out", str(out)])
    assert result.exit_code == 0, result.output
    for car in ("empty", "loaded"):
        data = read_modal_data(out / f"carbody_{car}.toml")
        assert {mode.name for mode in data.modes} == set(names())
        run = ["run", "--car", car, "--carbody", str(out / f"carbody_{car}.fmu")]
        result = CliRunner().invoke(
            main, [*run, "--duration", "0.1s", "--out", str(tmp_path / car)]
        )
        assert result.exit_code == 0, result.output
    page = (out / "structure.html").read_text()
    assert "vertical bending" in page and "http" not in page.replace("http-equiv", "")
    survey = pd.read_csv(out / "virtual_survey.csv", index_col=0)
    elastic = survey[survey["block [Hz]"].notna()]
    known = elastic["block [Hz]"].to_numpy()
    assert elastic["free, all [Hz]"].to_numpy() == pytest.approx(known, rel=0.015)


def test_without_the_extra_it_says_what_to_install(tmp_path, monkeypatch):
    for name in [n for n in sys.modules if n.startswith("tracktrain.studies.structure")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "structures.elements")
    monkeypatch.setitem(sys.modules, "pyfe3d", None)
    result = CliRunner().invoke(main, ["study", "structure", "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert "pip install 'tracktrain[structures]'" in result.output.replace("\n", " ")
