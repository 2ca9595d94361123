"""Events of a run: when a wheel passed Nadal's limit or left its rail, and for how long."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from orchestrator import Level, Verdict
from tracktrain import events as module
from tracktrain.answer import parts
from tracktrain.answer.standing import Standing
from tracktrain.cli.main import main
from tracktrain.events import ABOVE, DERAILMENT, LIFT, events, nadal_rule
from tracktrain.report import page

STEP, SPEED = 0.01, 20.0
LIMIT = nadal_rule().limit


def run_of(ratio=(), lifted=(), rows=100):
    """A run of the car at 20 m/s whose leading left wheel is beyond in these rows."""
    time = STEP * np.arange(rows)
    over, load = np.full(rows, 0.1), np.full(rows, 1e5)
    over[list(ratio)], load[list(lifted)] = -1.5 * LIMIT, 0.0
    columns = {
        "wheelset_11.left.l_over_v": (over, "1"),
        "truck_front.axle[1].load_left": (load, "N"),
        "track.distance": (SPEED * time, "m"),
    }
    return xr.Dataset(
        {name: ("time", row, {"units": unit}) for name, (row, unit) in columns.items()},
        {"time": ("time", time, {"units": "s"})},
    )


def test_a_wheel_beyond_nadal_over_five_feet_derails_and_over_less_does_not():
    enough = int(np.ceil(nadal_rule().window / (STEP * SPEED)))
    (event,) = events(run_of(ratio=range(10, 10 + enough)))
    assert (event.kind, event.place) == (DERAILMENT, "wheelset_11 left")
    assert (event.time, event.station) == (pytest.approx(0.1), pytest.approx(2.0))
    assert event.distance >= nadal_rule().window
    assert event.value == pytest.approx(1.5 * LIMIT)
    (short,) = events(run_of(ratio=range(10, 9 + enough)))
    assert short.kind == ABOVE


def test_nadal_stands_as_the_rule_of_the_assessment_has_it():
    assert pytest.approx(1.128, abs=1e-3) == LIMIT
    assert nadal_rule().window == pytest.approx(5 * 0.3048)
    assert "49 CFR 213.333" in nadal_rule().source


def on_profiles(run, angle=70.0, friction=0.4, wheelset="wheelset_12"):
    """The run with one wheelset on profiles with this flange angle [deg]."""
    constants = {f"{wheelset}.flange_angle": np.radians(angle)}
    parameters = {f"{wheelset}.friction_coefficient": friction}
    said = {"constants": json.dumps(constants), "parameters": json.dumps(parameters)}
    return run.assign_attrs(said)


@pytest.mark.parametrize(
    ("angle", "friction", "counts"), [(70, 0.4, 0.5), (70, 0.6, 0.6), (65, 0.5, 0.5)]
)
def test_the_limit_is_of_the_flange_that_the_run_has_and_of_no_less_friction(
    angle, friction, counts
):
    rule = nadal_rule(on_profiles(run_of(), angle, friction))
    closed = (np.tan(np.radians(angle)) - counts) / (1 + counts * np.tan(np.radians(angle)))
    assert rule.limit == pytest.approx(closed)
    assert rule.given == f"delta = {angle} deg, mu = {counts}"


def test_a_wheel_between_the_limits_of_two_flanges_derails_on_the_less_steep_one():
    run = run_of(ratio=range(10, 40))
    run["wheelset_11.left.l_over_v"] = run["wheelset_11.left.l_over_v"] * (1.0 / 1.5 / LIMIT)
    assert events(run) == []
    (event,) = events(on_profiles(run))
    assert event.kind == DERAILMENT
    assert "delta = 70 deg, mu = 0.5" in next(
        part.text for part in parts(on_profiles(run)) if part.name == "range"
    )


def test_wheels_without_flanges_keep_the_angle_of_the_rule():
    assert pytest.approx(LIMIT) == nadal_rule(on_profiles(run_of(), angle=3.0)).limit


def test_profiles_that_do_not_tell_their_angle_are_said_to_have_none():
    run = run_of().assign({"wheelset_11.left.contact_angle": ("time", np.zeros(100))})
    assert "for want of the profiles' own" in nadal_rule(run).given


def test_a_wheel_without_load_is_lifted_for_as_long_as_it_has_none():
    first, second = events(run_of(lifted=[20, 21, 22, 50]))
    assert (first.kind, first.time, first.duration) == (
        LIFT,
        pytest.approx(0.2),
        pytest.approx(0.03),
    )
    assert second.duration == pytest.approx(STEP)


def test_an_event_over_the_edge_of_two_chunks_is_one(monkeypatch):
    whole = events(run_of(ratio=range(10, 40), lifted=[0, 99]))
    chunked = module.chunks
    monkeypatch.setattr(module, "chunks", lambda data, names: chunked(data, names, size=7))
    assert events(run_of(ratio=range(10, 40), lifted=[0, 99])) == whole
    assert [event.ended for event in whole] == [True, True, False]


def test_a_run_of_no_car_has_no_events():
    pump = xr.Dataset({"pump.flow": ("time", [1.0, 2.0])}, {"time": [0.0, 1.0]})
    assert events(pump) == []


def test_a_derailment_makes_the_range_bad_and_says_what_to_do():
    ranged = next(part for part in parts(run_of(ratio=range(10, 40))) if part.name == "range")
    assert ranged.level.value == "bad"
    assert ranged.text.startswith("Derailment: ")
    assert (
        "derailment: wheelset_11 left from t = 0.1 s (2 m along the track)" in ranged.text.lower()
    )
    assert "lower the speed" in ranged.text


def test_what_came_before_a_derailment_by_nadal_is_told_with_what_helps():
    limits = [
        {"outputs": ["left.clearance"], "largest": 1.0, "beyond": "flanges", "remedy": "none"},
        {"outputs": ["left.saturation"], "largest": 1.0, "beyond": "creep", "remedy": "a law"},
    ]
    made = run_of(ratio=range(10, 40))
    rows = np.arange(made.sizes["time"])
    for row, name in ((2, "clearance"), (5, "saturation")):
        made[f"wheelset_11.left.{name}"] = ("time", np.where(rows < row, 0.5, 2.0))
    made.attrs["ranges"] = json.dumps({"wheelset_11": limits})
    text = next(part.text for part in parts(made) if part.name == "range")
    assert text.startswith("Derailment: ") and "This may have led there: creep" in text
    assert "; a law." in text
    assert "what follows means nothing. " in text and "speed" not in text


def told(run, verdict=None):
    """What is said to do about the derailment of a run."""
    text = next(part.text for part in parts(run, verdict) if part.name == "range")
    return text.partition("what follows means nothing")[2]


def in_curve(run, curvature, friction=0.4):
    """The run in a curve, its leading left wheel outside where that is below zero [1/m]."""
    run["track.curvature"] = ("time", np.full(run.sizes["time"], curvature))
    return on_profiles(run, friction=friction, wheelset="wheelset_11")


def test_an_outer_wheel_in_a_curve_is_not_told_to_go_slower():
    """Which does not help: see `test_a_wheel_climbs_in_a_tight_curve_at_any_speed`."""
    said = told(in_curve(run_of(ratio=range(10, 40)), -1 / 90))
    assert said.startswith("; in a curve a wheel climbs by its angle of attack and friction")
    assert "--set '*.friction_coefficient=0.3'" in said and "--speed" not in said
    dry = told(in_curve(run_of(ratio=range(10, 40)), -1 / 90, friction=0.3))
    assert "--set" not in dry and "take other profiles (--wheel, --rail)" in dry
    for curvature in (1 / 90, 0.0):
        said = told(in_curve(run_of(ratio=range(10, 40)), curvature))
        assert said == "; lower the speed (--speed), or look at the track there (--track)."


def test_a_car_that_hunts_is_told_a_speed_below_the_critical_one(monkeypatch):
    fast = Standing(SPEED, 18.5, 0.2, "lateral", 1.0, ())
    for name in ("", ".derailed"):
        monkeypatch.setattr(f"tracktrain.answer{name}.standing", lambda dataset: fast)
    said = told(in_curve(run_of(ratio=range(10, 40)), -1 / 90))
    assert said == "; it hunts at this speed: take one below the critical (--speed '41 mph')."


def test_a_run_that_begins_derailed_is_told_to_begin_elsewhere():
    said = told(run_of(ratio=range(40)))
    assert "begin on straight track and nearer to rest (--initial)" in said
    assert "speed" not in said


def test_a_derailment_of_a_coupling_that_failed_is_told_to_mend_that_first():
    broken = Verdict(Level.BAD, ("the force jumps",))
    said = told(run_of(ratio=range(10, 40)), broken)
    assert said == ". The coupling may be what led there; mend it first."


def test_assess_prints_the_events_and_leaves_them_as_a_table(tmp_path):
    run_of(ratio=range(10, 40)).to_netcdf(tmp_path / "results.nc")
    said = CliRunner().invoke(main, ["assess", str(tmp_path)], terminal_width=120)
    assert said.exit_code == 0, said.output
    assert "derailment" in said.output and "Nadal's limit 1.13" in said.output
    assert (tmp_path / "events.csv").read_text().count("\n") == 2
    run_of().to_netcdf(tmp_path / "results.nc")
    assert "derailment" not in CliRunner().invoke(main, ["assess", str(tmp_path)]).output
    assert not (tmp_path / "events.csv").exists()


def test_assess_says_before_its_table_that_the_run_left_the_model(tmp_path):
    run_of(ratio=range(10, 40)).to_netcdf(tmp_path / "results.nc")
    said = CliRunner().invoke(main, ["assess", str(tmp_path)]).output
    assert said.startswith("Range: bad. Derailment: ")
    found = json.loads(CliRunner().invoke(main, ["assess", str(tmp_path), "--json"]).output)
    assert found["range"]["level"] == "bad"
    run_of().to_netcdf(tmp_path / "results.nc")
    assert "Range" not in CliRunner().invoke(main, ["assess", str(tmp_path)]).output


def test_the_page_lists_the_events_and_has_them_for_its_plots():
    text = page(run_of(ratio=range(10, 40)))
    assert '<a href="#events">' in text
    assert '"events":[{"kind":"derailment","place":"wheelset_11 left","from":0.1,"to":0.4}]' in text
    assert '<a href="#events">' not in page(run_of())
