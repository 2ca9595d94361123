"""Least squares over all evidence: estimates, noise levels, and how sure the estimates are.

The covariance is the sandwich of an estimate by least squares whose residuals may be correlated,
H^-1 M H^-1 with H = J'J and M = J' R J: R has the autocovariances of the residuals, tapered by
Bartlett's window (W. K. Newey, K. D. West, Econometrica 55 (1987) 703-708). Priors are further
residuals, taken as independent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.linalg import block_diag
from scipy.optimize import least_squares

from ..errors import TracktrainError
from .chosen import Chosen
from .evidence import Array, Evidence, Group

LEVELS = (0.90, 0.95)
"""Of the intervals."""

ROUNDS, SETTLED = 5, 0.03
"""Fits with noise levels of the one before, at most; relative change at which they have settled."""

CLOSE = 1e-3
"""Change of the sum of squared residuals, over their noise, at which a fit has converged."""

CALLS = 60
"""Of the model, without those for derivatives."""

FLOOR = 1e-9
"""Of an estimated noise level, over that which the fit began with."""

RARE = 3.3
"""Deviations, 1/sqrt(n), of the autocorrelation of white noise that one lag in 1000 exceeds."""

REACH = 3
"""Width of Bartlett's window over the longest lag with correlation, and the most of it over n."""
MOST = 0.25

BOUND = 1e-6
"""Distance from a bound, over the parameter's scale, at which it is at the bound."""

STAY = 3.0
"""Deviation from where the fit began, over the parameters' scales, of a weak pull back there. What
the data tell is moved by it by less than the square of its own deviation over this; what they do
not tell stays instead of drifting. It has no part in the intervals."""

DEAD = 1e-7
"""Singular value over the largest below which a direction counts as not told at all."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """Parameters as fitted, and what their certainty follows from.

    values [SI]. before, residuals, slopes: by group, at the start and at the values; slopes are by
    the parameters over their scales. noise: by group. covariance [SI]: of those that are at no
    bound. degrees: of freedom of the noise. calls: how often the model was asked.
    """

    chosen: Sequence[Chosen]
    groups: Sequence[Group]
    values: Array
    before: Sequence[Array]
    residuals: Sequence[Array]
    slopes: Sequence[Array]
    noise: Array
    converged: bool
    calls: int

    @property
    def scales(self) -> Array:
        return np.array([c.scale for c in self.chosen])

    @cached_property
    def at_bound(self) -> list[str]:
        """At which bound each parameter is, empty for none."""
        return [c.at_bound(v, BOUND) for c, v in zip(self.chosen, self.values, strict=True)]

    @cached_property
    def weighted(self) -> Array:
        """Derivatives of all residuals over their noise, without priors, by scaled parameters."""
        return np.vstack([j / s for j, s in zip(self.slopes, self.noise, strict=True)])

    @cached_property
    def _free(self) -> NDArray[np.intp]:
        return np.flatnonzero([not at for at in self.at_bound])

    @cached_property
    def covariance(self) -> Array:
        """Of all parameters [SI]; inf for what is not told, NaN for those at a bound."""
        return self._covariance(robust=True)

    @cached_property
    def plain_covariance(self) -> Array:
        """The same as if the residuals were independent."""
        return self._covariance(robust=False)

    def _covariance(self, robust: bool) -> Array:
        free, scales = self._free, self.scales
        prior = np.diag([(c.scale / c.deviation) ** 2 if c.deviation else 0.0 for c in self.chosen])
        meat = prior.copy()
        for group, r, j, s in zip(
            self.groups, self.residuals, self.slopes, self.noise, strict=True
        ):
            correlated = robust and group.ordered
            meat += _correlated(group, r / s, j / s) if correlated else j.T @ j / s**2
        whole = self.weighted.T @ self.weighted + prior
        found = np.full(whole.shape, np.nan)
        inverse, lost = _inverse(whole[np.ix_(free, free)])
        inner = inverse @ meat[np.ix_(free, free)] @ inverse
        inner[lost, lost] = np.inf
        found[np.ix_(free, free)] = inner
        return np.asarray(found * np.outer(scales, scales))

    @cached_property
    def degrees(self) -> float:
        """Of freedom of the estimated noise; inf where all of it was given."""
        if all(group.given for group in self.groups):
            return np.inf
        count = sum(
            _effective(group, r)
            for group, r in zip(self.groups, self.residuals, strict=True)
            if not group.given
        )
        return max(count - len(self._free), 1.0)

    @property
    def deviations(self) -> Array:
        """Standard deviations of the estimates [SI]."""
        return np.sqrt(np.diag(self.covariance))

    def interval(self, level: float) -> Array:
        """Bounds (parameters, 2) [SI]; the prior range bounds them."""
        reach = float(stats.t.ppf(0.5 + level / 2, self.degrees)) * self.deviations
        low, high = self.values - reach, self.values + reach
        bounds = np.array([[c.low, c.high] for c in self.chosen])
        return np.column_stack([np.fmax(low, bounds[:, 0]), np.fmin(high, bounds[:, 1])])

    @cached_property
    def correlation(self) -> Array:
        """Between the estimates; NaN where one is not told."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(self.covariance / np.outer(self.deviations, self.deviations))


def fit(
    chosen: Sequence[Chosen], evidence: Sequence[Evidence], begin: Array | None = None
) -> Fitted:
    """Fit the parameters to all evidence, within their ranges.

    begin: values [SI] from which the search begins, instead of the start values.

    Noise levels that are not given are estimated: the fit is repeated with those that the last one
    left, until they stay. Raises TracktrainError where there are too few numbers for that.
    """
    problem = _Problem(chosen, evidence)
    problem.check()
    x = np.array([c.start / c.scale for c in chosen])
    before = problem.residuals(x)
    if not all(np.all(np.isfinite(r)) for r in before):
        raise TracktrainError(
            "the model cannot be run with the values that the fit begins with; change them by --set"
        )
    if begin is not None:
        x = begin / problem.scales
    noise = np.array([group.deviation for group in problem.groups])
    if problem.only_one_unknown:
        noise = problem.estimated(before, None, noise)
    for _ in range(ROUNDS):
        result = problem.solved(x, noise)
        x = result.x
        residuals, slopes = problem.residuals(x), problem.slopes(x)
        new = problem.estimated(residuals, slopes, noise)
        settled = np.all(np.abs(new / noise - 1.0) < SETTLED)
        noise = new
        if settled or problem.only_one_unknown:
            break
    return Fitted(
        tuple(chosen),
        tuple(problem.groups),
        x * problem.scales,
        before,
        residuals,
        slopes,
        noise,
        bool(result.status > 0),
        problem.calls,
    )


class _Problem:
    """The residuals of all evidence and of the priors, over parameters in their scales."""

    def __init__(self, chosen: Sequence[Chosen], evidence: Sequence[Evidence]) -> None:
        self.chosen, self.evidence = chosen, evidence
        self.groups = [group for one in evidence for group in one.groups]
        self.scales = np.array([c.scale for c in chosen])
        self.priors = [(n, c) for n, c in enumerate(chosen) if c.deviation]
        self.calls = 0

    @property
    def only_one_unknown(self) -> bool:
        """Whether the noise levels do not change where the least squares are."""
        return len(self.groups) == 1 and not self.priors and not self.groups[0].given

    def check(self) -> None:
        count = sum(group.count for group in self.groups)
        if any(not g.given for g in self.groups) and count <= len(self.chosen):
            raise TracktrainError(
                f"{count} measured numbers cannot tell {len(self.chosen)} parameters and their own "
                "noise; give the deviation of each number, or choose fewer parameters"
            )

    def residuals(self, x: Array) -> list[Array]:
        self.calls += 1
        return [r for one in self.evidence for r in one.residuals(x * self.scales)]

    def slopes(self, x: Array) -> list[Array]:
        return [j * self.scales for one in self.evidence for j in one.slopes(x * self.scales)]

    def solved(self, x: Array, noise: Array) -> Any:
        """The result of the least squares, with noise levels by group."""
        own = np.repeat(noise, [group.count for group in self.groups])
        start = np.array([c.start for c in self.chosen]) / self.scales

        def values(at: Array) -> Array:
            priors = [(at[n] * c.scale - c.centre) / c.deviation for n, c in self.priors]
            pulls = (at - start) / STAY
            return np.concatenate([np.concatenate(self.residuals(at)) / own, priors, pulls])

        def slopes(at: Array) -> Array:
            rows = np.zeros((len(self.priors), len(x)))
            for row, (n, c) in zip(rows, self.priors, strict=True):
                row[n] = c.scale / c.deviation
            pulls = np.eye(len(x)) / STAY
            return np.vstack([np.vstack(self.slopes(at)) / own[:, None], rows, pulls])

        bounds = (
            np.array([c.low / c.scale for c in self.chosen]),
            np.array([c.high / c.scale for c in self.chosen]),
        )
        return least_squares(
            values,
            np.clip(x, bounds[0], bounds[1]),
            slopes,
            bounds=bounds,
            ftol=float(np.clip(CLOSE / len(own), 1e-10, 1e-4)),
            xtol=1e-9,
            gtol=1e-11,
            max_nfev=CALLS,
        )

    def estimated(
        self, residuals: Sequence[Array], slopes: Sequence[Array] | None, noise: Array
    ) -> Array:
        """Noise levels by group: squares over what is left of their number by the parameters."""
        used = np.zeros(len(self.groups))
        if slopes is not None:
            rows = [j / s for j, s in zip(slopes, noise, strict=True)]
            prior = block_diag(
                *[(c.scale / c.deviation) ** 2 if c.deviation else 0.0 for c in self.chosen]
            )
            inverse, _ = _inverse(np.vstack(rows).T @ np.vstack(rows) + prior)
            used = np.array([np.einsum("ij,jk,ik->", j, inverse, j) for j in rows])
        found = noise.copy()
        for n, (group, r) in enumerate(zip(self.groups, residuals, strict=True)):
            if not group.given:
                left = max(group.count - used[n], 1.0)
                found[n] = max(float(np.sqrt(r @ r / left)), FLOOR * group.deviation)
        return found


def _inverse(matrix: Array) -> tuple[Array, Array]:
    """Inverse where the matrix tells, and which parameters have a share in what it does not."""
    size = np.sqrt(np.diag(matrix))
    size[size == 0.0] = 1.0
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    told = values > DEAD**2 * max(values.max(initial=0.0), 1e-300)
    told &= values > 1e-15
    lost = np.any(np.abs(vectors[:, ~told]) > 1e-3, axis=1)
    kept = vectors[:, told]
    return (kept / values[told]) @ kept.T / np.outer(size, size), lost


def _correlated(group: Group, residuals: Array, slopes: Array) -> Array:
    """J' R J with the autocovariances of the residuals, by the discrete Fourier transform."""
    covariance = _window(group, residuals)
    found = np.zeros((slopes.shape[1],) * 2)
    for _, j in _pieces(group, slopes):
        n = len(j)
        size = 2 * n
        even = np.zeros(size)
        lags = min(len(covariance), n)
        even[:lags] = covariance[:lags]
        even[size - lags + 1 :] = covariance[1:lags][::-1]
        power = np.fft.rfft(even).real
        transformed = np.fft.rfft(j, size, axis=0)
        twice = np.full(len(power), 2.0)
        twice[[0, -1]] = 1.0
        found += ((transformed.conj() * (twice * power)[:, None]).T @ transformed).real / size
    return found


def _window(group: Group, residuals: Array) -> Array:
    """Autocovariance from lag 0 on, tapered by Bartlett's window."""
    n = max(group.lengths)
    total = np.zeros(n)
    for _, r in _pieces(group, residuals):
        transformed = np.fft.rfft(r, 2 * len(r))
        total[: len(r)] += np.fft.irfft(np.abs(transformed) ** 2)[: len(r)]
    total /= group.count
    most = max(int(MOST * n), 1)
    high = np.flatnonzero(np.abs(total[1:most]) > RARE / np.sqrt(group.count) * total[0])
    reach = min(REACH * (int(high[-1]) + 1) if len(high) else 1, most)
    return np.asarray(total[:reach] * (1.0 - np.arange(reach) / reach))


def _effective(group: Group, residuals: Array) -> float:
    """Independent numbers that tell as much of a variance (Bartlett 1946)."""
    if not group.ordered:
        return float(group.count)
    covariance = _window(group, residuals)
    squares = (covariance / covariance[0]) ** 2 if covariance[0] > 0 else np.ones(1)
    return float(group.count / (1.0 + 2.0 * squares[1:].sum()))


def _pieces(group: Group, rows: Array) -> list[tuple[int, Array]]:
    ends = np.cumsum(group.lengths)
    return [
        (int(end - length), rows[end - length : end])
        for end, length in zip(ends, group.lengths, strict=True)
    ]
