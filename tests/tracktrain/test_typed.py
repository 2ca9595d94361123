"""What is advised is shown with what to type for it."""

from __future__ import annotations

import re

import pytest

from fmus.describe.ranges import read_range
from fmus.wheelrail.profiled import RANGE, ProfiledWheelRail
from orchestrator import Advice, Kind, Outcome, describe
from tracktrain.car.hopper import hopper_car
from tracktrain.cli.commands.run import command
from tracktrain.options.chosen import Shape, chosen_car
from tracktrain.typed import typed


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("as it is", "as it is"),
        (Advice("wait"), "wait"),
        (Advice("halve it", {"step": "0.5ms"}), "halve it (--step 0.5ms)"),
        (
            Advice("do so", {"step": "1ms", "verify": ""}, {"fmu_tolerance": "1e-3"}),
            "do so (--step 1ms --verify or --fmu-tolerance 1e-3)",
        ),
    ],
)
def test_advice_is_shown_with_the_options_of_each_way(text, shown):
    assert typed(text) == shown


def test_a_step_that_does_not_converge_is_told_with_the_options_of_what_helps():
    said = str(Outcome(Kind.NOT_CONVERGED, 0.1, "a, b", "a.y", "moves", evaluations=100))
    assert typed(said).endswith(
        "give a shorter step, another method or a larger tolerance (--step or --method or "
        "--tolerance)"
    )


def remedies() -> list[str]:
    """What the FMUs of a car, on cones and on profiles, say that helps."""
    found = [limit for c in hopper_car().components.values() for limit in describe(c.file).limits]
    return [limit.remedy for limit in [*found, *read_range(RANGE, ProfiledWheelRail.outputs)]]


def test_what_fmus_say_that_helps_can_be_typed():
    options = {name for param in command.params for name in param.opts}
    for remedy in remedies():
        own = re.sub("`tracktrain (params|profile) .*?`|'tracktrain profile .*?'", "", remedy)
        assert {*re.findall(r"--[a-z-]+", own)} <= options, remedy
    given = {each for remedy in remedies() for each in re.findall("--set '(.*?)'", remedy)}
    assert {each.partition("=")[0] for each in given} == {"*.creep_law", "*.speed_floor"}
    for each in given:
        name, _, value = each.partition("=")
        instance, _, parameter = name.partition(".")
        chosen_car(Shape(settings=[(instance, parameter, value)]))
