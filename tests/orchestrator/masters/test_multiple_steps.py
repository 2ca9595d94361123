"""FMUs that step once in several macro steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, OrchestratorError, System, simulate
from support.coupled_models import largest_displacement_error, order, oscillator


def seldom(system: System, **every: int) -> System:
    components = {
        name: replace(component, every=every.get(name, 1))
        for name, component in system.components.items()
    }
    return replace(system, components=components)


@pytest.mark.parametrize("slow", ["one", "other"])
@pytest.mark.parametrize(
    ("master", "slope"),
    [
        ({"master": "jacobi"}, 1.0),
        ({"master": "jacobi", "order": 1}, 2.0),
        ({"master": "gauss-seidel", "order": 1}, 2.0),
        ({"master": "one-pass"}, 2.0),
    ],
    ids=["jacobi", "jacobi-1", "gauss-seidel-1", "one-pass"],
)
def test_masters_keep_their_order_where_one_fmu_takes_four_steps_at_once(master, slope, slow):
    system = seldom(oscillator(), **{slow: 4})
    found = []
    for step in (0.01, 0.005, 0.0025):
        run = simulate(system, duration=8, step=step, **master)
        assert run.statistics.fmu_steps == pytest.approx(0.625)
        found.append(largest_displacement_error(run))
    assert abs(order(found) - slope) < tolerances.MULTIPLE_STEP_ORDER


def counting(steps: list[tuple[float, float]]) -> System:
    """A clock that tells when it steps, and a reader of its output, a parabola."""

    def step(x, u, rate, p, time, step):
        steps.append((time, step))
        return time + step

    clock = InlineModel(
        outputs={"y": "m"},
        initial=lambda p: 0.0,
        step=step,
        output=lambda x, u, p: {"y": x * x},
    )
    reader = InlineModel(inputs={"u": "m"}, outputs={"y": "m"}, depends={"y": ("u",)},
                  output=lambda x, u, p: {"y": u["u"]})  # fmt: skip
    return System(
        {"clock": Component(clock, every=4), "reader": Component(reader)},
        (Connection("clock.y", "reader.u"),),
    )


@pytest.mark.parametrize(("degree", "between"), [(0, 16.0), (1, 22.0), (2, 25.0)])
def test_slow_fmu_steps_over_its_whole_step_and_its_outputs_go_on_in_between(degree, between):
    steps: list[tuple[float, float]] = []
    run = simulate(counting(steps), duration=12.0, step=0.5, master="jacobi", order=degree)
    assert steps == [(2.0 * n, 2.0) for n in range(6)]
    found = run.dataset["reader.y"].sel(time=[2.0, 4.0, 5.0, 6.0, 12.0])
    assert found.values == pytest.approx([4.0, 16.0, between, 36.0, 144.0])


@pytest.mark.parametrize("master", ["jacobi", "gauss-seidel", "one-pass"])
def test_compiled_loop_and_python_give_the_same_bits(master):
    runs = [
        simulate(seldom(oscillator(), one=3), duration=0.5, step=0.01, master=master,
                 compiled=compiled)
        for compiled in (True, False)
    ]  # fmt: skip
    assert runs[0].record.tobytes() == runs[1].record.tobytes()
    assert np.ptp(runs[0].record, axis=0).max() > 0.0


def test_multiples_that_cannot_be_are_refused():
    for master, every, message in (
        (
            "iterated",
            3,
            "the master 'iterated' repeats single macro steps, and one would take several at once; "
            "choose one-pass, jacobi or gauss-seidel, or leave `every` out",
        ),
        ("jacobi", 0, "one cannot step every 0 macro steps; give a whole number of at least 1"),
    ):
        with pytest.raises(OrchestratorError) as caught:
            simulate(seldom(oscillator(), one=every), duration=1, step=0.1, master=master)
        assert str(caught.value) == message


def test_energy_residual_of_a_bond_with_a_slow_side_is_not_claimed():
    run = simulate(seldom(oscillator(), one=2), duration=1, step=0.1)
    assert run.bonds == []
    assert "no energy residual, since one side steps seldom: other.force * one.v" in run.notes
