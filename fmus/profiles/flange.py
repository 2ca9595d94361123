"""What a wheel gauge measures of a flange."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import ParameterError
from .profile import Profile

BELOW = 0.010
"""Depth of the thickness below the tape circle [m]."""
OVER_TIP = 0.002
"""Height over the tip of the flange gradient's lower point [m]."""


@dataclass(frozen=True)
class Flange:
    """height: of the tip below the tape circle; thickness: from the back to the face 10 mm below
    the tape circle; gradient: qR, from there across to the face 2 mm over the tip. All [m].

    Source: EN 15313, in the form that makers of wheel gauges publish.
    """

    height: float
    thickness: float
    gradient: float


def flange_of(wheel: Profile) -> Flange:
    """Raises ParameterError for a wheel without a flange."""
    if not wheel.flanged:
        raise ParameterError(f"{wheel.name} has no flange; there is nothing to measure")
    y, z, _, _ = wheel.surface.at(wheel.surface.grid(1e-4))
    tip = int(z.argmin())
    face = slice(tip, tip + int(np.argmax(z[tip:] > -BELOW / 2)) + 1)
    upper, lower = np.interp([-BELOW, z[tip] + OVER_TIP], z[face], y[face])
    return Flange(
        height=float(-z[tip]),
        thickness=float(upper - wheel.points[:, 0].min()),
        gradient=float(upper - lower),
    )
