"""What a run's answer is worth: settled or not, and where it stands."""

from __future__ import annotations

import json
from io import StringIO

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

from orchestrator import Level, Port, PortMap, Verdict, simulate
from support.variants import variant
from tracktrain import answer, hopper_car
from tracktrain.answer import counted, parts
from tracktrain.answer.numbers import of_numbers
from tracktrain.answer.standing import Standing, linear_of
from tracktrain.car.band import critical_band
from tracktrain.car.changes import swapped
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds
from tracktrain.car.spreads import uncertain
from tracktrain.cli.summary import _responses, numbers
from tracktrain.scales import FOOT

STEP, DURATION = 0.01, 60.0


def run_of(rate: float = 0.0, amplitude: float = 1e-3) -> xr.Dataset:
    """A run of the car whose leading axle swings, with a noise of its own."""
    time = np.arange(0.0, DURATION, STEP)
    noise = 1.0 + 0.01 * np.random.default_rng(1).normal(size=time.size)
    y = amplitude * np.exp(rate * time) * np.sin(2 * np.pi * 2.0 * time) * noise
    columns = {"wheelset_11.y_rel": y, "carbody.cg.az": np.zeros_like(time)}
    units = {"wheelset_11.y_rel": "m", "carbody.cg.az": "m/s2"}
    return xr.Dataset(
        {name: ("time", column, {"units": units[name]}) for name, column in columns.items()},
        {"time": ("time", time, {"units": "s"})},
    )


def answer_of(dataset: xr.Dataset) -> str:
    return next(str(part) for part in parts(dataset) if part.name == "answer")


def test_a_settled_run_is_good_and_what_does_not_move_is_not_excited():
    said = answer_of(run_of())
    assert said.startswith("Answer: good. Settled")
    assert "Not excited: vertical acceleration" in said


def test_a_run_through_curves_is_not_told_to_go_on_where_the_line_ends():
    through = run_of(rate=0.05)
    assert "run at least" in answer_of(through)
    bent = np.where(through["time"].values > 30, 1 / 600, 0.0)
    through["track.curvature"] = ("time", bent, {"units": "1/m"})
    said = answer_of(through)
    assert said.startswith("Answer: unknown. The line goes through curves")
    assert "run at least" not in said
    through["track.curvature"] = ("time", np.full_like(bent, 1 / 600), {"units": "1/m"})
    assert "run at least" in answer_of(through)


def test_a_car_that_came_to_rest_does_not_move_for_what_rounding_leaves():
    left = run_of(amplitude=1e-13)
    rounding = 1e-9 * np.random.default_rng(2).normal(size=left.sizes["time"])
    left["carbody.cg.az"] = ("time", rounding, {"units": "m/s2"})
    said = answer_of(left)
    assert said.startswith("Answer: unknown. Nothing that is judged moves")
    assert "Not excited: displacement to rail, vertical acceleration" in said
    for found in numbers(left).values():
        assert np.isnan(found["dominant frequency [Hz]"].value)
    console = Console(width=120, record=True, file=StringIO())
    console.print(_responses(left, ()))
    assert console.export_text().count("not excited") == 2


def test_a_growing_run_says_how_much_and_how_long_to_run():
    said = answer_of(run_of(rate=np.log(4.0) / (DURATION / 2)))
    assert "Answer: doubtful. Not settled: grew 4 times" in said
    assert "run at least 220 s, and leave out the transient (--duration 220s --settle)" in said


def test_a_run_on_stations_that_end_is_told_what_to_take_instead_of_a_longer_one():
    growing = run_of(rate=0.1)
    instead = "; where the track ends before, take the peaks over its stretches and no rms"
    growing.attrs["parameters"] = json.dumps({"track.fade_length": 10.0, "track.spectrum": 6})
    assert "run at least" in answer_of(growing) and instead not in answer_of(growing)
    growing.attrs["parameters"] = json.dumps({"track.fade_length": 10.0})
    assert instead in answer_of(growing)


def test_the_worst_part_comes_first_and_the_coupling_is_one_of_them():
    found = parts(run_of(rate=0.1), Verdict(Level.BAD, ("the run did not reach its end",)))
    assert [part.name for part in found][:2] == ["coupling", "answer"]
    assert {part.name for part in found} == {"coupling", "answer", "range", "numbers"}


def test_a_run_that_began_outside_the_model_says_so_before_it_asks_for_a_smaller_step():
    limit = {"outputs": ["left.saturation"], "largest": 1.0, "beyond": "forces above friction"}
    outside = run_of().assign({"wheelset_11.left.saturation": ("time", np.full(6000, 2.0))})
    outside.attrs["ranges"] = json.dumps({"wheelset_11": [limit]})
    smaller = Verdict(Level.DOUBTFUL, ("the residual is large",))
    assert [part.name for part in parts(outside, smaller)][:2] == ["range", "coupling"]


def test_a_run_that_went_out_after_its_coupling_failed_says_to_mend_that_first():
    over = np.where(np.arange(6000) < 5000, 0.5, 2.0)
    limit = {"outputs": ["left.saturation"], "largest": 1.0, "beyond": "forces", "void": True}
    outside = run_of().assign({"wheelset_11.left.saturation": ("time", over)})
    outside.attrs["ranges"] = json.dumps({"wheelset_11": [limit]})
    first, second = parts(outside, Verdict(Level.BAD, ("the run did not reach its end",)))[:2]
    assert (first.name, second.name) == ("coupling", "range")
    assert "mend it first" in second.text


def test_what_came_before_a_derailment_is_told_with_what_helps():
    creep = {"outputs": ["left.saturation"], "largest": 1.0, "beyond": "creep forces"}
    climb = {"outputs": ["left.climb"], "largest": 1.0, "beyond": "a climb", "void": True}
    limits = [{**creep, "remedy": "take another law"}, {**climb, "remedy": "it derailed"}]
    over = {
        f"wheelset_11.left.{name}": ("time", np.where(np.arange(6000) < row, 0.5, 2.0))
        for name, row in (("saturation", 1000), ("climb", 2000))
    }
    derailed = run_of().assign(over)
    derailed.attrs["ranges"] = json.dumps({"wheelset_11": limits})
    text = next(part.text for part in parts(derailed) if part.name == "range")
    assert text.index("it derailed. This may have led there: creep forces") < text.index(
        "take another law"
    )


def test_settling_leaves_the_transient_out():
    decaying = run_of() + run_of(rate=-1.0, amplitude=0.05)
    assert 2.0 < float(counted(decaying, None, settle=True).time[0]) < 20.0
    assert float(counted(decaying, 30.0, settle=True).time[0]) == pytest.approx(30.0)


def test_a_run_that_is_over_before_its_hunting_has_grown_is_too_short(monkeypatch):
    def grows(rate: float) -> Standing:
        return Standing(60 * FOOT, 55 * FOOT, rate, "lateral", 0.76, ())

    span = float(run_of().time[-1])
    monkeypatch.setattr(answer, "_is_car", lambda dataset: True)
    for rate, said in ((5.0 / span, "run at least"), (20.0 / span, "Settled")):
        monkeypatch.setattr(answer, "standing", lambda dataset, rate=rate: grows(rate))
        assert said in answer_of(run_of())


def test_above_the_critical_speed_is_said_with_the_time_to_grow_tenfold():
    standing = Standing(60 * FOOT, 55 * FOOT, 0.1, "lateral", 0.76, ())
    assert standing.above and standing.tenfold == pytest.approx(23.0, abs=0.1)
    assert "60 ft/s (40.9 mph) is above the critical speed" in str(standing)
    below = Standing(50 * FOOT, 55 * FOOT, -0.1, "", 0.0, ())
    assert "50 ft/s (34.1 mph) is below the critical speed" in str(below)


def test_the_numbers_of_a_run_have_a_band_and_what_to_measure():
    run = simulate(
        hopper_car("empty", 50 * FOOT).with_value("truck_front.bolster_mass", 600.0), duration=0.1
    )
    said = next(part for part in parts(run.dataset) if part.name == "numbers")
    assert said.level is Level.DOUBTFUL
    assert "77 numbers of the empty car as it ran have a range" in said.text
    assert "most by conicity" in said.text and "whether it hunts at this speed is open" in said.text


@pytest.fixture(scope="module")
def usual():
    return simulate(hopper_car("empty", 50 * FOOT), duration=0.1).dataset


def test_the_band_of_cones_is_not_said_to_be_that_of_wheelsets_that_are_not_known(
    usual, monkeypatch
):
    ran = ("wheelset_11", "wheelset_12")
    monkeypatch.setattr("tracktrain.answer.numbers.swapped", lambda dataset, layout: ran)
    monkeypatch.setattr("tracktrain.answer.numbers.linear_of", lambda dataset: None)
    level, said = of_numbers(usual)
    assert level is Level.DOUBTFUL
    assert "the band of cones and not of what ran as wheelset_11, wheelset_12" in said
    assert "hunts at this speed" not in said


def ran_with(fmu, **values):
    """A run of the car with an FMU as two of its wheelsets."""
    car = hopper_car("loaded", 20.0)
    for name in ("wheelset_11", "wheelset_22"):
        car, _ = swapped(car, name, fmu)
        car = car.with_values({name: values})
    return simulate(car, duration=0.01).dataset


def test_wheelsets_of_another_file_that_give_derivatives_have_the_band_of_their_equations(tmp_path):
    linear, unknown = linear_of(ran_with(variant(tmp_path, "wheelrail")))
    assert not unknown
    spread, speeds = uncertain("loaded"), np.linspace(10.0, 30.0, 6)
    found, expected = (
        critical_band(car, critical_speeds(car, speeds)[0], spread)
        for car in (linear, LinearCar("loaded"))
    )
    assert len(found.slopes) == len(spread)
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high), rel=1e-6)


def without_derivatives(description):
    return description.replace('providesDirectionalDerivative="true"', "")


@pytest.mark.parametrize(
    ("edit", "values"),
    [(without_derivatives, {}), (str, {"speed_floor": 15.0})],
    ids=["no derivatives", "forces that do not go with the speed as creepages do"],
)
def test_wheelsets_of_which_the_linear_car_is_not_known_are_told(tmp_path, edit, values):
    dataset = ran_with(variant(tmp_path, "wheelrail", edit), **values)
    _, unknown = linear_of(dataset)
    assert unknown == ("the FMU of wheelset_11", "the FMU of wheelset_22")
    assert "of cones and not of what ran as wheelset_11, wheelset_22" in of_numbers(dataset)[1]


def test_wheelsets_behind_a_map_are_not_taken_for_what_they_are_without(tmp_path):
    fmu, turned = (
        variant(tmp_path, "wheelrail"),
        PortMap({"left.force_y": Port("left.force_y", -1)}),
    )
    car, _ = swapped(hopper_car("loaded", 20.0), "wheelset_11", fmu, turned)
    _, unknown = linear_of(simulate(car, duration=0.01).dataset)
    assert unknown == ("the FMU of wheelset_11",)


def test_a_run_whose_speed_changes_is_not_judged_as_one_at_a_speed(monkeypatch):
    dataset = run_of()
    fast, slow = 80 * FOOT, 20 * FOOT
    along = np.linspace(fast, slow, dataset.time.size)
    dataset["track.speed_out"] = ("time", along, {"units": "m/s"})
    said = answer_of(dataset)
    assert "from 80 ft/s (54.5 mph) to 20 ft/s (13.6 mph)" in said
    assert "run at least" not in said
    monkeypatch.setattr(
        answer, "standing", lambda dataset: Standing(50 * FOOT, 50 * FOOT, 0.0, "", 0.0, ())
    )
    half = float(dataset.time[-1]) / 2
    assert f"at t = {half:.3g} s it passes the critical speed" in answer_of(dataset)
