"""A system that blows up names who fed the growth, not only whose number overflowed first."""

from __future__ import annotations

import pytest

from orchestrator import Component, Connection, InlineModel, System, simulate
from support.coupled_models import damped_mass

RUN = {"duration": 200.0, "step": 0.1}


def growing(name: str, rate: float) -> InlineModel:
    """Multiplies what it remembers, and adds what comes in."""
    return InlineModel(
        inputs={"u": "m"},
        outputs={name: "m"},
        initial=lambda p: 1e-3,
        step=lambda x, u, rates, p, time, step: rate * x + u["u"],
        output=lambda x, u, p: {name: x},
    )


def test_neighbour_that_overflows_first_is_not_blamed():
    """The second one grows because the first does, and a thousand times as far."""
    system = System(
        {"first": Component(growing("x", 3.0)), "second": Component(growing("y", 0.5))},
        (Connection("first.x", "second.u"),),
    )
    amplified = InlineModel(
        inputs={"u": "m"}, outputs={"y": "m"}, depends={"y": ("u",)},
        output=lambda x, u, p: {"y": 1e9 * u["u"]},
    )  # fmt: skip
    system = system.with_fmu("second", amplified)
    run = simulate(system, **RUN)
    assert run.message is not None and run.message.startswith("second.y is inf at t = ")
    assert run.message.endswith("; first, not second, fed the growth")


def test_damper_with_the_wrong_sign_is_found_by_the_work_that_it_does():
    run = simulate(damped_mass(-200.0), duration=400.0, step=0.05)
    assert run.message is not None and run.message.startswith("mass.v is ")
    assert run.message.endswith("; damper, not mass, fed the growth")


@pytest.mark.parametrize("value", [float("inf"), float("nan")])
def test_number_that_overflows_without_growth_has_no_source(value):
    clock = InlineModel(
        outputs={"y": "s"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: {"y": value if x > 5.0 else x},
    )
    run = simulate(System({"clock": Component(clock)}), **RUN)
    assert run.message is not None and "fed the growth" not in run.message
