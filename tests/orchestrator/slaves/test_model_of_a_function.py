"""A function of inputs as a component."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrator import Component, Connection, InlineModel, System, simulate

MASS, STIFFNESS, DAMPING = 10.0, 4e3, 20.0


def mass() -> InlineModel:
    """Exact over a step in which the force is linear."""
    return InlineModel(
        inputs={"force": "N"},
        outputs={"x": "m", "v": "m/s"},
        derivative_of={"v": "x"},
        initial=lambda p: (0.01, 0.0),
        step=lambda x, u, rate, p, time, h: (
            x[0] + x[1] * h + (u["force"] / 2 + rate["force"] * h / 6) * h**2 / MASS,
            x[1] + (u["force"] + rate["force"] * h / 2) * h / MASS,
        ),
        output=lambda x, u, p: {"x": x[0], "v": x[1]},
    )


def coupled(spring: InlineModel) -> System:
    links = (("mass.x", "spring.x"), ("mass.v", "spring.v"), ("spring.force", "mass.force"))
    components = {"mass": Component(mass()), "spring": Component(spring, {"stiffness": 4e3})}
    return System(components, tuple(Connection(*ends) for ends in links))


def spring() -> InlineModel:
    return InlineModel.of(
        lambda x, v, stiffness: -stiffness * x - DAMPING * v,
        {"x": "m", "v": "m/s"}, {"force": "N"}, stiffness=1.0,
    )  # fmt: skip


@pytest.mark.parametrize("master", ["one-pass", "jacobi", "iterated"])
def test_a_mass_on_a_function_swings_as_the_closed_form(master: str) -> None:
    run = simulate(coupled(spring()), master, duration=0.2, step=1e-3, compiled=False)
    damping = DAMPING / (2 * MASS)
    pulse = np.sqrt(STIFFNESS / MASS - damping**2)
    time = run.time
    wave = np.cos(pulse * time) + damping / pulse * np.sin(pulse * time)
    error = run["mass.x"].values - 0.01 * np.exp(-damping * time) * wave
    assert np.abs(error).max() < (5e-6 if master != "jacobi" else 1e-3)
    force = run["spring.force"].values
    np.testing.assert_allclose(
        force, -STIFFNESS * run["mass.x"].values - DAMPING * run["mass.v"].values, atol=1e-9
    )


def test_the_derivatives_of_a_function_are_its_differences() -> None:
    model = InlineModel.of(
        lambda car_y, gain: {"a": gain * np.sin(car_y), "b": car_y**2},
        {"car.y": "m"}, {"a": "1", "b": "m2"}, gain=3.0,
    )  # fmt: skip
    found = model.directional(None, {"car.y": 0.4}, {"gain": 3.0}, {"car.y": 2.0})
    assert found == pytest.approx({"a": 6.0 * np.cos(0.4), "b": 1.6}, rel=1e-9)
    assert model.description.gives_derivatives
    assert model.description.variables["a"].dependencies == {"car.y"}


def test_a_function_that_takes_another_name_is_told() -> None:
    wrong = InlineModel.of(lambda x, w: x + w, {"x": "m", "v": "m/s"}, {"force": "N"})
    system = coupled(wrong)
    system = System({**system.components, "spring": Component(wrong)}, system.connections)
    with pytest.raises(Exception, match=r"spring.*unexpected keyword argument 'v'"):
        simulate(system, duration=0.01, step=1e-3, compiled=False)
