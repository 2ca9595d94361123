"""Exact motion of one mode over a step, for a force that is linear over the step."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import casadi as ca

SERIES_BELOW = 0.5
"""Phase angle w h below which the closed form would cancel and the power series is used."""

TERMS = 14
"""Terms of the series: the first one left out is below 1e-17 of the sum."""


@dataclass(frozen=True)
class Transition:
    """What one step h does to a mode q'' + 2 zeta w q' + w^2 q = f + f' t.

    q(h) = q_q q + q_v q' + q_f f + q_ramp f', and q'(h) = v_q q + v_v q' + v_f f + v_ramp f'.
    """

    q_q: ca.SX
    q_v: ca.SX
    q_f: ca.SX
    q_ramp: ca.SX
    v_q: ca.SX
    v_v: ca.SX

    @property
    def v_f(self) -> ca.SX:
        """The rate of the step response is the impulse response."""
        return self.q_v

    @property
    def v_ramp(self) -> ca.SX:
        """The rate of the ramp response is the step response."""
        return self.q_f

    @property
    def column(self) -> ca.SX:
        """All coefficients in the order of the fields."""
        return ca.vertcat(self.q_q, self.q_v, self.q_f, self.q_ramp, self.v_q, self.v_v)

    def apply(self, q: ca.SX, v: ca.SX, f: ca.SX, ramp: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Coordinate and rate at the end of the step."""
        return (
            self.q_q * q + self.q_v * v + self.q_f * f + self.q_ramp * ramp,
            self.v_q * q + self.v_v * v + self.v_f * f + self.v_ramp * ramp,
        )


def rigid(h: ca.SX) -> Transition:
    """Transition of a mode without stiffness and damping. README (5)"""
    one, zero = ca.SX(1), ca.SX(0)
    return Transition(one, h, h * h / 2, h * h * h / 6, zero, one)


def oscillator(w: ca.SX, zeta: ca.SX, h: ca.SX) -> Transition:
    """Transition of a mode of frequency w [rad/s] >= 0 and damping ratio 0 <= zeta < 1. README (6)

    The ramp response follows from a series or in closed form; the rest from what relates them:
    with g the impulse, s the step and r the ramp response, r' = s, s' = g,
    g' + 2 sigma g + w^2 s = 1 and g + 2 sigma s + w^2 r = h.
    """
    sigma, w2 = zeta * w, w * w
    wd = w * ca.sqrt(1 - zeta * zeta)
    small = w * h < SERIES_BELOW

    safe = ca.if_else(small, 1, w)  # keeps the branch that is not taken finite
    safe_d = safe * ca.sqrt(1 - zeta * zeta)
    decay = ca.exp(-sigma * h)
    sine = decay * ca.sin(wd * h) / safe_d
    cosine = decay * ca.cos(wd * h)
    step_closed = (1 - cosine - sigma * sine) / (safe * safe)
    ramp_closed = (h - sine - 2 * sigma * step_closed) / (safe * safe)

    step_series, ramp_series = _series(sigma * h, w2 * h * h)
    s = ca.if_else(small, step_series * h * h, step_closed)
    r = ca.if_else(small, ramp_series * h * h * h, ramp_closed)
    g = h - 2 * sigma * s - w2 * r
    return Transition(
        q_q=1 - w2 * s, q_v=g, q_f=s, q_ramp=r, v_q=-w2 * g, v_v=1 - 2 * sigma * g - w2 * s
    )


def _series(a: ca.SX, b: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Step response over h^2 and ramp response over h^3, for a = sigma h and b = (w h)^2.

    The derivatives of the impulse response at the start, in units of h, follow
    g(n+2) = -2 a g(n+1) - b g(n) with g(0) = 0, g(1) = 1.
    """
    before, now = ca.SX(0), ca.SX(1)
    step, ramp = ca.SX(0), ca.SX(0)
    for n in range(1, TERMS + 1):
        step += now / factorial(n + 1)
        ramp += now / factorial(n + 2)
        before, now = now, -2 * a * now - b * before
    return step, ramp
