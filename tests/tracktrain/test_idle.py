"""A parameter that was set and has no say is told, and one that has is not."""

from __future__ import annotations

from orchestrator import Component, Connection, InlineModel, System, simulate
from tracktrain.idle import idle

MASS = InlineModel(
    outputs={"v": "m/s", "shown": "1"},
    inputs={"force": "N"},
    start={"mass": 1.0, "colour": 1.0, "stop": 9.0},
    initial=lambda p: 1.0,
    step=lambda v, u, rate, p, time, step: (
        v + step * (u["force"] + 10.0 * max(v - p["stop"], 0.0)) / p["mass"]
    ),
    output=lambda v, u, p: {"v": v, "shown": p["colour"]},
)
PUSH = InlineModel(
    outputs={"force": "N"},
    inputs={"v": "m/s"},
    output=lambda x, u, p: {"force": 2.0},
)
VALUES = {"mass": 1.0, "colour": 1.0, "stop": 9.0}
USUAL = {"master": "jacobi", "compiled": False}


def told(name, value):
    """What is said of a mass under a force of 2 N with one value set."""

    def system(**values):
        return System(
            {"mass": Component(MASS, {**VALUES, **values}), "push": Component(PUSH)},
            (Connection("mass.v", "push.v"), Connection("push.force", "mass.force")),
        )

    changed = system(**{name: value})
    run = simulate(changed, duration=2.0, step=0.01, **USUAL)
    return idle(run, changed, [("mass", name, str(value))], lambda change: system(), USUAL)


def test_a_parameter_that_moves_the_answer_is_not_told():
    assert told("mass", 2.0) == []


def test_a_parameter_that_comes_into_play_late_is_not_told():
    assert told("stop", 4.9) == []


def test_a_stop_that_is_not_reached_has_no_say():
    (said,) = told("stop", 8.0)
    assert said.startswith("mass.stop = 8.0 changed no bit of the run: here it has no say")


def test_what_moves_only_an_output_that_drives_nothing_is_told_with_that_output():
    (said,) = told("colour", 3.0)
    assert "no bit of the run but mass.shown, which drive nothing" in said


def test_a_value_that_is_the_default_is_told_as_such():
    assert told("mass", 1.0) == ["mass.mass = 1.0 is what it is without --set"]
