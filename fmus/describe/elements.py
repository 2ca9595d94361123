"""Spring with free play, and elastic-slip (Jenkins) friction: the parallel pair of every joint.

The friction element is a spring in series with a slider. Its memory is the slip, the strain at
which the spring is free of load. Keeping the slip rather than the force makes the element's
force a function of the present strain, also when a master corrects the strain between steps.
"""

from __future__ import annotations

import casadi as ca


def clip(value: ca.SX, limit: ca.SX) -> ca.SX:
    """The value limited to +-limit."""
    return ca.fmax(-limit, ca.fmin(value, limit))


def spring_force(strain: ca.SX, stiffness: ca.SX, stop_stiffness: ca.SX, free_play: ca.SX) -> ca.SX:
    """Force K0 eps + K1 (eps - Delta sgn eps) beyond the free play. # report (4-27), erratum 9"""
    return stiffness * strain + stop_stiffness * (strain - clip(strain, free_play))


def friction_force(strain: ca.SX, slip: ca.SX, stiffness: ca.SX, limit: ca.SX) -> ca.SX:
    """Force of the friction element with its slider at rest or giving way. # report (4-28)"""
    return clip(stiffness * (strain - slip), limit)


def slip_after(strain: ca.SX, slip: ca.SX, reach: ca.SX) -> ca.SX:
    """The slip when the strain has moved; the slider follows at the distance `reach` = f/Kf."""
    return ca.fmax(strain - reach, ca.fmin(slip, strain + reach))


SLIDER_MARGIN = 1e-6
"""Part of the reach by which the mode of a slider lags, so that no event indicator starts at 0."""


def slider_mode(strain: ca.SX, slip: ca.SX, reach: ca.SX, mode: ca.SX) -> ca.SX:
    """Mode after a step, 0 stuck, +1 or -1 slipping, from the mode and the slip before it."""
    ahead = strain - slip
    # Half of the indicator's margin: a crossing may be located a little before or after it.
    gives_way = ca.fabs(ahead) > (1 + SLIDER_MARGIN / 2) * reach
    slips_on = mode * ahead >= (1 - SLIDER_MARGIN) * reach
    return ca.if_else(gives_way, ca.sign(ahead), ca.if_else(slips_on, mode, 0))


def slider_indicator(
    strain: ca.SX, strain_rate: ca.SX, slip: ca.SX, reach: ca.SX, mode: ca.SX
) -> ca.SX:
    """Falls through zero when a stuck slider gives way, or the strain of a slipping one turns.

    An element without friction has no events.
    """
    stuck = (1 + SLIDER_MARGIN) * reach - ca.fabs(strain - slip)
    watched = ca.if_else(mode == 0, stuck, mode * strain_rate)
    return ca.if_else(reach > 0, watched, 1)


def stop_indicator(strain: ca.SX, stop_stiffness: ca.SX, free_play: ca.SX) -> ca.SX:
    """Falls through zero when the free play is used up; an element without a stop has no events."""
    return ca.if_else(stop_stiffness > 0, free_play - ca.fabs(strain), 1)
