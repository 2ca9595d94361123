"""Every rule on a car whose motion is known in closed form."""

from __future__ import annotations

import json
from itertools import chain, pairwise, takewhile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from tolerances import BAND_PASS_ENDS
from tracktrain.assessment import assess, judged
from tracktrain.assessment.criteria import LIMITS, MEASURES
from tracktrain.assessment.order import (
    COMPARED,
    COUNTED,
    UNLIMITED,
    grouped,
    left_out,
    summed_up,
)
from tracktrain.assessment.rules import rules
from tracktrain.assessment.sections import by_sections, estimate, parts
from tracktrain.assessment.weighting import W_B
from tracktrain.car.hopper import HOPPER
from tracktrain.cli.main import main
from tracktrain.events import nadal
from tracktrain.geometry.sections import CURVE, STRAIGHT, TRANSITION, Section

SPEED, RATE, GRAVITY = 18.288, 1000, 9.80665
AXLE_LOAD = 50 * 4448.2216152605  # 50 kip


def motion(
    duration: float, frequency: float = 3.0, speed: float = SPEED, **amplitudes: float
) -> xr.Dataset:
    """A car that sways in sinusoids: of ay, az [m/s2], ratio (L/V), load (share), force [N]."""
    time = np.arange(round(duration * RATE) + 1) / RATE
    wave = np.sin(2 * np.pi * frequency * time)
    given = dict.fromkeys(("ay", "az", "ratio", "load", "force", "vy"), 0.0) | amplitudes
    variables = {"track.distance": speed * time, "carbody.cg.roll": 0.01 * wave}
    for end in ("front", "rear", "cg"):
        variables |= {f"carbody.{end}.{a}": given[a] * wave for a in ("ay", "az")}
    for axle in HOPPER.axles:
        variables[f"{axle.wheelset}.force_y"] = given["force"] * wave
        variables[f"{axle.port}.vy"] = given["vy"] * wave
        for side, sign in (("left", 1), ("right", -1)):
            load = AXLE_LOAD / 2 * (1 + sign * given["load"] * wave)
            variables[f"{axle.port}.load_{side}"] = load
            variables[f"{axle.wheelset}.{side}.l_over_v"] = np.full_like(time, given["ratio"])
    masses = {"wheelset_mass": 1200.0, "side_frame_mass": 400.0, "bolster_mass": 800.0}
    parameters = {
        f"{truck}.{name}": value
        for truck in HOPPER.instances("truck")
        for name, value in {"axle_load": AXLE_LOAD, **masses}.items()
    }
    parameters |= {
        "carbody.body_length": 13.0,
        "carbody.half_truck_spacing": 5.0,
        "carbody.gravity_centre_height": 1.5,
        "truck_front.centre_plate_height": 0.6,
    }
    return xr.Dataset(
        {name: ("time", values) for name, values in variables.items()},
        {"time": time},
        {"parameters": json.dumps(parameters)},
    )


def row(table: pd.DataFrame, key: str) -> pd.Series:
    return table.loc[next(rule.quantity for rule in rules() if rule.key == key)]


def test_every_rule_can_be_measured_and_judged() -> None:
    for rule in rules():
        assert rule.inapplicable or rule.key in MEASURES
        assert bool(rule.formula) == (rule.key in LIMITS)
    assert len({rule.quantity for rule in rules()}) == len(rules())


@pytest.mark.parametrize(
    ("angle", "friction", "ratio"),
    [(75, 0.5, 1.128), (75, 0.36, 1.439), (70, 0.5, 0.947), (60, 0.5, 0.660), (70, 0.6, 0.811)],
)
def test_nadals_limit(angle: float, friction: float, ratio: float) -> None:
    assert nadal(np.deg2rad(angle), friction) == pytest.approx(ratio, abs=1e-3)


def test_steady_ratio_and_load_are_found_as_they_are() -> None:
    table = assess(motion(4.0, ratio=0.7, force=30e3, frequency=0.5))
    found = row(table, "wheel_l_over_v")
    assert found["value"] == pytest.approx(0.7, rel=1e-6)
    assert found["share"] == pytest.approx(0.7 / nadal(np.deg2rad(75), 0.5), rel=1e-6)
    assert row(table, "truck_side_l_over_v")["result"] == "exceeded"
    assert row(table, "net_axle_l_over_v")["limit"] == pytest.approx(0.4 + 5.0 / 50)
    held = 30e3 / AXLE_LOAD * np.cos(np.pi * 0.5 * 1.524 / SPEED)  # over 5 ft about the crest
    assert row(table, "net_axle_l_over_v")["value"] == pytest.approx(held, rel=2e-3)
    assert row(table, "aar_axle_sum")["value"] == pytest.approx(1.4)


def test_a_ratio_is_judged_by_the_flange_that_the_wheels_have() -> None:
    data = motion(4.0, ratio=1.0, frequency=0.5)
    assert row(assess(data), "wheel_l_over_v")["result"] == "passed"
    data.attrs["constants"] = json.dumps({"wheelset_11.flange_angle": np.deg2rad(70)})
    found = row(assess(data), "wheel_l_over_v")
    assert found["limit"] == pytest.approx(nadal(np.deg2rad(70), 0.5))
    assert found["result"] == "exceeded"
    assert found["formula"].endswith(", delta = 70 deg, mu = 0.5")


def test_unloading_is_judged_by_its_share_of_what_is_admissible() -> None:
    table = assess(motion(4.0, load=0.9, frequency=0.5))
    found = row(table, "aar_wheel_unloading")
    held = 1 - 0.9 * np.cos(np.pi * 0.5 * 0.05)  # for 50 ms about the lowest load
    assert found["value"] == pytest.approx(held, abs=1e-3)
    assert found["share"] == pytest.approx((1 - held) / 0.9, abs=1e-3)
    assert row(table, "wheel_load_ratio")["result"] == "exceeded"


LEAST = ("wheel_load_ratio", "passenger_wheel_load", "aar_wheel_unloading",
         "aar_wheel_unloading_way")  # fmt: skip


@pytest.mark.parametrize("key", LEAST)
def test_of_least_loads_the_lightest_wheel_is_judged(key: str) -> None:
    data = motion(4.0, load=0.1, frequency=0.5)
    light = HOPPER.trucks[1].axles[1]
    data[f"{light.port}.load_right"] = data[f"{light.port}.load_right"] * 0.05
    found = row(assess(data), key)
    assert found["place"] == f"{light.wheelset} right"
    assert found["value"] == pytest.approx(0.05 * 0.9, rel=0.02) and found["result"] == "exceeded"


def test_of_least_loads_the_lightest_truck_side_is_judged() -> None:
    data, truck = motion(4.0, load=0.1, frequency=0.5), HOPPER.trucks[1]
    for axle in truck.axles:
        data[f"{axle.port}.load_right"] = data[f"{axle.port}.load_right"] * 0.05
    found = row(assess(data), "passenger_truck_side_load")
    assert found["place"] == f"{truck.instance} right" and found["result"] == "exceeded"
    assert found["value"] == pytest.approx(0.05 * 0.9, rel=0.02)


def test_limits_of_forces_are_those_of_the_least_axle_load() -> None:
    data = motion(4.0, force=1e3, load=0.1)
    given = json.loads(data.attrs["parameters"])
    given[f"{HOPPER.trucks[0].instance}.axle_load"] = AXLE_LOAD / 2
    data.attrs["parameters"] = json.dumps(given)
    table = assess(data)
    assert row(table, "en_wheel_load")["limit"] == pytest.approx((90e3 + AXLE_LOAD / 4) / 1e3)
    assert row(table, "net_axle_l_over_v")["limit"] == pytest.approx(0.4 + 5.0 / 25)
    heavy = row(assess(motion(4.0, force=1e3, load=0.1)), "en_wheel_load")
    assert heavy["limit"] == pytest.approx(200.0)  # 90 kN + Q0 is more


def test_sway_of_known_amplitude_through_the_limits_of_the_accelerations() -> None:
    amplitude = 0.2 * GRAVITY
    table = assess(motion(12.0, frequency=1.0, ay=amplitude, az=2 * amplitude, vy=0.1))
    rms = 0.2 / np.sqrt(2)
    assert row(table, "carbody_lateral_oscillation")["value"] == pytest.approx(rms, rel=2e-2)
    assert row(table, "carbody_vertical_oscillation")["value"] == pytest.approx(2 * rms, rel=2e-2)
    cut = 0.4 * np.cos(np.pi * 0.05)
    assert row(table, "carbody_lateral_transient")["value"] == pytest.approx(cut, rel=1e-2)
    assert row(table, "aar_peak_to_peak")["value"] == pytest.approx(0.4, rel=1e-3)
    assert row(table, "aar_roll")["value"] == pytest.approx(np.rad2deg(0.02), rel=1e-5)
    assert row(table, "carbody_lateral_oscillation")["result"] == "exceeded"
    assert row(table, "carbody_lateral_transient")["result"] == "passed"


def test_truck_and_wheelset_oscillate_as_their_velocity_says() -> None:
    velocity, frequency = 0.1, 3.0
    table = assess(motion(12.0, frequency=frequency, vy=velocity, force=10e3))
    rms = 2 * np.pi * frequency * velocity / np.sqrt(2)
    assert row(table, "truck_lateral_acceleration")["value"] == pytest.approx(
        rms / GRAVITY, rel=BAND_PASS_ENDS
    )
    unstable = row(table, "en_instability_acceleration")
    assert unstable["value"] == pytest.approx(rms, rel=2e-2)
    assert unstable["limit"] == pytest.approx((12 - 4.0 / 5) / 2)  # a truck of 4 t
    force = row(table, "en_instability_force")
    assert force["value"] == pytest.approx(10 / np.sqrt(2), rel=2e-2)
    wheel = AXLE_LOAD / 2e3
    assert force["limit"] == pytest.approx(0.85 * (10 + 2 * wheel / 3) / 2)


def test_accelerations_are_those_of_the_bodys_ends_at_floor_level() -> None:
    """A rigid body that sways, yaws and rolls about its centre of gravity, each in closed form."""
    sway, yaw, roll = 1.0, 0.2, 0.3  # m/s2, rad/s2, rad/s2
    data = motion(12.0, frequency=1.0)
    wave = np.sin(2 * np.pi * data.time.values)
    data["carbody.cg.ay"] = ("time", sway * wave)
    for end, x in (("front", 5.0), ("rear", -5.0)):  # 1.5 m below the centre of gravity
        data[f"carbody.{end}.ay"] = ("time", (sway + x * yaw + 1.5 * roll) * wave)
    found = row(assess(data), "carbody_lateral_transient")
    below = 1.5 - (42 * 0.0254 - 0.6)  # the floor, of the centre of gravity
    right = 2 * (sway + 6.5 * yaw + below * roll) * np.cos(np.pi * 0.05) / GRAVITY
    assert found["value"] == pytest.approx(right, rel=1e-2)
    assert found["place"] == "carbody front end"


def test_sustained_limits_ask_for_more_than_one_window() -> None:
    """Half a second of sway exceeds the limit in 4 s windows, but not for 4 s on end."""
    data = motion(30.0, frequency=4.0, ay=0.5 * GRAVITY)
    burst = (data.time.values > 10.0) & (data.time.values < 10.5)
    for end in ("front", "rear", "cg"):
        data[f"carbody.{end}.ay"] = data[f"carbody.{end}.ay"] * burst
    found = row(assess(data), "carbody_lateral_oscillation")
    once, at_both_ends = (0.5 / np.sqrt(2) * np.sqrt(part / 4) for part in (0.5, 0.25))
    assert once > found["limit"] and found["result"] == "passed"
    assert found["value"] == pytest.approx(at_both_ends, rel=0.1)
    steady = row(
        assess(motion(30.0, frequency=1.0, ay=0.5 * GRAVITY)), "carbody_lateral_oscillation"
    )
    assert steady["value"] == pytest.approx(0.5 / np.sqrt(2), rel=3e-2)


def test_truck_side_and_net_axle_of_appendix_c() -> None:
    table = assess(motion(4.0, load=0.9, force=0.6 * AXLE_LOAD, frequency=0.2))
    side, net = (row(table, key) for key in ("passenger_truck_side_load", "passenger_net_axle"))
    assert side["value"] == pytest.approx(0.1, abs=2e-3) and side["result"] == "exceeded"
    assert side["share"] == pytest.approx(0.9 / 0.8, abs=3e-3)
    assert net["value"] == pytest.approx(0.6, rel=3e-3) and net["result"] == "exceeded"
    assert net["quote"].startswith("(2) The net axle lateral force")


def test_a_run_outside_of_a_rules_scope_is_shown_for_comparison() -> None:
    slow, fast = (assess(motion(8.0, speed=speed, ay=1.0)) for speed in (20.0, 40.0))
    for key, at_20, at_40 in (
        ("truck_lateral_acceleration", False, True),  # 213.333 is for freight above 80 mph
        ("aar_roll", True, False),  # Chapter 11 goes up to 70 mph
        ("wheel_l_over_v", False, False),  # passenger equipment
        ("sperling_lateral", True, True),
    ):
        assert bool(row(slow, key)["applies"]) is at_20, key
        assert bool(row(fast, key)["applies"]) is at_40, key


def test_every_verified_limit_quotes_its_paragraph() -> None:
    for rule in rules():
        assert rule.verified == bool(rule.quote), rule.key


def test_three_feet_are_judged_beside_50_ms() -> None:
    table = assess(motion(4.0, frequency=5.0, load=0.5, speed=3.0))
    time, way = (row(table, f"aar_wheel_unloading{end}")["value"] for end in ("", "_way"))
    kept = 1 / (1 + (5 / 15) ** 4)
    assert time == pytest.approx(1 - 0.5 * kept * np.cos(np.pi * 5.0 * 0.05), abs=5e-3)
    assert way > 1.0  # 3 ft at 3 m/s are one and a half waves


def test_hunting_of_a_sinusoid_over_2000_ft() -> None:
    found = row(assess(motion(34.0, ay=0.26 * GRAVITY)), "aar_hunting")
    kept = 1 / (1 + (3 / 15) ** 4)  # 3 Hz through a Butterworth filter of 15 Hz, there and back
    assert found["value"] == pytest.approx(0.26 / np.sqrt(2) * kept, rel=1e-3)
    assert found["result"] == "exceeded"


def test_run_too_short_for_a_window_says_how_long_it_must_be() -> None:
    table = assess(motion(8.0, ay=1.0))
    assert row(table, "aar_hunting")["result"] == (
        "not applicable: the window of 2000 ft is longer than the run of 146 m; at this speed it "
        "takes 33.4 s"
    )
    assert row(table, "carbody_lateral_oscillation")["result"] == "passed"


def test_rule_whose_signal_is_missing_says_which() -> None:
    table = assess(motion(4.0).drop_vars("wheelset_12.left.l_over_v"))
    assert row(table, "wheel_l_over_v")["result"] == (
        "not applicable: the run has no wheelset_12.left.l_over_v"
    )


def test_rules_about_what_a_system_does_not_have_are_not_listed() -> None:
    car = motion(4.0)
    pumps = car.rename({name: f"pump.{n}" for n, name in enumerate(car.data_vars)})
    assert len(assess(pumps)) == 0
    names = [name for name in car.data_vars if str(name).startswith("carbody.")]
    table = assess(car[names])
    assert {"ride comfort, lateral, weighting W_d", "Sperling Wz, lateral"} <= {*table.index}
    assert not any("L/V" in quantity or "axle" in quantity for quantity in table.index)


def test_rows_too_far_apart_for_a_filter_are_not_assessed() -> None:
    table = assess(motion(20.0, ay=1.0).isel(time=slice(None, None, 50)))
    reason = "not applicable: 20 rows a second are too few"
    for key in ("carbody_lateral_oscillation", "wheel_l_over_v", "iso_lateral"):
        assert row(table, key)["result"].startswith(reason)


def test_command_prints_the_table_and_writes_it(tmp_path: Path) -> None:
    motion(4.0, ratio=0.7).to_netcdf(tmp_path / "results.nc")
    result = CliRunner().invoke(main, ["assess", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "2000 ft" in result.stdout
    assert result.stdout.rpartition("\nLimits: ")[2].startswith("2 of ")
    written = pd.read_csv(tmp_path / "assessment.csv", index_col="quantity")
    assert list(written.index) == [rule.quantity for rule in rules()]
    assert written["source"].notna().all()


def test_nobody_rides_in_a_freight_car_so_that_comfort_is_no_limit_of_it() -> None:
    table = assess(motion(8.0, ay=5.0))
    for key in ("iso_lateral", "iso_lateral_transient", "en_mean_comfort"):
        assert row(table, key)["result"] == "no limit"


def test_what_uses_most_of_its_limit_stands_first_and_what_is_not_for_the_run_apart() -> None:
    rows = judged(motion(8.0, ratio=0.7, speed=20.0, ay=1.0))
    groups = grouped(rows)
    assert list(groups) == [COUNTED, COMPARED, UNLIMITED]
    for name in (COUNTED, COMPARED):
        shares = [found["share"] for found in groups[name]]
        assert shares == sorted(shares, reverse=True)
        assert {found["applies"] for found in groups[name]} == {name == COUNTED}
    silent = [quantity for names in left_out(rows).values() for quantity in names]
    shown = [found["quantity"] for found in chain(*groups.values())]
    assert sorted([*shown, *silent]) == sorted(found["quantity"] for found in rows)


def test_the_sum_of_an_assessment_counts_what_is_exceeded_and_names_the_worst() -> None:
    def judged_as(name: str, share: float, applies: bool = True) -> dict[str, Any]:
        return {"quantity": name, "value": 1.0, "share": share, "applies": applies}

    kept = [judged_as("roll", 0.2), judged_as("L/V", 0.43)]
    assert summed_up(kept) == "all 2 kept, most used L/V (43%)."
    over = [*kept, *(judged_as(f"limit {k}", 1.0 + k, applies=False) for k in range(1, 6))]
    assert summed_up(over) == (
        "all 2 kept, most used L/V (43%). For comparison: 5 of 5 exceeded: limit 5 (600%), "
        "limit 4 (500%), limit 3 (400%) and 2 more."
    )
    assert summed_up([]) == ""


def test_no_row_of_the_printed_table_takes_more_than_two_lines_of_80_columns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion(40.0, ratio=0.7).to_netcdf(tmp_path / "results.nc")
    monkeypatch.setenv("COLUMNS", "80")
    printed = CliRunner().invoke(main, ["assess", str(tmp_path), "--sections"]).stdout
    assert max(map(len, printed.replace(str(tmp_path), "DIR").splitlines())) <= 80
    rows = takewhile(str.strip, printed.partition("limits for this run")[2].splitlines()[1:])
    folded = [not line[50:].strip() for line in rows]
    assert not any(one and following for one, following in pairwise(folded))


def test_folder_without_results_is_refused(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["assess", str(tmp_path)])
    assert result.exit_code == 2
    assert f"there is no results.nc in '{tmp_path}'; name the folder" in result.stderr


def test_what_the_track_does_not_move_is_not_excited_rather_than_passed_with_nothing() -> None:
    table = assess(motion(20.0, ay=1.0))
    assert row(table, "carbody_vertical_transient")["result"] == "not excited"
    assert row(table, "wheel_load_ratio")["result"] == "not excited"
    assert np.isnan(row(table, "sperling_vertical")["share"])
    assert row(table, "carbody_lateral_transient")["result"] == "passed"
    at_rest = motion(20.0, ay=1.0, az=1e-9, load=1e-12)
    for name in at_rest.data_vars:
        at_rest[name].attrs["units"] = {"az": "m/s2"}.get(str(name)[-2:], "")
    rounded = assess(at_rest)
    assert row(rounded, "carbody_vertical_transient")["result"] == "not excited"
    assert row(rounded, "wheel_load_ratio")["result"] == "not excited"
    bounced = assess(motion(20.0, az=1e-6, load=1e-3))
    assert row(bounced, "carbody_vertical_transient")["result"] == "passed"
    assert row(bounced, "wheel_load_ratio")["result"] == "passed"


def test_mean_comfort_of_a_sinusoid_is_six_times_its_weighted_rms() -> None:
    found = row(assess(motion(20.0, frequency=8.0, az=0.5)), "en_mean_comfort")
    expected = 6 * 0.5 / np.sqrt(2) * float(W_B.gain(np.array([8.0]))[0])
    assert found["value"] == pytest.approx(expected, rel=5e-3)
    assert found["result"] == "no limit"


def test_sections_are_whole_lengths_of_straight_and_full_curve() -> None:
    """Transitions are left out; a curve to the left has its outer rail on the right."""
    cut = parts([
        Section(STRAIGHT, 0.0, 560.0, 0.0, 0.0),
        Section(TRANSITION, 560.0, 620.0, 1 / 1000, 0.0),
        Section(CURVE, 620.0, 850.0, 1 / 500, 0.1),
        Section(CURVE, 900.0, 1000.0, -1 / 300, 0.1),
    ])  # fmt: skip
    assert [(p.zone.name, p.first, p.last, p.outer) for p in cut] == [
        ("straight", 0.0, 250.0, ""),
        ("straight", 250.0, 500.0, ""),
        ("small", 620.0, 720.0, "right"),
        ("small", 720.0, 820.0, "right"),
        ("very_small", 900.0, 970.0, "left"),
    ]


def test_what_is_expected_is_the_mean_and_some_deviations() -> None:
    mean, deviation, expected = estimate(np.array([1.0, 2.0, 3.0]), 3.0)
    assert (mean, deviation, expected) == (2.0, 1.0, 5.0)
    assert estimate(np.array([4.0]), 3.0)[2] == 4.0


def test_a_steady_car_in_a_curve_is_told_by_its_sections() -> None:
    """30 s straight, then 30 s of a curve of 500 m to the left: the outer wheels are the right."""
    data = motion(60.0, ratio=0.3, load=0.2, frequency=2.0)
    turned = np.where(data.time.values > 30.0, 1 / 500, 0.0)
    data["track.curvature"], data["track.cant"] = ("time", turned), ("time", 0.0 * turned)
    for axle in HOPPER.axles:
        data[f"{axle.wheelset}.right.l_over_v"] += 0.1
    table = by_sections(data).set_index(["zone", "quantity"])
    of_zone = {zone: table.loc[zone] for zone in table.index.levels[0]}
    straight, curve = of_zone["straight"], of_zone["curves of 400 to 600 m"]
    assert straight.loc["wheel load Q", "sections"] == 2  # of 548 m
    assert "quasi-static guiding force" not in straight.index
    guiding = curve.loc["quasi-static guiding force"]
    assert guiding["place"].endswith("right") and guiding["sections"] == 5
    assert guiding["estimate"] == pytest.approx(0.4 * AXLE_LOAD / 2e3, rel=0.01)
    assert guiding["limit"] == pytest.approx(30 + 10500 / 500, rel=1e-3)
    derailment = curve.loc["Y/Q of a leading wheel"]
    assert derailment["estimate"] == pytest.approx(0.4, rel=1e-6)
    load = straight.loc["wheel load Q"]
    assert load["estimate"] == pytest.approx(1.2 * AXLE_LOAD / 2e3, rel=0.01)
    assert not table["verified"].any()
