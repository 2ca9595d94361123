"""Masters held to figures that are known of them: stability limits, evaluations, orders, errors."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from orchestrator import System, simulate
from support.coupled_models import (
    damped_mass,
    largest_displacement_error,
    order,
    oscillator,
    two_mass,
    two_springs,
)

STEPS = (0.02, 0.01, 0.005, 0.0025)


def mass_first(c: float) -> System:
    system = damped_mass(c)
    names = ("mass", "damper", "ground")
    return System({name: system.components[name] for name in names}, system.connections)


def grows(ratio: float, steps: int = 240, **master) -> bool:
    """Whether a mass across a damper oscillates more and more, with r = c H / m."""
    step = 0.01
    run = simulate(mass_first(ratio / step), duration=steps * step, step=step, **master)
    speed = np.abs(run.dataset["mass.v"].values)
    third = steps // 3
    return bool(speed[-third:].max() > speed[third : 2 * third].max())


@pytest.mark.parametrize("master", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize(("degree", "limit"), [(0, 2.0), (1, 1.0), (2, 6.0 / 11.0)])
def test_damper_is_stable_up_to_the_adams_bashforth_limits(master, degree, limit):
    assert not grows(limit * (1.0 - tolerances.STABILITY_LIMIT), master=master, order=degree)
    assert grows(limit * (1.0 + tolerances.STABILITY_LIMIT), master=master, order=degree)


@pytest.mark.parametrize("ratio", [0.1, 0.9, 1.5, 1.9, 5.0, 1000.0])
@pytest.mark.parametrize("method", ["iqn-ils", "broyden"])
def test_quasi_newton_takes_five_evaluations_and_broyden_two_in_later_steps(ratio, method):
    run = simulate(
        two_mass(ratio, 0.01), duration=0.2, step=0.01, master="iterated", method=method,
        tolerance=1e-10,
    )  # fmt: skip
    (found,) = run.statistics.iterations
    assert found.most == 5
    assert found.mean < (2.5 if method == "broyden" else 5.1)
    assert run.statistics.fmu_steps == pytest.approx(found.mean)


def first_step_evaluations(ratio: float, method: str) -> float:
    run = simulate(
        two_mass(ratio, 0.01), duration=0.01, step=0.01, master="iterated", method=method,
        tolerance=1e-10, iterations=400,
    )  # fmt: skip
    return run.statistics.iterations[0].mean if run.completed else np.inf


def test_fixed_point_takes_as_many_evaluations_as_known_and_diverges_at_large_ratios():
    found = [first_step_evaluations(r, "fixed-point") for r in (0.1, 0.9, 1.5, 1.9, 5.0, 1000.0)]
    assert found[:3] == pytest.approx([15, 59, 157], rel=tolerances.EVALUATIONS)
    assert found[3:] == [np.inf] * 3


def test_aitken_takes_as_many_evaluations_as_known_and_diverges_at_a_stiff_coupling():
    found = [first_step_evaluations(r, "aitken") for r in (0.1, 0.9, 1.5, 1.9, 5.0, 1000.0)]
    assert found[:5] == pytest.approx([16, 44, 56, 66, 192], rel=tolerances.AITKEN_EVALUATIONS)
    assert found[5] == np.inf


DUAL_MASS = {
    "jacobi, 0": ({"master": "jacobi"}, (2.467e-2, 1.225e-2, 6.107e-3, 3.049e-3), 1.0),
    "jacobi, 1": (
        {"master": "jacobi", "order": 1}, (2.020e-3, 5.072e-4, 1.271e-4, 3.180e-5), 2.0,
    ),
    "jacobi, 2": (
        {"master": "jacobi", "order": 2}, (2.301e-4, 2.906e-5, 3.648e-6, 4.570e-7), 3.0,
    ),
    "gauss-seidel, 1": (
        {"master": "gauss-seidel", "order": 1}, (1.567e-3, 3.899e-4, 9.752e-5, 2.439e-5), 2.0,
    ),
    "iterated": ({"master": "iterated"}, (4.031e-4, 1.013e-4, 2.539e-5, 6.357e-6), 2.0),
}  # fmt: skip
"""Largest displacement error over 10 s, exact inside each slave, by macro step; and the order."""


@pytest.mark.parametrize("name", DUAL_MASS)
def test_dual_mass_oscillator_has_the_known_errors(name):
    master, known, slope = DUAL_MASS[name]
    system = oscillator(rates=False, input_order=2 if name == "jacobi, 2" else 1)
    steps = STEPS[:3]  # the last costs as much as these
    found = [
        largest_displacement_error(simulate(system, duration=10, step=h, **master)) for h in steps
    ]
    assert found == pytest.approx(known[:3], rel=tolerances.COUPLING_ERRORS[name])
    assert abs(order(found) - slope) < tolerances.COUPLING_ORDER


def test_line_with_the_mean_of_the_parabola_is_as_good_as_the_parabola():
    """For an FMU that takes first derivatives only, as FMI 2.0 lets it be assumed."""
    errors = [
        largest_displacement_error(
            simulate(oscillator(input_order=n), duration=10, step=0.02, master="jacobi", order=2)
        )
        for n in (1, 2)
    ]
    assert errors[0] == pytest.approx(errors[1], rel=tolerances.MEAN_LINE)


def two_springs_errors(counts, **master) -> list[float]:
    errors = []
    for count in counts:
        run = simulate(two_springs(), duration=1.0, step=1.0 / count, **master)
        exact = 0.5 * (np.cos(2 * np.pi * run.time) - np.cos(6 * np.pi * run.time))
        errors.append(float(np.max(np.abs(run.dataset["two.x"] - exact))))
    return errors


def test_waveforms_by_linear_interpolation_have_precice_errors():
    found = two_springs_errors((25, 50, 100, 200), master="iterated")
    assert found == pytest.approx([0.1088, 0.02676, 0.006632, 0.001660], rel=tolerances.DUAL_MASS)
    assert abs(order(found) - 2.0) < tolerances.COUPLING_ORDER


def test_staggered_held_coupling_has_precice_errors_and_first_order():
    found = two_springs_errors((50, 100, 200), master="gauss-seidel")
    assert found == pytest.approx([0.2059, 0.1040, 0.05221], rel=tolerances.STAGGERED)
    assert abs(order(found) - 1.0) < tolerances.COUPLING_ORDER
