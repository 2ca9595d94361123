"""The spectra of track irregularity: one formula, a table of constants, and band variances."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

import casadi as ca
import numpy as np

from .channels import CHANNELS

SPECTRA = (
    "report",
    "fra1",
    "fra2",
    "fra3",
    "fra4",
    "fra5",
    "fra6",
    "german_low",
    "german_high",
    "perfect",
    "report_grid",
)
"""In the order of the enumeration, from 1."""
REPORT_SPECTRA = ("report", "report_grid")
"""Alignment only, with the report's rms; `report_grid` on the grid that the report prints."""
GAUGE_RANGES = ("legal", "unlimited")
FOOT = 0.3048
INCH = 0.0254
"""[m]"""


@cache
def data() -> dict[str, Any]:
    """The published constants of spectra.toml."""
    text = files(__package__).joinpath("spectra.toml").read_text("utf-8")
    return tomllib.loads(text)


@cache
def grid_spacing() -> float:
    """Distance of the report's lines [cycle/m], report (5-18)."""
    return float(data()["report"]["grid_spacing"]["value"]) / FOOT


@cache
def report_band() -> tuple[float, float]:
    """Lowest and highest frequency [cycle/m] of the spectrum `report`."""
    longest, shortest = (data()["report"][name]["value"] for name in ("longest", "shortest"))
    return 1 / (FOOT * longest), 1 / (FOOT * shortest)


@cache
def legal_gauge() -> np.ndarray:
    """Least and most gauge less the nominal one [m], shape (2, spectra).

    NaN for a spectrum that is of no FRA class.
    """
    gauge = data()["gauge"]
    nominal, least = gauge["nominal"]["value"], gauge["least"]["value"]
    table = dict.fromkeys(SPECTRA, (math.nan, math.nan))
    table |= {
        name: (INCH * (least - nominal), INCH * (row["value"] - nominal))
        for name, row in gauge["most"].items()
    }
    return np.array([table[name] for name in SPECTRA]).T


@cache
def amplitudes() -> np.ndarray:
    """Constants A of (1), (2) [m^2.rad/m], shape (channels, spectra).

    A is one for the report's alignment, whose level follows from its rms, and zero for a channel
    that a spectrum leaves out.
    """
    table = {"perfect": (0.0, 0.0, 0.0, 0.0)}
    table |= dict.fromkeys(REPORT_SPECTRA, (1.0, 0.0, 0.0, 0.0))
    factor = 1e-4 * data()["fra"]["factor"]["value"]
    for name, row in data()["fra"]["classes"].items():
        a, v = factor * row["alignment"], factor * row["profile"]
        table[name] = (a, v, 4 * v, 4 * v)
    # The angle [rad] over the rail spacing 2 b is a height: (A_v/b^2) (2 b)^2.
    b = data()["german"]["half_rail_spacing"]["value"]
    for name, row in data()["german"]["levels"].items():
        a, v = row["alignment"], row["profile"]
        table[name] = (a, v, v / (b * b) * (2 * b) * (2 * b), row["gauge"])
    return np.array([table[name] for name in SPECTRA]).T


@cache
def corners() -> np.ndarray:
    """Corner wavenumbers Omega_r, Omega_c, Omega_s [rad/m], shape (3, spectra)."""
    fra, german = data()["fra"], data()["german"]
    table = {
        name: (0.0, fra["corner"]["value"], row["cross_level_corner"])
        for name, row in fra["classes"].items()
    }
    levels = [
        german[name]["value"] for name in ("long_wave_corner", "corner", "cross_level_corner")
    ]
    table |= dict.fromkeys(german["levels"], tuple(levels))
    table |= dict.fromkeys((*REPORT_SPECTRA, "perfect"), table["fra6"])
    return np.array([table[name] for name in SPECTRA]).T


def density(channel: str, wavenumber: Any, amplitude: Any, r: Any, c: Any, s: Any) -> Any:
    """One-sided power spectral density [m^2/(rad/m)] at a wavenumber [rad/m], (1) and (2)."""
    square = wavenumber * wavenumber
    value = amplitude * c * c / ((square + r * r) * (square + c * c))
    return value * square / (square + s * s) if channel in CHANNELS[2:] else value


def bin_variance(
    channel: str, low: ca.SX, high: ca.SX, amplitude: ca.SX, corners: tuple[ca.SX, ca.SX, ca.SX]
) -> ca.SX:
    """Integral of the density [m^2] over a bin, `low` to `high` [cycle/m].

    Gauss-Legendre of four points over the wavelength, where densities that fall as the inverse
    square of the wavenumber are flat.
    """
    short, long = 1 / (2 * math.pi * high), 1 / (2 * math.pi * low)
    middle, half = 0.5 * (long + short), 0.5 * (long - short)
    total = ca.SX(0)
    for node, weight in _gauss_legendre():
        wavenumber = 1 / (middle + half * node)
        # d Omega = Omega^2 d(1/Omega)
        integrand = density(channel, wavenumber, amplitude, *corners) * wavenumber * wavenumber
        total = total + weight * half * integrand
    return total


def _gauss_legendre() -> list[tuple[float, float]]:
    """Nodes in -1..1 and weights of the rule of four points."""
    root = math.sqrt(6 / 5)
    outer, inner = math.sqrt((3 + 2 * root) / 7), math.sqrt((3 - 2 * root) / 7)
    heavy, light = (18 + math.sqrt(30)) / 36, (18 - math.sqrt(30)) / 36
    return [(-outer, light), (-inner, heavy), (inner, heavy), (outer, light)]


def band_variance(spectrum: str, channel: str, shortest: float, longest: float) -> float:
    """Variance [m^2] between two wavelengths [m], in closed form by partial fractions.

    A is one for the report's, whose level follows from its rms.
    """
    number = SPECTRA.index(spectrum)
    r, c, s = (float(value) ** 2 for value in corners()[:, number])
    crossing = channel in CHANNELS[2:]
    poles = [r, c, s] if crossing else [r, c]

    def primitive(wavenumber: float) -> float:
        total = 0.0
        for pole in poles:
            residue = -pole if crossing else 1.0
            residue /= math.prod(other - pole for other in poles if other != pole)
            root = math.sqrt(pole)
            integral = math.atan(wavenumber / root) / root if root else -1 / wavenumber
            total += residue * integral
        return total

    amplitude = float(amplitudes()[CHANNELS.index(channel), number])
    low, high = 2 * math.pi / longest, 2 * math.pi / shortest
    return amplitude * c * (primitive(high) - primitive(low))
