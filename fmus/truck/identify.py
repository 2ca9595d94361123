"""Identification of an element's analog parameters from a measured loop, report section 4.2.4.

The loop is force over strain, sampled in time. The model is the block's own element, so that its
derivatives with respect to the parameters are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy import optimize, stats

from ..describe.elements import friction_force, slip_after, spring_force

PARAMETERS = ("stiffness", "stop_stiffness", "friction_stiffness", "friction_limit", "free_play")
"""K0, K1, Kf, f, Delta, as the truck block calls them."""

Array = NDArray[np.float64]
CONFIDENCE = 0.95
TOLD_WITHIN = 0.5
"""Half width of a confidence interval over the value, beyond which the data do not tell it."""

ZERO = 0.01
"""Share of the largest stiffness below which one is told to be none."""

STOP = frozenset({"stop_stiffness", "free_play"})

NEGLIGIBLE = 1e-3
"""Share of the largest strain or stiffness that no loop shows."""

SEARCHED = 400
"""Samples among which the search for a starting point is made."""


@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its confidence interval; `told` is whether the data determine it."""

    value: float
    low: float
    high: float
    told: bool


@dataclass(frozen=True)
class Identification:
    """Estimates by parameter, the force that they give, and what the data cannot tell.

    noise: standard deviation of the force about the model, in the force's unit.
    """

    estimates: dict[str, Estimate]
    model: Array
    noise: float
    offset: float
    remarks: tuple[str, ...]


def identify(strain: Array, force: Array) -> Identification:
    """Parameters of an element from its strain and force, sampled along at least one full cycle.

    Raises ValueError for samples that hold no cycle, are too few or are not finite.
    """
    strain, force = (np.asarray(v, float) for v in (strain, force))
    _check(strain, force)
    reach, span = float(np.ptp(strain)) / 2, float(np.ptp(force)) / 2
    scaled, load = strain / reach, force / span
    rough = slice(None, None, max(1, len(load) // SEARCHED))
    found = (_fit(scaled[rough], load[rough], guess) for guess in _guesses(scaled, load))
    best = _fit(scaled, load, min(found, key=lambda fit: fit.cost).x)
    p = _natural(best.x)
    degrees = max(len(load) - len(p), 1)
    noise = float(np.sqrt(2 * best.cost / degrees))
    slope = np.array(_jacobian(len(load))(scaled, p))
    silent = _silent(scaled, p)
    half = _half_widths(slope, noise, degrees, silent)
    if not half[1] < p[1]:  # a stop that the noise may have made
        silent |= STOP
        half = _half_widths(slope, noise, degrees, silent)
    units = np.array([span / reach] * 3 + [span, reach, reach, span])
    model = np.array(_force(len(load))(scaled, p)).ravel() * span
    return Identification(
        _estimates(scaled, p, half, units, silent),
        model,
        noise * span,
        float(p[6] * span),
        tuple(_remarks(scaled, p, units, silent)),
    )


@cache
def _force(samples: int) -> ca.Function:
    """(strain (n,), K0, K1, Kf, f, Delta, first slip, offset) -> force (n,)."""
    strain, slip, p = ca.SX.sym("strain"), ca.SX.sym("slip"), ca.SX.sym("p", 7)
    k0, k1, kf, limit, play, _, offset = ca.vertsplit(p)
    after = slip_after(strain, slip, limit / kf)
    force = spring_force(strain, k0, k1, play) + friction_force(strain, after, kf, limit) + offset
    one = ca.Function("one", [slip, strain, p], [after, force])
    history, parameters = ca.MX.sym("history", samples), ca.MX.sym("parameters", 7)
    _, forces = one.mapaccum(samples)(parameters[5], history.T, ca.repmat(parameters, 1, samples))
    return ca.Function("loop", [history, parameters], [forces.T])


@cache
def _jacobian(samples: int) -> ca.Function:
    function = _force(samples)
    history, parameters = ca.MX.sym("history", samples), ca.MX.sym("parameters", 7)
    slope = ca.jtimes(function(history, parameters), parameters, ca.DM.eye(7))
    return ca.Function("jacobian", [history, parameters], [slope])


def _natural(x: Array) -> Array:
    """The five parameters are searched by their logarithms, since all are above zero."""
    return np.concatenate([np.exp(x[:5]), x[5:]])


def _fit(strain: Array, force: Array, guess: Array) -> optimize.OptimizeResult:
    model, slope = _force(len(strain)), _jacobian(len(strain))

    def residual(x: Array) -> Array:
        return np.array(model(strain, _natural(x))).ravel() - force

    def jacobian(x: Array) -> Array:
        inner = np.concatenate([np.exp(x[:5]), np.ones(2)])
        return np.array(slope(strain, _natural(x))) * inner

    low, high = np.full(7, -np.inf), np.full(7, np.inf)
    low[:5], high[:5] = np.log(1e-7), np.log(1e5)
    return optimize.least_squares(
        residual, np.clip(guess, low + 1e-9, high - 1e-9), jacobian, (low, high), x_scale="jac",
        max_nfev=200,
    )  # fmt: skip


def _guesses(strain: Array, force: Array) -> list[Array]:
    """Starting points: friction from the loop's width in the middle, stops at several strains."""
    middle = np.abs(strain - strain.mean()) < 0.25
    line = np.polyfit(strain[middle], force[middle], 1)
    width = float(np.ptp((force - np.polyval(line, strain))[middle])) / 2
    limit = max(width, 1e-3)
    outer = max(float(np.polyfit(strain, force, 1)[0]), 1e-3)
    inner = max(float(line[0]), 0.02 * outer)
    return [
        np.concatenate([np.log([inner, stop, stuck, limit, play]), [strain[0], force.mean()]])
        for play in (0.3, 0.6, 0.85)
        for stop in (0.5 * outer, 5 * outer)
        for stuck in (3 * limit, 30 * limit)
    ]


def _half_widths(slope: Array, noise: float, degrees: int, silent: frozenset[str]) -> Array:
    """Half of each parameter's confidence interval; infinite where no sample depends on it."""
    seen = [n for n in range(slope.shape[1]) if n >= len(PARAMETERS) or PARAMETERS[n] not in silent]
    half = np.full(slope.shape[1], np.inf)
    factor = float(stats.t.ppf(0.5 + CONFIDENCE / 2, degrees))
    half[seen] = factor * _deviations(slope[:, seen], noise)
    return half


def _deviations(jacobian: Array, noise: float) -> Array:
    """Standard deviations of the parameters; infinite along what the data do not see."""
    _, singular, rows = np.linalg.svd(jacobian, full_matrices=False)
    seen = singular > 1e-9 * singular.max()
    variance = (rows[seen].T ** 2 / singular[seen] ** 2).sum(axis=1) * noise**2
    hidden = (rows[~seen].T ** 2).sum(axis=1) > 1e-6
    return np.where(hidden, np.inf, np.sqrt(variance))


def _silent(strain: Array, p: Array) -> frozenset[str]:
    """Parameters on which no sample depends, since none meets the stop or since none slips."""
    silent: set[str] = set()
    stop_met = p[4] < 0.999 * np.abs(strain).max() and p[1] > NEGLIGIBLE * max(p[0], p[2])
    if not stop_met or p[4] < NEGLIGIBLE:  # a stop without play is part of K0
        silent |= STOP
    if np.ptp(strain) <= 2 * p[3] / p[2] or p[3] < NEGLIGIBLE:  # stuck friction is part of K0
        silent |= {"friction_limit"}
    return frozenset(silent)


def _estimates(
    strain: Array, p: Array, half: Array, units: Array, silent: frozenset[str]
) -> dict[str, Estimate]:
    """Values and intervals; a parameter on which no sample depends has the bound from the data."""
    bounds = {
        "stop_stiffness": 0.0,
        "free_play": float(np.abs(strain).max()),
        "friction_limit": float(p[2] * np.ptp(strain) / 2),
    }
    stiffest = max(p[0], p[2])
    estimates = {}
    for place, name in enumerate(PARAMETERS):
        value, width, unit = float(p[place]), float(half[place]), float(units[place])
        if name in silent:
            estimates[name] = Estimate(np.nan, bounds[name] * unit, np.inf, False)
            continue
        if name == "stiffness" and "stop_stiffness" in silent and p[4] < NEGLIGIBLE:
            value += float(p[1])
        zero = place in (0, 2) and value + width < ZERO * stiffest
        low, high = max(value - width, 0.0), value + width
        told = bool(zero or width < TOLD_WITHIN * value)
        estimates[name] = Estimate(value * unit, low * unit, high * unit, told)
    return estimates


def _remarks(strain: Array, p: Array, units: Array, silent: frozenset[str]) -> list[str]:
    """What the loop cannot tell, and which experiment would tell it."""
    remarks = []
    reached = float(np.abs(strain).max())
    if "free_play" in silent:
        remarks.append(
            f"no stop was met up to {reached * units[4]:.4g}: its stiffness K1 cannot be told, and "
            f"the free play is at least that; drive the element further"
        )
    if "friction_limit" in silent:
        remarks.append(
            "the friction never slipped: only the sum of K0 and Kf shows, and the limit f is at "
            f"least {p[2] * float(np.ptp(strain)) / 2 * units[3]:.4g}; drive the element further"
        )
    stuck = 2 * p[3] / p[2]
    turning = _samples_stuck(strain, stuck)
    if "friction_limit" not in silent and turning < 4:
        remarks.append(
            f"only {turning} samples lie on the branches where friction sticks: Kf is poorly told; "
            "sample faster near the reversals"
        )
    return remarks


def _samples_stuck(strain: Array, width: float) -> int:
    """Largest number of samples within `width` behind a reversal."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(strain))) != 0) + 1
    counts = []
    for first, last in zip(turns, [*turns[1:], len(strain)], strict=True):
        counts.append(int((np.abs(strain[first:last] - strain[first]) < width).sum()))
    return max(counts, default=0)


def _check(strain: Array, force: Array) -> None:
    if strain.ndim != 1 or strain.shape != force.shape or len(strain) < 20:
        raise ValueError(
            f"strain has {strain.size} and force {force.size} samples; at least 20 of each are "
            "needed, and as many of one as of the other"
        )
    if not (np.isfinite(strain).all() and np.isfinite(force).all()):
        raise ValueError("strain or force has a value that is not finite; leave such samples out")
    if not (np.ptp(strain) > 0 and np.ptp(force) > 0):
        raise ValueError("strain or force does not change; a loop of at least one cycle is needed")
    steps = np.diff(strain)
    if not (steps.max() > 0 > steps.min()):
        raise ValueError("the strain never turns back; a loop of at least one full cycle is needed")
