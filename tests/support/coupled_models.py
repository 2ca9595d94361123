"""Small systems of mocks with known answers, for the tests of the orchestrator."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.linalg import expm

from orchestrator import Component, Connection, InlineModel, System, Tangent

# Dual mass oscillator: OMSimulator test suite, DualMassOscillator.System1 and .System2.
M1, K1, C1 = 1.0, 10.0, 0.2
M2, K2, C2 = 1.0, 20.0, 0.3
K12, C12 = 10.0, 0.5
X2_START = 0.5
WHOLE = np.array(
    [
        [0.0, 1.0, 0.0, 0.0],
        [-(K1 + K12) / M1, -(C1 + C12) / M1, K12 / M1, C12 / M1],
        [0.0, 0.0, 0.0, 1.0],
        [K12 / M2, C12 / M2, -(K2 + K12) / M2, -(C2 + C12) / M2],
    ]
)
"""The oscillator as one: d/dt (x1, v1, x2, v2)."""


@cache
def _exact(rows: tuple[tuple[float, ...], ...], states: int, step: float) -> np.ndarray:
    """Exponential over a step of a linear system whose inputs are u + rate * t + bend * t^2 / 2."""
    matrix = np.array(rows)
    inputs = matrix.shape[1] - states
    whole = np.zeros((states + 3 * inputs,) * 2)
    whole[:states, : states + inputs] = matrix
    whole[states:-inputs, states + inputs :] = np.eye(2 * inputs)
    return expm(whole * step)[:states]


def exact_step(rows, x, u, rate, step):
    """State after a step of d/dt x = rows (x, u); rates as a mock gets them, of order 1 or 2."""
    rates = np.array([np.append(r, 0.0)[:2] for r in rate])
    return _exact(rows, len(x), step) @ np.concatenate([x, u, rates[:, 0], rates[:, 1]])


def oscillator(*, rates: bool = True, **changes) -> System:
    """Two masses; the spring between them belongs to the second. Exact inside each slave.

    changes: of both mocks.
    """
    first = ((0.0, 1.0, 0.0), (-K1 / M1, -C1 / M1, 1.0 / M1))
    second = (
        (0.0, 1.0, 0.0, 0.0),
        (-(K2 + K12) / M2, -(C2 + C12) / M2, K12 / M2, C12 / M2),
    )
    one = InlineModel(
        inputs={"force": "N"},
        outputs={"x": "m", "v": "m/s", "a": "m/s2"},
        depends={"a": ("force",)},
        derivative_of={"v": "x", "a": "v"} if rates else {},
        initial=lambda p: np.zeros(2),
        step=lambda x, u, rate, p, time, step: exact_step(
            first, x, [u["force"]], [rate["force"]], step
        ),
        output=lambda x, u, p: {
            "x": x[0],
            "v": x[1],
            "a": (u["force"] - K1 * x[0] - C1 * x[1]) / M1,
        },
        **changes,
    )
    other = InlineModel(
        inputs={"x": "m", "v": "m/s"},
        outputs={"force": "N", "x2": "m"},
        depends={"force": ("x", "v")},
        initial=lambda p: np.array([X2_START, 0.0]),
        step=lambda x, u, rate, p, time, step: exact_step(
            second, x, [u["x"], u["v"]], [rate["x"], rate["v"]], step
        ),
        output=lambda x, u, p: {
            "force": K12 * (x[0] - u["x"]) + C12 * (x[1] - u["v"]),
            "x2": x[0],
        },
        **changes,
    )
    return System(
        {"one": Component(one), "other": Component(other)},
        (
            Connection("one.x", "other.x"),
            Connection("one.v", "other.v"),
            Connection("other.force", "one.force"),
        ),
    )


def oscillator_reference(steps: int, step: float) -> np.ndarray:
    """(x1, v1, x2, v2) at each step, shape (steps + 1, 4)."""
    forward = expm(WHOLE * step)
    rows = [np.array([0.0, 0.0, X2_START, 0.0])]
    for _ in range(steps):
        rows.append(forward @ rows[-1])
    return np.array(rows)


def largest_displacement_error(run) -> float:
    reference = oscillator_reference(run.time.size - 1, run.time[1])
    found = np.stack([run.dataset["one.x"], run.dataset["other.x2"]], axis=1)
    return float(np.max(np.abs(found - reference[:, [0, 2]])))


def order(errors) -> float:
    """Slope of the errors over step sizes that halve."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))


def mass(m: float = 1.0, v: float = 1.0, **changes) -> InlineModel:
    """A mass that takes the tangent of its force; exact."""

    def step(x, u, rate, p, time, step):
        slope = u["force_per_v"]
        rows = ((0.0, 1.0, 0.0), (0.0, slope / m, 1.0 / m))
        start = u["force"] - slope * x[1]
        return exact_step(rows, x, [start], [rate["force"]], step)

    given = {
        "inputs": {"force": "N", "force_per_v": "N.s/m"},
        "outputs": {"x": "m", "v": "m/s"},
        "derivative_of": {"v": "x"},
        "tangents": (Tangent("force", "v", "force_per_v"),),
        "initial": lambda p: np.array([0.0, v]),
        "step": step,
        "output": lambda x, u, p: {"x": x[0], "v": x[1]},
    }
    return InlineModel(**{**given, **changes})


def damper(c: float, **changes) -> InlineModel:
    """A damper to a moving ground, without states; the force is that on the mass."""
    given = {
        "inputs": {"v": "m/s", "ground_v": "m/s"},
        "outputs": {"force": "N"},
        "depends": {"force": ("v", "ground_v")},
        "output": lambda x, u, p: {"force": -c * (u["v"] - u["ground_v"])},
        "directional": lambda x, u, p, seed: {"force": -c * (seed["v"] - seed["ground_v"])},
    }
    return InlineModel(**{**given, **changes})


def ramp(slope: float, **changes) -> InlineModel:
    """A ground velocity that grows steadily."""
    given = {
        "outputs": {"v": "m/s"},
        "initial": lambda p: 0.0,
        "step": lambda x, u, rate, p, time, step: time + step,
        "output": lambda x, u, p: {"v": slope * x},
    }
    return InlineModel(**{**given, **changes})


def damped_mass(c: float, *, slope: float = 0.0, **changes) -> System:
    """A mass on a damper whose ground moves; `changes` are the mass's."""
    return System(
        {
            "damper": Component(damper(c)),
            "mass": Component(mass(**changes)),
            "ground": Component(ramp(slope)),
        },
        (
            Connection("damper.force", "mass.force"),
            Connection("mass.v", "damper.v"),
            Connection("ground.v", "damper.ground_v"),
        ),
    )


def two_mass(r: float, step: float) -> System:
    """A mass across a damper from a heavy one, r = c H / m, the damper in the heavy one's slave."""
    heavy, stiffness, damping = 1e4, 100.0, r / step
    first = ((0.0, 1.0, 0.0), (-K1 / M1, -C1 / M1, 1.0 / M1))
    second = (
        (0.0, 1.0, 0.0, 0.0),
        (-stiffness / heavy, -damping / heavy, stiffness / heavy, damping / heavy),
    )
    one = InlineModel(
        inputs={"force": "N"},
        outputs={"x": "m", "v": "m/s"},
        initial=lambda p: np.array([0.0, 1.0]),
        step=lambda x, u, rate, p, time, step: exact_step(
            first, x, [u["force"]], [rate["force"]], step
        ),
        output=lambda x, u, p: {"x": x[0], "v": x[1]},
    )
    other = InlineModel(
        inputs={"x": "m", "v": "m/s"},
        outputs={"force": "N"},
        depends={"force": ("x", "v")},
        initial=lambda p: np.zeros(2),
        step=lambda x, u, rate, p, time, step: exact_step(
            second, x, [u["x"], u["v"]], [rate["x"], rate["v"]], step
        ),
        output=lambda x, u, p: {
            "force": stiffness * (x[0] - u["x"]) + damping * (x[1] - u["v"]),
        },
    )
    return System(
        {"one": Component(one), "other": Component(other)},
        (
            Connection("one.x", "other.x"),
            Connection("one.v", "other.v"),
            Connection("other.force", "one.force"),
        ),
    )


def two_springs() -> System:
    """preCICE's oscillator (Schueller 2022): two masses by displacements, classical Runge-Kutta."""
    k, k12 = 4.0 * np.pi**2, 16.0 * np.pi**2

    def body(start: float) -> InlineModel:
        def step(x, u, rate, p, time, step):
            def slope(t, x):
                return np.array([x[1], k12 * (u["other"] + rate["other"] * t) - (k + k12) * x[0]])

            a = slope(0.0, x)
            b = slope(step / 2, x + step / 2 * a)
            c = slope(step / 2, x + step / 2 * b)
            return x + step / 6 * (a + 2 * b + 2 * c + slope(step, x + step * c))

        return InlineModel(
            inputs={"other": "m"},
            outputs={"x": "m"},
            initial=lambda p: np.array([start, 0.0]),
            step=step,
            output=lambda x, u, p: {"x": x[0]},
        )

    return System(
        {"one": Component(body(1.0)), "two": Component(body(0.0))},
        (Connection("one.x", "two.other"), Connection("two.x", "one.other")),
    )
