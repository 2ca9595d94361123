"""Connections with a transformation, and a system's own experiment."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from orchestrator import (
    Component,
    Connection,
    Experiment,
    InlineModel,
    Linear,
    OrchestratorError,
    System,
    Table,
    simulate,
)
from orchestrator.system.transformation import composed
from support.coupled_models import oscillator


def thermometer(unit: str) -> InlineModel:
    return InlineModel(
        outputs={"t": unit}, start={"level": 20.0}, output=lambda x, u, p: {"t": p["level"]}
    )


def display(unit: str) -> InlineModel:
    return InlineModel(
        inputs={"t": unit},
        outputs={"shown": unit},
        depends={"shown": ("t",)},
        output=lambda x, u, p: {"shown": u["t"]},
    )


@pytest.mark.parametrize(
    ("suppress", "shown"),
    [(False, 2.0 * 68.0 + 1.0), (True, 2.0 * 20.0 + 1.0)],
)
@pytest.mark.parametrize("master", ["jacobi", "one-pass"])
def test_units_are_converted_first_and_the_line_applied_then(suppress, shown, master):
    link = Connection("room.t", "wall.t", Linear(2.0, 1.0), suppress_unit_conversion=suppress)
    system = System(
        {"room": Component(thermometer("degC")), "wall": Component(display("degF"))}, (link,)
    )
    run = simulate(system, duration=3e-3, master=master)
    assert run.dataset["wall.shown"].values == pytest.approx(shown, rel=tolerances.ROUNDING)
    assert any("transformed, times" in note for note in run.notes)


def test_line_does_what_a_slave_of_the_same_gain_would():
    """Half the mass under half the force moves alike."""
    plain = oscillator()
    halved = replace(
        plain,
        connections=tuple(
            replace(c, transformation=Linear(0.5)) if c.target == "one.force" else c
            for c in plain.connections
        ),
    )
    one, other = (simulate(s, duration=0.5).dataset["one.x"] for s in (plain, halved))
    assert not np.allclose(one, other)
    assert simulate(halved, duration=0.1).bonds == []  # it does not conserve power


def test_lines_compose_in_the_order_of_the_way():
    assert composed([Linear(2.0, 1.0), Linear(), Linear(3.0, -1.0)]) == Linear(6.0, 2.0)
    swap = Table("Integer", ((1, 2), (2, 1)))
    assert composed([swap, swap]) == Table("Integer", ((1, 1), (2, 2)))
    with pytest.raises(OrchestratorError, match="cannot follow each other"):
        composed([Linear(2.0), swap])
    twice = composed([Table("Integer", ((1, 2),)), Table("Integer", ((2, 3), (4, 5)))])
    assert [twice(n) for n in (1, 2, 3, 4)] == [3, 3, 3, 5]  # 3 is in neither


def test_table_between_real_variables_is_refused():
    system = oscillator()
    first, *rest = system.connections
    mapped = replace(first, transformation=Table("Boolean", ((True, False),)))
    with pytest.raises(
        OrchestratorError, match="through a map of kind Boolean, and it is of type Real"
    ):
        simulate(replace(system, connections=(mapped, *rest)), duration=0.1)


def test_experiment_of_the_system_is_run_unless_something_else_is_asked_for():
    system = replace(oscillator(), experiment=Experiment(start=1.0, stop=1.5, step=0.01))
    time = simulate(system).time
    assert (time[0], time[-1], len(time)) == (1.0, pytest.approx(1.5), 51)
    assert len(simulate(system, duration=0.1, step=0.02, start=0.0).time) == 6
    with pytest.raises(OrchestratorError, match="does not say how long to run; give a duration"):
        simulate(oscillator())
