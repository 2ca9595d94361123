"""Energy residual of the power that crosses a coupling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, PowerBond, System, simulate
from support.coupled_models import M1, damped_mass, order, oscillator


def spring_and_mass() -> System:
    """A mass on a spring, without loss: all energy crosses the bond."""
    spring = InlineModel(
        inputs={"end.v": "m/s"},
        outputs={"end.force": "N"},
        initial=lambda p: 0.1,
        step=lambda x, u, rate, p, time, h: x + u["end.v"] * h + 0.5 * rate["end.v"] * h * h,
        output=lambda x, u, p: {"end.force": -100.0 * x},
    )
    mass = InlineModel(
        inputs={"force": "N"},
        outputs={"v": "m/s"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, h: x + u["force"] * h + 0.5 * rate["force"] * h * h,
        output=lambda x, u, p: {"v": x},
    )
    return System(
        {"spring": Component(spring), "mass": Component(mass)},
        (Connection("spring.end.force", "mass.force"), Connection("mass.v", "spring.end.v")),
    )


def residuals(system: System, master: str) -> list[float]:
    found = []
    for step in (0.01, 0.005, 0.0025):
        (bond,) = simulate(system, duration=0.3, step=step, master=master).bonds
        found.append(abs(bond.residual))
    return found


def test_held_coupling_makes_energy_up_in_proportion_to_the_step():
    assert abs(order(residuals(spring_and_mass(), "jacobi")) - 1.0) < tolerances.COUPLING_ORDER


def test_one_pass_makes_up_less_by_an_order():
    held, led = (residuals(spring_and_mass(), master) for master in ("jacobi", "one-pass"))
    assert order(led) > 2.0 - tolerances.COUPLING_ORDER
    assert led[-1] < 0.02 * held[-1]


def test_residual_of_held_coupling_is_what_the_system_gained():
    """Held, the discrete system's own energy grows; the bond finds where it came from."""
    run = simulate(spring_and_mass(), duration=2, step=0.005, master="jacobi")
    v, x = run.dataset["mass.v"].values, run.dataset["spring.end.force"].values / -100.0
    energy = 0.5 * v**2 + 50.0 * x**2
    gained = energy[-1] - energy[0]
    assert gained > 0.05 * energy[0]
    assert abs(run.bonds[0].residual) == pytest.approx(gained, rel=tolerances.ENERGY_SUMS)


def test_coupling_that_is_exact_has_no_residual():
    """A force that grows linearly and a mass that feels it: the velocity is not linear, so the
    ends agree, and both sides see the same product of linear functions."""
    constant = damped_mass(0.0)
    (bond,) = simulate(constant, duration=1, step=0.1).bonds
    assert (bond.passed, bond.residual, bond.relative) == (0.0, 0.0, 0.0)
    pushed = System(
        {
            "actuator": Component(
                InlineModel(
                    inputs={"v": "m/s"},
                    outputs={"force": "N"},
                    output=lambda x, u, p: {"force": 3.0},
                )
            ),
            "mass": Component(
                InlineModel(
                    inputs={"force": "N"},
                    outputs={"v": "m/s", "a": "m/s2"},
                    depends={"a": ("force",)},
                    derivative_of={"a": "v"},
                    initial=lambda p: 0.0,
                    step=lambda x, u, rate, p, time, h: x + u["force"] * h,
                    output=lambda x, u, p: {"v": x, "a": u["force"]},
                )
            ),
        },
        (Connection("actuator.force", "mass.force"), Connection("mass.v", "actuator.v")),
    )
    (bond,) = simulate(pushed, duration=1, step=0.1).bonds
    assert bond.passed == pytest.approx(4.5)  # 3 N over the way of 1.5 m
    assert abs(bond.residual) < 1e-14


def test_bonds_are_found_by_unit_port_group_and_axis():
    """Two ports with two axes each between the same two slaves: four bonds, none across."""
    forces = {f"{port}.{n}": u for port in "ab" for n, u in (("force_y", "N"), ("moment_z", "N.m"))}
    motion = {f"{port}.{n}": u for port in "cd" for n, u in (("vy", "m/s"), ("wz", "rad/s"))}
    giver = InlineModel(
        outputs=forces,
        inputs={name.replace("c.", "a.").replace("d.", "b."): u for name, u in motion.items()},
        output=lambda x, u, p: dict.fromkeys(forces, 0.0),
    )
    taker = InlineModel(
        outputs=motion,
        inputs={name.replace("a.", "c.").replace("b.", "d."): u for name, u in forces.items()},
        output=lambda x, u, p: dict.fromkeys(motion, 0.0),
    )
    links = [
        Connection(f"g.{name}", f"t.{name.replace('a.', 'c.').replace('b.', 'd.')}")
        for name in forces
    ]
    links += [
        Connection(f"t.{name}", f"g.{name.replace('c.', 'a.').replace('d.', 'b.')}")
        for name in motion
    ]
    system = System({"g": Component(giver), "t": Component(taker)}, tuple(links))
    run = simulate(system, duration=0.1, step=0.1)
    assert sorted(bond.name for bond in run.bonds) == [
        "g.a.force_y * t.c.vy",
        "g.a.moment_z * t.c.wz",
        "g.b.force_y * t.d.vy",
        "g.b.moment_z * t.d.wz",
    ]


def test_bonds_that_are_given_are_the_ones():
    assert simulate(replace(oscillator(), bonds=()), duration=0.1, step=0.1).bonds == []
    system = replace(oscillator(), bonds=(PowerBond("other.force", "one.v"),))
    (bond,) = simulate(system, duration=0.1, step=0.1).bonds
    assert bond.name == "other.force * one.v"


def test_energy_through_the_bond_is_what_the_first_mass_took_up():
    step = 1e-3
    run = simulate(oscillator(), duration=0.5, step=step)
    v = run.dataset["one.v"].values
    force = run.dataset["other.force"].values
    power = np.trapezoid(np.abs(force * v), dx=step)
    assert run.bonds[0].passed == pytest.approx(power, rel=tolerances.TRAPEZOIDS)
    assert M1 == 1.0


def test_bond_in_other_units_is_in_joules():
    system = spring_and_mass()
    pounds = replace(
        system.components["spring"].fmu,
        outputs={"end.force": "lbf"},
        output=lambda x, u, p: {"end.force": -100.0 * x / 4.4482216152605},
    )
    system = replace(
        system.with_fmu("spring", pounds), bonds=(PowerBond("spring.end.force", "mass.v"),)
    )
    for master in ("one-pass", "jacobi"):
        runs = [
            simulate(s, duration=1, step=0.01, master=master) for s in (spring_and_mass(), system)
        ]
        a, b = (run.bonds[0] for run in runs)
        assert b.passed == pytest.approx(a.passed, rel=tolerances.ENERGY_SUMS)
        assert b.residual == pytest.approx(a.residual, rel=tolerances.ENERGY_SUMS)
