"""How certain: known indices and bands come out, and exact derivatives agree with the sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.describe.spread import Spread
from tracktrain.answer.numbers import bands
from tracktrain.car.band import QUANTILE, critical_band, first_order
from tracktrain.car.hopper import HOPPER
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds
from tracktrain.car.spreads import Uncertain, uncertain
from tracktrain.errors import TracktrainError
from tracktrain.scales import FOOT
from tracktrain.studies.common.car import StudiedCar
from tracktrain.studies.uncertainty import sample, study
from tracktrain.studies.uncertainty.design import DESIGNS

GRID = np.array([40.0, 60.0, 80.0]) * FOOT


def number(name: str, deviation: float) -> Uncertain:
    return Uncertain(name, ("truck",), "1", "", "", Spread(1.0, None, None, deviation, "made up"))


def ishigami(points):
    x = np.pi * (2 * points - 1)
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


FIRST, TOTAL = (0.3139, 0.4424, 0.0), (0.5576, 0.4424, 0.2437)
"""Of Ishigami's function with a = 7, b = 0.1 (Saltelli et al., 2008)."""


def test_sobols_design_finds_the_indices_of_ishigamis_function():
    design = DESIGNS["sobol"]
    points = design.points(3, 5000, 1)
    found = design.indices(points, ishigami(points), 1)
    assert found.first == pytest.approx(FIRST, abs=0.05)
    assert found.total == pytest.approx(TOTAL, abs=0.05)


def test_a_latin_hypercube_finds_the_first_order_indices_and_a_failed_run_does_no_harm():
    design = DESIGNS["latin"]
    points = design.points(3, 1000, 1)
    values = ishigami(points)
    values[7] = np.nan
    assert design.indices(points, values, 1).first == pytest.approx(FIRST, abs=0.05)


def test_too_few_runs_are_refused_with_the_number_that_is_needed():
    with pytest.raises(TracktrainError, match="at least 96 runs, not 50; give more --runs"):
        DESIGNS["sobol"].points(10, 50, 1)


def test_the_band_of_a_linear_model_is_that_of_its_variance():
    numbers = [number("a", 0.1), number("b", 0.2)]
    band = first_order(5.0, {"a": 3.0, "b": 2.0}, numbers)
    assert band.deviation == pytest.approx(0.5)
    assert (band.low, band.high) == pytest.approx((5.0 - 0.5 * QUANTILE, 5.0 + 0.5 * QUANTILE))
    assert band.shares == pytest.approx({"b": 0.64, "a": 0.36})


def test_a_lopsided_range_moves_the_centre():
    lopsided = replace(number("a", 0.1), spread=Spread(1.0, 1.0, 4.0, None, "made up"))
    assert first_order(5.0, {"a": 3.0}, [lopsided]).centre == pytest.approx(8.0)


@pytest.fixture(scope="module")
def critical():
    linear = LinearCar("loaded")
    return linear, critical_speeds(linear, GRID)[0]


def critical_speed_with(changes):
    return critical_speeds(LinearCar("loaded", changes), GRID)[0].speed


@pytest.mark.parametrize(
    "name", ["longitudinal_creep_coefficient", "conicity", "warp.friction_stiffness", "body_mass"]
)
def test_the_critical_speeds_derivative_is_that_of_central_differences(critical, name):
    (own,) = uncertain("loaded", [name])
    band = critical_band(*critical, [own])
    h = 1e-4 * own.spread.value
    ends = [critical_speed_with(own.changes(own.spread.value + s * h)) for s in (1, -1)]
    assert band.slopes[name] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-4)


def test_derivatives_and_sample_agree_where_the_ranges_are_small(critical):
    wide = uncertain("loaded", ["conicity", "longitudinal_creep*", "warp.friction_stiffness"])
    numbers = [replace(n, spread=n.spread.scaled(0.02)) for n in wide]
    band = critical_band(*critical, numbers)
    points = DESIGNS["latin"].points(len(numbers), 65, 1)
    speeds = [
        critical_speed_with(
            {
                k: v
                for n, p in zip(numbers, row, strict=True)
                for k, v in n.changes(float(n.spread.quantile(p))).items()
            }
        )
        for row in points
    ]
    assert np.mean(speeds) == pytest.approx(band.centre, rel=1e-3)
    assert np.std(speeds) == pytest.approx(band.deviation, rel=0.05)


def test_what_follows_a_number_changes_with_it():
    (creep,) = uncertain("loaded", ["longitudinal_creep_coefficient"])
    changes = creep.changes(2 * creep.spread.value)
    assert changes["lateral_creep_coefficient"] == pytest.approx(2 * creep.spread.value)
    assert "lateral_creep_coefficient" not in {n.name for n in uncertain("loaded")}


def test_a_study_that_was_stopped_goes_on_with_what_is_left(tmp_path, monkeypatch):
    tried = []

    def pretended(options):
        tried.append(options["changes"])
        if len(tried) == 30:
            raise KeyboardInterrupt
        value = sum(options["changes"].values()) or 0.15
        numbers = {"critical_speed": 10 + value, "limit_cycle": value, "l_over_v.max": value}
        numbers |= {"hunts": 1.0, "settled": 1.0}
        return {"units": dict.fromkeys(numbers, "1"), "message": "", **numbers}

    monkeypatch.setattr(study, "one_car", pretended)
    monkeypatch.setattr(study, "rows", lambda tasks, work: ((n, work(o)) for n, o in tasks.items()))
    asked = {"runs": 70, "parameters": ["conicity", "flange_clearance"], "folder": tmp_path}
    with pytest.raises(KeyboardInterrupt):
        study.uncertainty(**asked)
    outcome = study.uncertainty(**asked)
    assert len(tried) == 30 + (71 - 29)
    assert outcome.tables["causes"].loc["limit_cycle"].index[0] == "conicity"
    assert outcome.tables["bands"].loc["limit_cycle", "5 %"] > 0.04


def of_all_wheelsets(name, value):
    return [(axle.wheelset, name, value) for axle in HOPPER.axles]


def test_what_a_car_is_set_to_counts_as_known_and_is_left_as_it_is():
    steep = StudiedCar(settings=of_all_wheelsets("conicity", "0.1"))
    _, numbers, known = study._uncertain_of(steep, ["conicity", "warp.stiffness"])
    assert ([number.name for number in numbers], known) == (["warp.stiffness"], ["conicity"])
    found = [sample._critical(vars(steep) | {"changes": c}) for c in ({}, {"conicity": 0.2})]
    assert found[0] == found[1]
    alone = critical_speed_with({"wheelrail.conicity": 0.1})
    assert found[0]["critical_speed"][0] == pytest.approx(alone, rel=1e-8)
    with pytest.raises(TracktrainError, match="has conicity from its profiles or from --set"):
        study.uncertainty(steep, parameters=["conicity"])


def test_a_study_does_not_go_on_with_a_line_that_was_changed(tmp_path, monkeypatch):
    made = []
    monkeypatch.setattr(study, "one_car", lambda options: made.append(options) or {"units": {}})
    monkeypatch.setattr(study, "rows", lambda tasks, work: ((n, work(o)) for n, o in tasks.items()))
    line = tmp_path / "line.csv"
    for text in ("one", "one", "another"):
        line.write_text(text)
        study._made([{"layout": line, "changes": {}}], tmp_path / "out", lambda share: None)
    assert len(made) == 2


def test_one_car_has_all_numbers_and_a_run_that_fails_says_why():
    shared = {"speed": 25.0, "track": "fra5", "seed": 1, "duration": 0.5}
    row = sample.one_car({"car": "loaded", "changes": {"conicity": 0.1}, **shared})
    assert row["message"] == "" and row["units"]["critical_speed"] == "m/s"
    assert {"limit_cycle", "wheelset_11.force_y.rms", "l_over_v.max"} <= set(row)
    failed = sample.one_car({"car": "loaded", "changes": {"axle_load": -1.0}, **shared})
    assert "axle_load" in failed["message"] and "limit_cycle" not in failed


@pytest.mark.parametrize("car", ["loaded", "empty", "report-linear"])
def test_the_band_that_a_verdict_states_is_that_of_the_exact_derivatives(car):
    linear, numbers = LinearCar(car), uncertain(car)
    band = critical_band(linear, critical_speeds(linear, sample.SPEEDS)[0], numbers)
    most, share = next(iter(band.shares.items()))
    said = bands()[car]
    assert (said["numbers"], said["most"]) == (len(numbers), most)
    assert [said["low"], said["high"], said["share"]] == pytest.approx(
        [band.low, band.high, share], rel=2e-3
    )
