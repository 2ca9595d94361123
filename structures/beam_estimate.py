"""The first estimate of a carbody's bending: a uniform free-free beam, report 4.1.2."""

from __future__ import annotations

from math import pi, sqrt

from fmus.carbody.modes import BEAM_WAVE_NUMBER

GRAVITY_INCH = 386.0886
"""Acceleration of gravity [in/s2]."""

PRINTED_FACTOR = 69.0
"""The report's factor in (4-1), which is 69.95: erratum 19."""


def bending_frequency(young: float, second_moment: float, mass: float, length: float) -> float:
    """First bending frequency [Hz] of a free-free beam.

    young [Pa], second_moment [m4], mass over the length [kg/m], length [m]. # report (4-1)
    """
    return BEAM_WAVE_NUMBER**2 / (2 * pi) * sqrt(young * second_moment / (mass * length**4))


def printed_bending_frequency(
    young: float, second_moment: float, weight: float, length: float
) -> float:
    """(4-1) as the report prints it, in lbf, in, s. weight over the length [lbf/in]. [Hz]"""
    return PRINTED_FACTOR * sqrt(young * second_moment / (weight * length**4))
