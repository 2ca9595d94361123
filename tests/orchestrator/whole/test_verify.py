"""Runs that are verified: by smaller steps, and against the system as one."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, System, verify
from support.coupled_models import damped_mass, oscillator, oscillator_reference
from tracktrain.car.hopper import hopper_car

STEP = 0.01


def displacement(master: str, order: int = 0, **how):
    """The verified run, and its true error in the first displacement: rms, peak over the rms."""
    run = verify(
        oscillator(), outputs=["one.x"], duration=4, step=STEP, master=master, order=order, **how
    )
    exact = oscillator_reference(run.time.size - 1, STEP)[:, 0]
    off, size = run.dataset["one.x"].values - exact, np.sqrt(np.mean(exact**2))
    (found,) = run.evidence.refinement.errors
    return run, found, np.sqrt(np.mean(off**2)) / size, np.abs(off).max() / size


@pytest.mark.parametrize(
    ("master", "order", "known"),
    [("jacobi", 0, 1.0), ("jacobi", 1, 2.0), ("one-pass", 0, 2.0), ("gauss-seidel", 1, 2.0)],
)
def test_orders_and_errors_of_the_dual_mass_oscillator(master, order, known):
    _, found, rms, peak = displacement(master, order)
    assert abs(found.order - known) < tolerances.COUPLING_ORDER
    assert found.rms == pytest.approx(rms, rel=tolerances.ESTIMATED_ERROR)
    assert found.peak == pytest.approx(peak, rel=tolerances.ESTIMATED_ERROR)


def test_the_verdict_names_the_error_and_the_order():
    run, found, *_ = displacement("one-pass")
    assert run.verdict.level.value == "good"
    assert str(run.verdict).startswith(
        f"Coupling: good. Error of one.x about {100 * found.rms:.2g} % of its rms (order 2."
    )
    assert any("not compared with a monolithic twin" in note for note in run.notes)


def test_held_inputs_are_too_wrong_to_be_good():
    run, *_ = displacement("jacobi")
    assert run.verdict.level.value == "doubtful"
    assert "(order 1.0)" in str(run.verdict)
    assert "Take a smaller step, or another master." in str(run.verdict)


def test_what_has_no_order_is_said_to_have_none():
    """A map that doubles a phase each step: no step is small enough."""
    chaotic = InlineModel(
        inputs={"u": "m"},
        outputs={"y": "m"},
        initial=lambda p: 0.3,
        step=lambda x, u, rate, p, time, step: (x * 1.9 + 0.1 * step) % 1.0,
        output=lambda x, u, p: {"y": x},
    )
    system = System(
        {"a": Component(chaotic), "b": Component(chaotic)},
        (Connection("a.y", "b.u"), Connection("b.y", "a.u")),
    )
    run = verify(system, duration=1, step=STEP)
    assert not any(error.converges for error in run.evidence.refinement.errors)
    assert run.verdict.level.value == "bad"
    assert "smaller steps do not converge (no order observed) in a.y, b.y: the motion is" in str(
        run.verdict
    )


def test_a_quiet_system_is_exact():
    run = verify(damped_mass(1.0, v=0.0), duration=0.1, step=STEP)
    assert run.evidence.refinement.worst.rms == 0.0


def test_the_hopper_car_is_verified_against_its_twin():
    run = verify(hopper_car(), outputs=["wheelset_11.force_y"], duration=0.3, step=1e-3, twin=0.1)
    found = run.evidence.refinement
    assert found.worst.rms < 1e-3
    assert found.twin_span == 0.1
    assert [error.name for error in found.twin] == ["wheelset_11.force_y"]
    assert found.twin[0].rms < 1e-3
    assert "from the monolithic twin (wheelset_11.force_y, first 0.1 s)" in str(run.verdict)
