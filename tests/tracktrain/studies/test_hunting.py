"""Hunting: linear growth, limit cycles that forget their start, energy, critical speeds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import tolerances
from fmus.export.wheelrail import wheelrail_fmu
from orchestrator import Session
from support.contact_tables import circles, cone
from tracktrain.car.hopper import parameters_of
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds
from tracktrain.cli.main import main
from tracktrain.scales import FOOT
from tracktrain.studies.common.car import StudiedCar
from tracktrain.studies.hunting.runs import bisected, driven, on_perfect_track
from tracktrain.studies.hunting.study import hunting

YAW = np.deg2rad(0.005)


@pytest.fixture(scope="module")
def usual():
    return hunting(transients_only=True)


@pytest.mark.parametrize(("speed", "yaw", "growth"), [(60, 5e-3, 0.0664), (100, 1e-7, 1.0440)])
def test_small_motion_grows_as_the_linear_car(speed, yaw, growth):
    outcome = hunting(
        speeds=[speed * FOOT], initial_yaw=np.deg2rad(yaw), duration=60.0, transients_only=True
    )
    row = outcome.tables["limit_cycles"].iloc[0]
    assert row["growth [1/s]"] == pytest.approx(growth, rel=tolerances.HUNTING_GROWTH)
    assert row["linear [1/s]"] == pytest.approx(growth, rel=tolerances.HUNTING_GROWTH)


def test_limit_cycles_have_their_known_amplitudes(usual):
    amplitude = usual.tables["limit_cycles"]["amplitude [mm]"].to_numpy()
    assert amplitude == pytest.approx([8.68, 9.28, 9.59], rel=tolerances.LIMIT_CYCLE)


def test_limit_cycle_forgets_the_size_of_the_start(usual):
    other = hunting(
        speeds=[100 * FOOT], initial_yaw=6 * YAW, duration=60.0, transients_only=True
    ).tables["limit_cycles"]
    for column in ("amplitude [mm]", "frequency [Hz]"):
        known = usual.tables["limit_cycles"][column].iloc[-1]
        assert other[column].iloc[0] == pytest.approx(known, rel=tolerances.LIMIT_CYCLE)


def test_what_the_rails_give_is_lost_in_friction_and_damping(usual):
    energy = usual.tables["energy"]
    fast = energy.iloc[1:]  # at 60 ft/s it is a tenth of a joule: the cycle is all but conservative
    unexplained = fast["unexplained [J/cycle]"] / fast["from the rails [J/cycle]"]
    assert (unexplained.abs() < tolerances.ENERGY_OF_CYCLE).all()
    assert (energy["friction [J/cycle]"].diff().dropna() > 0).all()


def test_bolsters_slip_in_fast_hunting_and_nothing_does_in_slow(usual):
    table = usual.tables["elements"].reset_index()
    slips = table[table["slips, front [%]"] > 0.0].groupby("speed [ft/s]")["element"].agg(set)
    assert slips.to_dict() == {80.0: {"bolster roll"}, 100.0: {"bolster roll", "bolster lateral"}}
    assert (table["energy [J]"] > -0.1).all()


def test_every_coordinate_is_kept_and_drawn(usual, tmp_path):
    names = {path.name for path in usual.write(tmp_path)}
    assert {f"figures_7_1_to_7_12_{v}_fps.png" for v in (60, 80, 100)} <= names
    coordinates = {f"carbody.q[{n}]" for n in range(1, 9)}
    coordinates |= {f"truck_{end}.q[{n}]" for end in ("front", "rear") for n in range(1, 7)}
    assert coordinates <= set(usual.dataset.data_vars)


def test_the_reports_linear_car_dies_out_at_60_and_hunts_above():
    table = hunting("report-linear", duration=60.0, transients_only=True).tables["limit_cycles"]
    growth = table["growth [1/s]"].to_numpy()
    assert growth[0] < 0 < min(growth[1:])
    assert np.isnan(table["amplitude [mm]"].iloc[0])


@pytest.fixture(scope="module")
def uneven():
    """Wheels of two cones, left and right changed over: FMUs of the wheelsets."""
    flat, steep = cone(0.05), cone(0.08)
    return [
        StudiedCar(wheel=str(wheelrail_fmu(replace(left, right=right))))
        for left, right in ((flat, steep), (steep, flat))
    ]


@pytest.mark.slow
def test_unlike_wheels_changed_over_hunt_as_in_a_mirror(uneven):
    one, other = (
        hunting(car, [80 * FOOT], 40.0, sign * YAW, transients_only=True)
        for car, sign in zip(uneven, (1, -1), strict=True)
    )
    y = [outcome.dataset["truck_front.axle[1].y"].values for outcome in (one, other)]
    assert np.abs(y[0]).max() > 5e-3
    assert np.abs(y[0] + y[1]).max() < 1e-6 * np.abs(y[0]).max()
    (left,), (right,) = (
        outcome.tables["limit_cycles"].to_dict("records") for outcome in (one, other)
    )
    # Cycles are counted from upward crossings, which are downward ones in the mirror.
    assert left == pytest.approx(right, rel=2e-3, nan_ok=True)
    assert left["flange, leading axle [%]"] > 5
    assert np.isnan(left["growth [1/s]"]) and "not one wave" in " ".join(one.notes)


@pytest.mark.slow
def test_small_motion_on_profiles_grows_as_the_linear_car_on_them():
    wheel = str(wheelrail_fmu(circles(0.4, 0.3, 0.05)))
    car = StudiedCar(wheel=wheel, settings=[("*", "creep_law", "linear")])
    row = hunting(car, [100 * FOOT], 20.0, initial_yaw=1e-6 * YAW, transients_only=True).tables[
        "limit_cycles"
    ]
    growth, linear = row["growth [1/s]"].iloc[0], row["linear [1/s]"].iloc[0]
    assert linear > 0.5 and growth == pytest.approx(linear, rel=tolerances.HUNTING_GROWTH)


def test_a_limit_that_is_twice_as_high_and_not_met_is_used_half_as_much(usual):
    limit = parameters_of("loaded")["truck"]["warp.friction_limit"]
    high = StudiedCar(settings=[("truck_front", "warp.friction_limit", f"{2 * limit} N.m")])
    found = hunting(high, [60 * FOOT], transients_only=True)
    used = [
        outcome.tables["elements"].loc[(60.0, "warp"), "friction/limit"]
        for outcome in (found, usual)
    ]
    assert 2 * used[0] == pytest.approx(used[1], rel=1e-6)


@pytest.mark.parametrize("name", ["hunting", "stability", "sensitivity"])
def test_studies_of_the_straight_take_profiles_and_no_line(name):
    said = CliRunner().invoke(main, ["study", name, "--help"]).output
    for option in ("--car", "--wheel", "--rail", "--right-wheel", "--right-rail", "--set"):
        assert f"{option} " in said
    assert "--layout" not in said


@pytest.mark.slow
def test_staircases_bracket_the_bisected_critical_speed():
    """Up and down: the car hunts above the critical speed and not below, whence it may come."""
    low, high = 45 * FOOT, 75 * FOOT
    stairs = [low, 65 * FOOT, high, 65 * FOOT, low]
    with Session() as session:
        plateaus = driven(on_perfect_track("loaded", low, YAW), stairs, 150.0, session)
        tried = bisected(on_perfect_track("loaded", high, YAW), low, high, 60.0, FOOT, session)
    assert [p.hunts for p in plateaus] == [False, True, True, True, False]
    assert plateaus[1].amplitude == pytest.approx(plateaus[3].amplitude, rel=tolerances.LIMIT_CYCLE)
    bottom = max(p.speed for p in tried if not p.hunts)
    top = min(p.speed for p in tried if p.hunts)
    ((linear, _, _),) = critical_speeds(LinearCar(), np.arange(40, 101, 4) * FOOT)
    assert low < bottom < top < 65 * FOOT and top - bottom <= FOOT
    assert bottom - 0.1 * FOOT < linear < top + 0.1 * FOOT


def test_the_command_draws_one_speed(tmp_path):
    arguments = ["study", "hunting", "--speed", "100 ft/s", "--duration", "20s", "--no-staircase"]
    result = CliRunner().invoke(main, [*arguments, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "figures_7_1_to_7_12_100_fps.png").exists()


def test_the_command_takes_the_ends_of_the_staircase():
    from tracktrain.studies.hunting.study import command

    context = command.make_context("hunting", ["--staircase", "60 ft/s", "50 m/s"])
    assert context.params["staircase"] == (60 * FOOT, 50.0)
    assert not context.params["transients_only"]
