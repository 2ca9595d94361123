"""Which cars are tried, and what their answers say of the numbers: SALib's samples and indices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import TracktrainError

Array = NDArray[np.float64]

LEVEL = 0.95
"""Confidence level of the intervals."""

RESAMPLES = 100
"""Resamples of the bootstrap that the intervals are of."""

LEAST = 8
"""Base samples of a Sobol design below which its indices say nothing."""

NEEDED = 65
"""Runs that RBD-FAST needs for its ten harmonics; it wants many more."""


@dataclass(frozen=True)
class Indices:
    """Shares of a variance by number (numbers,), and half widths of their intervals.

    first: what would be gone if the number were known; total: what would be left if only it were
    unknown (nan where the design does not tell).
    """

    first: Array
    first_half: Array
    total: Array
    total_half: Array


@dataclass(frozen=True)
class Design:
    """points: (numbers, runs, seed) -> shares (runs, numbers) of 0 to 1; indices: (points, values
    (runs,), seed) -> their indices. A value may be nan where a run failed."""

    points: Callable[[int, int, int], Array]
    indices: Callable[[Array, Array, int], Indices]


def _salib() -> Any:
    try:
        import SALib.analyze.rbd_fast
        import SALib.analyze.sobol
        import SALib.sample.latin
        import SALib.sample.sobol
    except ImportError:
        raise TracktrainError(
            "the study needs SALib: python -m pip install 'tracktrain[build,uncertainty]'"
        ) from None
    return SALib


def _problem(count: int) -> dict[str, Any]:
    names = [f"x{n}" for n in range(count)]
    return {"num_vars": count, "names": names, "bounds": [[0.0, 1.0]] * count}


def _latin(count: int, runs: int, seed: int) -> Array:
    if runs < NEEDED:
        raise TracktrainError(f"{runs} runs are too few; give at least --runs {NEEDED}")
    return np.asarray(_salib().sample.latin.sample(_problem(count), runs, seed=seed))


def _rbd_fast(points: Array, values: Array, seed: int) -> Indices:
    there = np.isfinite(values)
    count = points.shape[1]
    none = np.full(count, np.nan)
    if there.sum() < NEEDED or np.ptp(values[there]) == 0.0:
        return Indices(none, none, none, none)
    found = _salib().analyze.rbd_fast.analyze(
        _problem(count),
        points[there],
        values[there],
        num_resamples=RESAMPLES,
        conf_level=LEVEL,
        seed=seed,
    )
    return Indices(np.asarray(found["S1"]), np.asarray(found["S1_conf"]), none, none)


def _saltelli(count: int, runs: int, seed: int) -> Array:
    base = 2 ** int(np.log2(max(runs // (count + 2), 1)))
    if base < LEAST:
        raise TracktrainError(
            f"Sobol's indices of {count} numbers need at least {LEAST * (count + 2)} runs, not "
            f"{runs}; give more --runs, or fewer numbers by --parameters"
        )
    problem = _problem(count)
    return np.asarray(
        _salib().sample.sobol.sample(problem, base, calc_second_order=False, seed=seed)
    )


def _sobol(points: Array, values: Array, seed: int) -> Indices:
    count = points.shape[1]
    blocks = values.reshape(-1, count + 2)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    none = np.full(count, np.nan)
    if len(whole) < LEAST or np.ptp(whole) == 0.0:
        return Indices(none, none, none, none)
    found = _salib().analyze.sobol.analyze(
        _problem(count),
        whole.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=LEVEL,
        seed=seed,
    )
    return Indices(*(np.asarray(found[key]) for key in ("S1", "S1_conf", "ST", "ST_conf")))


DESIGNS = {"latin": Design(_latin, _rbd_fast), "sobol": Design(_saltelli, _sobol)}
"""latin: Latin hypercube, first-order indices by RBD-FAST (Tarantola 2006, Plischke 2010), which
need no more runs for more numbers. sobol: Saltelli's design, first-order and total indices."""
