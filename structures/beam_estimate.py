"""The first estimate of a carbody's bending: a uniform free-free beam, report 4.1.2."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from fmus.carbody.modes import BEAM_WAVE_NUMBER

from .model import Array, Model, Plate


def bending_frequency(young: float, second_moment: float, mass: float, length: float) -> float:
    """First bending frequency [Hz] of a free-free beam.

    young [Pa], second_moment [m4], mass over the length [kg/m], length [m]. # report (4-1)
    """
    return BEAM_WAVE_NUMBER**2 / (2 * pi) * sqrt(young * second_moment / (mass * length**4))


def second_moment(model: Model, x: float) -> float:
    """Second moment about the horizontal axis of what a plane X = x cuts of a model [m4].

    As (4-1) takes it: all members bend as one.
    """
    pieces = []
    for element in model.elements:
        section, corners = model.sections[element.section], model.corners(element)
        cut = _cut(corners, x)
        if len(cut) < 1:
            continue
        if isinstance(section, Plate):
            rise = float(np.ptp(cut[:, 2]))
            area = section.thickness * float(np.linalg.norm(np.ptp(cut, 0)))
            pieces.append((area, float(cut[:, 2].mean()), area * rise**2 / 12))
        else:
            pieces.append((section.area, float(cut[0, 2]), section.second_y))
    area, height, own = np.array(pieces).T
    middle = area @ height / area.sum()
    return float(own.sum() + area @ (height - middle) ** 2)


def _cut(corners: Array, x: float) -> Array:
    """Where the sides of an element cross a plane X = x, (points, 3)."""
    ahead = np.roll(corners, -1, axis=0)
    below, above = corners[:, 0] - x, ahead[:, 0] - x
    crossed = below * above < 0
    share = (below[crossed] / (below[crossed] - above[crossed]))[:, None]
    return corners[crossed] + share * (ahead[crossed] - corners[crossed])
