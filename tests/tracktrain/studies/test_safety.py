"""The study of safety: what counts as safe, and what a car on profiles does in a curve."""

from __future__ import annotations

from math import inf

import pytest

from tracktrain.errors import TracktrainError
from tracktrain.geometry.layout import length_of
from tracktrain.studies.safety.cases import SAFETY, Case, Line, Profiles, Surroundings, highest_safe
from tracktrain.studies.safety.study import safety


def case(speed: float, share: float = 0.5, derailments: int = 0, stopped: str = "") -> Case:
    shares = {"aar_roll": 0.1, "wheel_l_over_v": share}
    return Case("empty", Line(), "cone", speed, shares, derailments, stopped)


def test_the_straight_is_as_long_as_the_curve():
    straight, curve = Line(), Line(450.0, 0.0762)
    assert length_of(straight.elements()) == length_of(curve.elements())
    assert straight.radius == inf and straight.title == "straight"


@pytest.mark.parametrize(
    ("unsafe", "reason"),
    [
        (case(20.0, share=1.01), SAFETY["wheel_l_over_v"]),
        (case(20.0, derailments=1), "derailment"),
        (case(20.0, stopped="the state grew without bound"), "run stopped"),
    ],
    ids=["limit", "derailment", "stopped"],
)
def test_a_speed_is_safe_below_the_first_that_is_not(unsafe, reason):
    safe, first = highest_safe([case(30.0), unsafe, case(10.0)])
    assert safe == 10.0 and first is unsafe and first.reason == reason
    assert highest_safe([case(30.0), case(10.0)]) == (30.0, None)


def test_profiles_are_those_of_both_sides_or_left_and_right(tmp_path):
    odd = tmp_path / "mine,new.csv"
    odd.touch()
    assert Profiles.of("worn,conical", "crown").right == ("conical", None)
    assert Profiles.of(("worn", "conical"), "crown,60e1") == Profiles(
        "worn", "crown", ("conical", "60e1")
    )
    assert Profiles.of("worn,worn", str(odd)) == Profiles("worn", str(odd))
    assert str(Profiles.of("worn,conical", str(odd))) == "worn,conical on mine,new"
    for wrong in ("worn,", "worn,conical,worn", ""):
        with pytest.raises(TracktrainError, match="no wheel of both sides; give a file or a name"):
            Profiles.of(wrong, "crown")


@pytest.mark.slow
def test_unlike_sides_changed_over_have_the_same_critical_speed_and_are_unlike_in_a_curve():
    outcome = safety(
        cars=["loaded"],
        speeds=["30 mph"],
        radii=["300 m"],
        pairs=[("worn,conical", "crown"), ("conical,worn", "crown")],
        surroundings=Surroundings("perfect"),
    )
    left, right = outcome.tables["critical_speed_by_profiles"].drop(columns="mode").to_numpy()
    assert left.astype(float) == pytest.approx(right.astype(float), rel=1e-6)
    straight, curve = outcome.dataset.share.sel(limit="wheel_l_over_v").values.reshape(2, 2).T
    assert straight[0] == pytest.approx(straight[1], rel=1e-3)
    assert abs(curve[0] / curve[1] - 1) > 0.01


@pytest.mark.slow
def test_a_tighter_curve_takes_more_of_the_limit_and_a_lighter_car_climbs_first():
    outcome = safety(
        speeds=["30 mph"],
        radii=["900 m", "300 m"],
        pairs=[("worn", "crown")],
        surroundings=Surroundings("perfect"),
    )
    shares = outcome.dataset.share.sel(limit="en_derailment").values.reshape(2, 3)
    assert (shares[:, 2] > 1.3 * shares[:, 1]).all()  # radius 300 m against 900 m
    assert not outcome.dataset.derailments.values.any()
    for name in ("critical_speed_by_conicity", "critical_speed_by_profiles"):
        table = outcome.tables[name]
        assert (table["5 % [mph]"] < table["95 % [mph]"]).all()
    critical = outcome.tables["critical_speed_by_conicity"]["critical speed [mph]"]
    assert critical.loc[:, "loaded"].is_monotonic_decreasing
