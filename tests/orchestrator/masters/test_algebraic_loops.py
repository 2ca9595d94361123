"""Loops of outputs that depend on inputs at the same instant are solved, at the start and on."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, InlineModel, OrchestratorError, System, simulate

MASTERS = ("one-pass", "jacobi", "gauss-seidel", "iterated")


def response(of) -> InlineModel:
    return InlineModel(
        inputs={"u": "1", "t": "s"},
        outputs={"y": "1"},
        depends={"y": ("u", "t")},
        output=lambda x, u, p: {"y": of(u["u"], u["t"])},
    )


def loop(first, second) -> System:
    clock = InlineModel(
        outputs={"t": "s"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: {"t": x},
    )
    return System(
        {"a": Component(response(first)), "b": Component(response(second)), "c": Component(clock)},
        (
            Connection("a.y", "b.u"),
            Connection("b.y", "a.u"),
            Connection("c.t", "a.t"),
            Connection("c.t", "b.t"),
        ),
    )


@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
@pytest.mark.parametrize("master", MASTERS)
def test_loop_of_gain_minus_three_converges_where_going_round_diverges(master, compiled):
    """a = -3 b + 4 + t, b = a + t: a = 1 - t / 2."""
    system = loop(lambda u, t: -3.0 * u + 4.0 + t, lambda u, t: u + t)
    run = simulate(system, duration=1.0, step=0.1, master=master, compiled=compiled)
    assert run.completed
    np.testing.assert_allclose(run.dataset["a.y"], 1.0 - 0.5 * run.time, atol=tolerances.SETTLED)
    np.testing.assert_allclose(run.dataset["b.y"], 1.0 + 0.5 * run.time, atol=tolerances.SETTLED)
    assert "algebraic loop, solved at every communication point: b.y, a.y" in run.notes


def test_nonlinear_loop_is_solved_at_every_point():
    """a = b^3 + t, b = 2 - 3 a: one real solution, with slopes from 0 to -27 on the way."""
    system = loop(lambda u, t: u**3 + t, lambda u, t: 2.0 - 3.0 * u)
    run = simulate(system, duration=1.0, step=0.05)
    a, b = run.dataset["a.y"], run.dataset["b.y"]
    np.testing.assert_allclose(a, b**3 + run.time, atol=tolerances.SETTLED)
    np.testing.assert_allclose(b, 2.0 - 3.0 * a, atol=tolerances.SETTLED)


def test_loops_of_loops_and_what_follows_them_are_read_in_order():
    """Two loops through the same two FMUs, the second fed by the first, and a reader behind."""
    two = InlineModel(
        inputs={"u": "1", "v": "1"},
        outputs={"y": "1", "z": "1"},
        depends={"y": ("u",), "z": ("u", "v")},
        output=lambda x, u, p: {"y": -2.0 * u["u"] + 3.0, "z": -4.0 * u["v"] + u["u"]},
    )
    same = InlineModel(
        inputs={"u": "1", "v": "1"},
        outputs={"y": "1", "z": "1"},
        depends={"y": ("u",), "z": ("v",)},
        output=lambda x, u, p: {"y": u["u"], "z": u["v"]},
    )
    reader = response(lambda u, t: 10.0 * u)
    links = [(f"{a}.{o}", f"{b}.{i}") for a, b in ("pq", "qp") for o, i in ("yu", "zv")]
    system = System(
        {"r": Component(reader), "p": Component(two), "q": Component(same)},
        tuple(Connection(*link) for link in [*links, ("p.z", "r.u")]),
    )
    run = simulate(system, duration=0.2, step=0.1, master="jacobi")
    np.testing.assert_allclose(run.dataset["p.y"], 1.0)  # y = -2 y + 3
    np.testing.assert_allclose(run.dataset["p.z"], 0.2)  # z = -4 z + y
    np.testing.assert_allclose(run.dataset["r.y"], 2.0)


@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
def test_loop_without_solution_is_named_and_what_was_computed_is_kept(compiled):
    """a = b^2 + t, b = a has solutions up to t = 1/4."""
    system = loop(lambda u, t: u * u + t, lambda u, t: u)
    run = simulate(system, duration=1.0, step=0.1, master="jacobi", compiled=compiled)
    assert run.message is not None
    assert run.message.startswith("the algebraic loop through a.y does not converge in 100 ")
    assert run.message.endswith("evaluations (a.y changes most) at t = 0.3 s")
    assert run.time[-1] == pytest.approx(0.2)
    smaller = 0.5 - np.sqrt(0.25 - run.time)
    np.testing.assert_allclose(run.dataset["a.y"], smaller, atol=tolerances.SETTLED)


def test_loop_without_solution_at_the_start_is_refused_by_name():
    system = loop(lambda u, t: u + 1.0, lambda u, t: u + 1.0)
    with pytest.raises(OrchestratorError) as caught:
        simulate(system, duration=0.1, step=0.1)
    assert str(caught.value) == (
        "the algebraic loop through a.y does not converge in 100 evaluations "
        "(a.y changes most) at the start"
    )
