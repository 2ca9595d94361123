"""Values at the start are carried along the connections until they settle."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, OrchestratorError, System, simulate
from support.coupled_models import oscillator


def gain(factor: float, offset: float = 0.0, declared: bool = True) -> InlineModel:
    return InlineModel(
        inputs={"u": "1"},
        outputs={"y": "1"},
        depends={"y": ("u",)} if declared else {},
        output=lambda x, u, p: {"y": factor * u["u"] + offset},
    )


def ring(*factors: float) -> System:
    names = [f"gain_{n}" for n in range(len(factors))]
    components = {name: Component(gain(f, 1.0)) for name, f in zip(names, factors, strict=True)}
    links = tuple(
        Connection(f"{a}.y", f"{b}.u") for a, b in zip(names, [*names[1:], names[0]], strict=True)
    )
    return System(components, links)


def test_oscillator_starts_with_the_known_force_and_acceleration():
    first = simulate(oscillator(), duration=0.01, step=0.01).dataset.isel(time=0)
    assert first["other.force"] == pytest.approx(5.0)
    assert first["one.a"] == pytest.approx(5.0)


def test_chain_listed_backwards_is_settled_at_the_start():
    names = [f"gain_{n}" for n in range(6)]
    components = {name: Component(gain(2.0)) for name in reversed(names)}
    links = tuple(Connection(f"{a}.y", f"{b}.u") for a, b in pairwise(names))
    system = System(components, links)
    assert "inputs that nothing drives: gain_0.u = 0.0 1" in simulate(system, duration=0.1).notes
    run = simulate(system.with_value("gain_0.u", 1.0), duration=0.1, step=0.1)
    assert run.dataset["gain_5.y"].values == pytest.approx([64.0, 64.0])
    assert run.dataset["gain_0.u"].values == pytest.approx([1.0, 1.0])
    assert not any("nothing drives" in note for note in run.notes)


def test_contracting_loop_settles_and_is_named():
    run = simulate(ring(0.5, -0.8), duration=0.1, step=0.1)
    # a = 0.5 b + 1, b = -0.8 a + 1
    assert run.dataset["gain_0.y"][0] == pytest.approx(1.5 / 1.4, rel=tolerances.SETTLED)
    words = "algebraic loop, solved at every communication point:"
    assert f"{words} gain_1.y, gain_0.y" in run.notes
    np.testing.assert_allclose(run.dataset["gain_0.y"], 1.5 / 1.4, rtol=tolerances.SETTLED)


def test_loop_that_does_not_settle_is_refused_by_name():
    with pytest.raises(OrchestratorError) as caught:
        simulate(ring(1.0, 1.0), duration=0.1, step=0.1)  # a = a + 2
    assert str(caught.value) == (
        "the algebraic loop through gain_0.y does not converge in 100 evaluations "
        "(gain_0.y changes most) at the start"
    )


def test_value_that_is_not_finite_at_the_start_is_refused_by_name():
    system = System({"a": Component(gain(float("nan")))})
    with pytest.raises(OrchestratorError, match=r"^a\.y is nan at the start$"):
        simulate(system, duration=0.1, step=0.1)
