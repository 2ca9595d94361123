"""Which law a car's creep forces have where none is asked for: on cones, on profiles, in curves."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fmus.export.wheelrail import wheelrail_fmu
from orchestrator import simulate
from support.contact_tables import cone
from tracktrain.car.creep import laws
from tracktrain.options.chosen import Shape, chosen_car

NOTE = "creep forces by polach, which end at friction, as is the default"


HEAD = "kind,length [m],radius [m],direction,cant [mm]\nstraight,30,,,\n"
CURVE = "transition,30,,,\ncurve,60,290,left,50\n"


@pytest.fixture(scope="module")
def shapes(tmp_path_factory):
    """On cones, on profiles, in a curve, and on a line that has none."""
    folder = tmp_path_factory.mktemp("lines")
    curve, straight = folder / "curve.csv", folder / "straight.csv"
    curve.write_text(HEAD + CURVE)
    straight.write_text(HEAD)
    asked = Shape(speed=22.0, track="perfect")
    return {
        "cones": asked,
        "profiles": replace(asked, wheel=str(wheelrail_fmu(cone(flange=None)))),
        "curve": replace(asked, layout=curve),
        "straight": replace(asked, layout=straight),
    }


def said(car) -> list[str]:
    return [note for note in car.notes if note.startswith("creep forces")]


@pytest.mark.parametrize("where", ["cones", "straight"])
def test_on_cones_and_straight_track_the_law_is_that_of_the_report(shapes, where):
    car = chosen_car(shapes[where])
    assert laws(car) == "linear" and said(car) == []


@pytest.mark.parametrize(("where", "name"), [("profiles", "on profiles"), ("curve", "in curves")])
def test_on_profiles_and_in_curves_creep_forces_end_at_friction(shapes, where, name):
    car = chosen_car(shapes[where])
    assert laws(car) == "polach"
    assert said(car) == [
        f"{NOTE} {name}; those of linear do not: --set '*.creep_law=linear'",
    ]


@pytest.mark.parametrize("where", ["profiles", "curve"])
def test_a_law_that_is_asked_for_is_had(shapes, where):
    everywhere = replace(shapes[where], settings=[("*", "creep_law", "linear")])
    car = chosen_car(everywhere)
    assert laws(car) == "linear" and said(car) == []
    front = replace(shapes[where], settings=[("wheelset_1?", "creep_law", "fastsim")])
    car = chosen_car(front)
    assert laws(car) == "fastsim, polach"
    (note,) = said(car)
    assert note.startswith("creep forces of wheelset_21, wheelset_22 by polach")
    named = chosen_car(replace(shapes[where], car="report-linear"))
    assert laws(named) == "linear" and said(named) == []


def test_one_wheelset_on_profiles_has_a_law_of_its_own(shapes):
    swaps = [("wheelset_12", "", shapes["profiles"].wheel)]
    car = chosen_car(replace(shapes["cones"], swaps=swaps))
    assert laws(car) == "linear, polach"
    assert said(car)[0].startswith("creep forces of wheelset_12 by polach")


def test_no_wheel_asks_for_more_than_friction_in_a_sharp_curve(shapes):
    linear = replace(shapes["curve"], settings=[("*", "creep_law", "linear")])
    largest = []
    for shape in (shapes["curve"], linear):
        car = chosen_car(shape)
        run = simulate(car, duration=car.experiment.stop, record="*.saturation", every=5)
        largest.append(max(float(abs(values).max()) for values in run.dataset.values()))
    assert largest[0] <= 1.000001 < 1.5 < largest[1]
