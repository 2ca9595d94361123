"""The statistics that runs are told by, each with its interval, and whether two of them differ."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import hypot, isnan, nan

import numpy as np

from orchestrator import (
    Estimate,
    Response,
    Responses,
    Signal,
    frequency_of,
    peak_of,
    percentile_of,
    rms_of,
)

from .car.hopper import layout_of

Array = np.ndarray

LEVEL = 0.95
"""Share of the time in which a response stays below its level."""


def level_of(response: Response) -> Estimate:
    """The absolute value that is not exceeded for `LEVEL` of the time."""
    return percentile_of(abs(response), LEVEL)


STATISTICS: Mapping[str, Callable[[Response], Estimate]] = {
    "rms": rms_of,
    "peak": peak_of,
    f"{100 * LEVEL:.0f} %": level_of,
}
"""By what tables call them; in the unit of the response."""

LEAST = 3
"""Rows of a response, above which it has a dominant frequency."""

UNKNOWN = Estimate(nan, nan, nan)


def swaying(dataset: Responses, name: str) -> Response:
    """A response less what follows the curves of the line, on which frequencies are looked for.

    What a curve asks for comes as often as curves do, and is no motion of the car's own. Taken out
    are the multiples of the curvature and of its size that are nearest by least squares.
    """
    response, line = dataset[name], f"{layout_of(dataset).track}.curvature"
    if line not in dataset:
        return response
    return Signal.of(without_curves(response.values, dataset[line].values), response["time"].values)


def without_curves(values: Array, curvature: Array) -> Array:
    """Values less their part that follows the curvature [1/m] of the line; see `swaying`."""
    most = np.abs(curvature).max(initial=0.0)
    if not most:
        return values
    line = curvature / most
    shapes = np.column_stack([np.ones_like(line), line, np.abs(line)])
    return np.asarray(values - shapes[:, 1:] @ np.linalg.lstsq(shapes, values, rcond=None)[0][1:])


def excited(response: Response, rest: float = 0.0) -> bool:
    """Whether a response leaves zero by more than its rest [SI], which is rounding."""
    return bool(np.any(~(np.abs(response.values) <= rest)))


def moves(response: Response, rest: float = 0.0) -> bool:
    """Whether a response varies by more than its rest [SI]."""
    return response.size > 0 and not np.ptp(response.values) <= rest


def dominant(response: Response, rest: float = 0.0) -> Estimate:
    """The dominant frequency [Hz]; unknown for what is short or does not move."""
    known = response.size > LEAST and moves(response, rest)
    return frequency_of(response) if known else UNKNOWN


def uncertainty(found: Estimate) -> float:
    """The wider side of an interval, as a share of the value; NaN where it is not known."""
    wider = max(found.high - found.value, found.value - found.low)
    return wider / abs(found.value) if found.value else nan


def differ(one: Estimate, other: Estimate) -> bool | None:
    """Whether zero is outside the interval of the difference; None where that is not known.

    Equal values do not differ, whatever their intervals.

    Source: Zou, G. Y.; Donner, A.: Construction of confidence limits about effect measures,
    Statistics in Medicine 27 (2008) 1693.
    """
    if one.value == other.value:
        return False
    low, high = sorted((one, other), key=lambda estimate: estimate.value)
    reach = hypot(low.high - low.value, high.value - high.low)
    return None if isnan(reach) else high.value - low.value > reach
