"""The two masters on systems whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, System, simulate
from orchestrator.errors import SlaveError
from orchestrator.slaves.inline import InlineSlave
from support.coupled_models import (
    damped_mass,
    damper,
    largest_displacement_error,
    order,
    oscillator,
)

MASTERS = ("one-pass", "jacobi")
LBF = 4.4482216152605
STEPS = (0.02, 0.01, 0.005, 0.0025)


def errors(master: str, **kind) -> list[float]:
    return [
        largest_displacement_error(simulate(oscillator(**kind), duration=10, step=h, master=master))
        for h in STEPS
    ]


def test_jacobi_has_the_known_errors_of_held_inputs_with_refreshed_feedthrough():
    known = [2.467e-2, 1.225e-2, 6.107e-3, 3.049e-3]
    assert errors("jacobi") == pytest.approx(known, rel=tolerances.DUAL_MASS)


def test_one_pass_is_of_second_order_and_as_good_as_an_iterated_coupling():
    found = errors("one-pass")
    assert abs(order(found) - 2.0) < tolerances.COUPLING_ORDER
    iterated = np.array([4.031e-4, 1.013e-4, 2.539e-5, 6.357e-6])
    assert np.all(np.array(found) < 1.5 * iterated)


def test_one_pass_extrapolates_where_no_rate_is_declared_and_stays_of_second_order():
    found = errors("one-pass", rates=False)
    assert abs(order(found) - 2.0) < tolerances.COUPLING_ORDER


def test_inputs_that_cannot_be_interpolated_are_given_their_mean_and_it_stays_of_second_order():
    found = errors("one-pass", interpolates_inputs=False)
    assert abs(order(found) - 2.0) < tolerances.COUPLING_ORDER
    run = simulate(oscillator(interpolates_inputs=False), duration=0.1, step=0.01)
    assert (
        "3 of 3 inputs are constant over each step at their mean, since the FMU takes no "
        in str(run.notes)
    )


@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
def test_compiled_loop_and_python_give_the_same_bits(master):
    for system in (oscillator(), damped_mass(3.0, slope=0.5)):
        twins = [
            simulate(system, duration=0.5, step=0.01, master=master, compiled=compiled)
            for compiled in (True, False)
        ]
        assert twins[0].record.tobytes() == twins[1].record.tobytes()
        assert twins[0].bonds == twins[1].bonds
        assert np.ptp(twins[0].record, axis=0).max() > 0.0


def test_tangent_of_a_stiff_damper_is_exact_where_held_coupling_blows_up():
    """c H / m = 100; held coupling is stable up to 2. The ground's ramp enters by its rate."""
    c, slope, h = 1e3, 0.5, 0.1
    run = simulate(damped_mass(c, slope=slope), duration=2, step=h)
    t = run.time
    exact = slope * (t - 1 / c) + (1.0 + slope / c) * np.exp(-c * t)
    np.testing.assert_allclose(run.dataset["mass.v"], exact, atol=tolerances.ROUNDING)
    held = simulate(damped_mass(c, slope=slope), duration=2, step=h, master="jacobi")
    assert np.abs(held.dataset["mass.v"]).max() > 1e6


def test_held_coupling_of_a_damper_is_stable_up_to_twice_mass_over_damping():
    for ratio, bounded in ((1.9, True), (2.1, False)):
        run = simulate(damped_mass(ratio / 0.01), duration=2, step=0.01, master="jacobi")
        assert bool(np.abs(run.dataset["mass.v"]).max() <= 1.0) is bounded


def test_tangent_decides_that_the_mass_steps_before_its_damper_and_after_the_ground():
    run = simulate(damped_mass(1.0), duration=0.1, step=0.01)
    assert "1 of 3 inputs follow a tangent of their source" in run.notes
    assert "2 of 3 inputs are linear between the known ends of the step" in run.notes


def test_without_derivatives_of_the_damper_the_mass_is_coupled_as_well_as_it_allows():
    """No tangent, so the damper steps first with an extrapolated velocity: second order."""
    found = []
    for h in (0.02, 0.01, 0.005):
        system = damped_mass(2.0, tangents=())
        run = simulate(system, duration=1, step=h)
        exact = np.exp(-2.0 * run.time)
        found.append(float(np.max(np.abs(run.dataset["mass.v"] - exact))))
    assert abs(order(found) - 2.0) < tolerances.COUPLING_ORDER
    assert any("extrapolated from the last values: damper.v" in note for note in run.notes)
    assert any("damper steps first, with damper.v extrapolated" in note for note in run.notes)


def test_tangent_of_a_source_without_input_derivatives_moves_with_its_other_inputs():
    """What the damper takes of its inputs has no part in how fast they change."""
    plain = damped_mass(2.0, slope=0.5)
    runs = [
        simulate(system, duration=0.5, step=0.01)
        for system in (plain, plain.with_fmu("damper", damper(2.0, interpolates_inputs=False)))
    ]
    assert "1 of 3 inputs follow a tangent of their source" in runs[1].notes
    np.testing.assert_array_equal(runs[0].record, runs[1].record)


def test_units_are_converted_in_values_rates_and_tangents():
    c, foot = 50.0, 0.3048
    in_feet = damper(
        c,
        inputs={"v": "ft/s", "ground_v": "ft/s"},
        outputs={"force": "lbf"},
        output=lambda x, u, p: {"force": -c * foot * (u["v"] - u["ground_v"]) / LBF},
        directional=lambda x, u, p, seed: {
            "force": -c * foot * (seed["v"] - seed["ground_v"]) / LBF
        },
    )
    plain = damped_mass(c, slope=0.3)
    for master in MASTERS:
        runs = [
            simulate(system, duration=1, step=0.02, master=master)
            for system in (plain, plain.with_fmu("damper", in_feet))
        ]
        for name in ("mass.v", "mass.x"):
            np.testing.assert_allclose(
                runs[0].dataset[name], runs[1].dataset[name], atol=tolerances.ROUNDING
            )
        # Of the energies that the bond compares, too.
        assert runs[1].bonds == [] and len(runs[0].bonds) == 1
        assert f"drives damper.v [ft/s]: converted, times {1 / foot:g}" in " ".join(runs[1].notes)


def test_gains_that_never_change_are_a_tangent_as_a_function_is():
    stated = damper(50.0, directional=None, gains={"force": {"v": -50.0, "ground_v": 50.0}})
    plain = damped_mass(50.0, slope=0.3)
    runs = [
        simulate(system, duration=1, step=0.02)
        for system in (plain, plain.with_fmu("damper", stated))
    ]
    assert "1 of 3 inputs follow a tangent of their source" in runs[1].notes
    np.testing.assert_array_equal(runs[0].record, runs[1].record)


def test_gains_that_never_change_are_asked_of_no_python(monkeypatch):
    def asked(*_):
        raise AssertionError("Python was asked for constant gains")

    monkeypatch.setattr(InlineSlave, "_directional", asked)
    stated = damper(50.0, directional=None, gains={"force": {"v": -50.0, "ground_v": 50.0}})
    system = damped_mass(50.0, slope=0.3).with_fmu("damper", stated)
    compiled, plain = (simulate(system, duration=0.2, step=0.02, compiled=c) for c in (True, False))
    assert compiled.completed
    np.testing.assert_array_equal(compiled.record, plain.record)


def test_gains_of_a_port_that_is_not_there_are_refused():
    misspelt = damper(50.0, directional=None, gains={"force": {"velocity": -50.0}})
    system = damped_mass(50.0).with_fmu("damper", misspelt)
    with pytest.raises(SlaveError, match=r"damper: gains are given of 'velocity'.*ground_v"):
        simulate(system, duration=0.1, step=0.02)


def test_chain_of_feedthrough_is_evaluated_in_order_at_every_communication_point():
    """A source and three gains, listed backwards: all show the same instant."""
    doubling = InlineModel(
        inputs={"u": "1"},
        outputs={"y": "1"},
        depends={"y": ("u",)},
        output=lambda x, u, p: {"y": 2.0 * u["u"]},
    )
    clock = InlineModel(
        outputs={"y": "1"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: {"y": x},
    )
    system = System(
        {name: Component(doubling) for name in ("c", "b", "a")} | {"clock": Component(clock)},
        (Connection("clock.y", "a.u"), Connection("a.y", "b.u"), Connection("b.y", "c.u")),
    )
    for master in ("one-pass", "jacobi"):
        run = simulate(system, duration=1, step=0.1, master=master)
        np.testing.assert_allclose(run.dataset["c.y"], 8.0 * run.time, rtol=tolerances.ROUNDING)


def test_time_is_never_accumulated():
    run = simulate(oscillator(), duration=1.0, step=1e-3, start=5.0)
    assert np.array_equal(run.time, 5.0 + np.arange(1001) * 1e-3)


def test_steps_that_do_not_fill_the_duration_go_on_to_cover_it():
    run = simulate(oscillator(), duration=1.0, step=0.3)
    assert run.time[-1] == pytest.approx(1.2)
    assert any("1 s is no whole number of steps of 0.3 s" in note for note in run.notes)
    assert simulate(oscillator(), duration=0.3, step=0.1).time.size == 4


def test_share_of_time_inside_the_slaves_is_measured_on_request():
    assert simulate(oscillator(), duration=0.1, step=0.01).statistics.time_inside_fmus is None
    run = simulate(oscillator(), duration=0.1, step=0.01, measure=True)
    assert 0.0 < run.statistics.time_inside_fmus < 1.0
