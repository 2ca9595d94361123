"""The largest stable macro step, predicted before the run."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from orchestrator import simulate
from support.coupled_models import damped_mass
from tracktrain.car.hopper import hopper_car

DAMPING = 100.0
"""Of a unit mass [N.s/m]."""


def limit(system, master="jacobi", order=0, step=1e-3):
    run = simulate(system, duration=step, step=step, master=master, order=order, self_test=True)
    return run.evidence.limit


@pytest.mark.parametrize("master", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize(("order", "ratio"), [(0, 2.0), (1, 1.0), (2, 6.0 / 11.0)])
def test_a_damper_against_a_mass_has_the_known_limits(master, order, ratio):
    found = limit(damped_mass(DAMPING), master, order, step=0.01)
    assert found.largest == pytest.approx(ratio / DAMPING, rel=tolerances.STEP_LIMIT)
    assert found.connection == "damper.force -> mass.force"


@pytest.mark.parametrize("master", ["one-pass", "iterated"])
def test_a_loop_that_is_followed_has_no_limit(master):
    assert limit(damped_mass(DAMPING), master).largest == np.inf


def test_a_mass_that_cannot_be_rolled_back_is_loaded_anew():
    found = limit(damped_mass(DAMPING, saves_state=False), step=0.01)
    assert found.largest == pytest.approx(2.0 / DAMPING, rel=tolerances.STEP_LIMIT)


def test_a_large_step_is_warned_of_with_what_to_do():
    run = simulate(damped_mass(DAMPING), duration=0.1, step=0.015, master="jacobi", self_test=True)
    (note,) = (note for note in run.notes if note.startswith("largest stable step"))
    assert note == (
        "largest stable step: about 0.02 s, by damper.force -> mass.force; the step of 0.015 s is "
        "0.75 of it"
    )
    assert run.attributes["largest_stable_step"] == pytest.approx(0.02)
    assert (
        "Take at most 10ms, or a master that follows the loop: one-pass where the FMUs offer "
        "tangents, iterated where they roll back."
    ) in str(run.verdict)
    assert run.verdict.advice[0].ways == (
        {"step": "10ms"},
        {"master": "one-pass"},
        {"master": "iterated"},
    )
    assert "The force in damper.force * mass.v jumps to and fro" in str(run.verdict)


@pytest.mark.parametrize(
    ("speed", "stable", "unstable"), [(20.0, 1.1e-3, 1.2e-3), (10.0, 0.55e-3, 0.6e-3)]
)
def test_the_hopper_car_with_held_inputs_grows_beyond_its_limit_and_not_below(
    speed, stable, unstable
):
    """Feet per second; a stick of creepage against a truck, c = 2 f/V."""
    car = hopper_car(speed=speed * 0.3048)
    found = limit(car)
    assert stable < found.largest < unstable
    assert ".axle[" in found.connection
    ends = {}
    for step in (stable, unstable):
        run = simulate(
            car, duration=1.0, step=step, master="jacobi", record=["wheelset_11.force_y"]
        )
        ends[step] = np.abs(run.record).max()
    assert ends[stable] < 1e4 < 1e8 < ends[unstable]


def test_the_hopper_car_in_one_pass_is_far_from_its_limit():
    found = limit(hopper_car(speed=3.048), master="one-pass")
    assert found.share < 0.2
