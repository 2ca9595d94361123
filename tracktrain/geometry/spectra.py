"""Spectra as pieces of power laws: the Chinese ones, and a user's from a table; their realisation.

Between two points of a table the density is a straight line over logarithms, so that a bin's
variance is a closed form. A realisation is a sum of lines as in the track block, (5) to (7) there.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from fmus.track.spectra import CHANNELS, REPORT_SPECTRA, SPECTRA, amplitudes, corners
from fmus.track.spectra import density as block_density

from .errors import GeometryError
from .table import read_table, read_text

Array = np.ndarray

LINES = 600
"""Of a channel's realisation, in bins that grow with the square of their number."""
POINTS = 400
"""Of a formula that becomes pieces."""
NAMES = ("chinese-main-line", "chinese-high-speed")
LEVELLED = tuple(
    name.replace("_", "-") for name in SPECTRA if name not in (*REPORT_SPECTRA, "perfect")
)
PUBLISHED = (*LEVELLED, *NAMES)
"""Spectra whose level is published, too: those of the track block, and the Chinese ones."""
WIDEST = (0.5, 1000.0)
"""Waves [m] that the formulas of the block are told in as pieces."""


@dataclass(frozen=True)
class Pieces:
    """A one-sided density between edges f [cycle/m]: scale * f^-power [m^3]; none outside."""

    edges: Array
    scale: Array
    power: Array

    @classmethod
    def through(cls, frequency: Array, density: Array) -> Pieces:
        """Straight lines over logarithms."""
        power = -np.diff(np.log(density)) / np.diff(np.log(frequency))
        return cls(frequency, density[:-1] * frequency[:-1] ** power, power)

    def density(self, frequency: Array) -> Array:
        """[m^2/(cycle/m)]"""
        inside = (frequency >= self.edges[0]) & (frequency <= self.edges[-1])
        at = np.where(inside, frequency, self.edges[0])
        piece = np.clip(np.searchsorted(self.edges, at, "right") - 1, 0, len(self.scale) - 1)
        return np.where(inside, self.scale[piece] * at ** -self.power[piece], 0.0)

    def variance(self, low: Array | float, high: Array | float) -> Array:
        """Integral [m^2] from one frequency to another."""
        return self._below(np.asarray(high, float)) - self._below(np.asarray(low, float))

    def _below(self, frequency: Array) -> Array:
        total = np.zeros_like(frequency)
        for left, right, scale, power in zip(
            self.edges, self.edges[1:], self.scale, self.power, strict=False
        ):
            end = np.clip(frequency, left, right)
            if abs(power - 1.0) < 1e-9:
                total += scale * np.log(end / left)
            else:
                total += scale * (end ** (1 - power) - left ** (1 - power)) / (1 - power)
        return total


@dataclass(frozen=True)
class Spectrum:
    """Densities of channels, and what is to be said of them."""

    name: str
    channels: Mapping[str, Pieces]
    said: tuple[str, ...] = field(default=())

    @property
    def band(self) -> tuple[float, float]:
        """Shortest and longest wave that all channels have [m]."""
        low = max(pieces.edges[0] for pieces in self.channels.values())
        high = min(pieces.edges[-1] for pieces in self.channels.values())
        return 1 / high, 1 / low

    def realisation(self, stations: Array, seed: int, band: tuple[float, float]) -> Array:
        """The channels (4, stations) [m]: lines in the band (shortest and longest wave [m]).

        The same seed is the same track. Raises GeometryError for a band that is not covered.
        """
        short, long = self.band
        if band[0] < short * (1 - 1e-9) or band[1] > long * (1 + 1e-9) or band[0] >= band[1]:
            raise GeometryError(
                f"the spectrum {self.name} goes from waves of {short:g} to {long:g} m; "
                f"{band[0]:g} to {band[1]:g} m cannot be made of it, give --waves within"
            )
        edges = 1 / band[1] + (1 / band[0] - 1 / band[1]) * (np.arange(LINES + 1) / LINES) ** 2
        values = np.zeros((len(CHANNELS), len(stations)))
        for channel, pieces in self.channels.items():
            row = CHANNELS.index(channel)
            random = np.random.Generator(np.random.PCG64([seed, row]))
            place, phase = random.random((2, LINES))
            frequency = edges[:-1] + np.diff(edges) * place
            amplitude = np.sqrt(2 * pieces.variance(edges[:-1], edges[1:]))  # erratum 7
            for f, a, theta in zip(frequency, amplitude, phase, strict=True):
                values[row] += a * np.cos(2 * np.pi * (f * stations + theta))
        return values


@cache
def chinese(name: str) -> Spectrum:
    """One of `NAMES`."""
    text = files(__package__).joinpath("spectra.toml").read_text("utf-8")
    data: dict[str, Any] = tomllib.loads(text)[name.replace("-", "_")]
    low, high = 1 / data["longest"], 1 / data["shortest"]
    channels = {}
    for channel in CHANNELS:
        own = data.get(channel)
        if isinstance(own, list):
            a, b, c, d, e, f, g = own
            x = np.geomspace(low, high, POINTS)
            density = a * (x**2 + b * x + c) / (x**4 + d * x**3 + e * x**2 + f * x + g)
            channels[channel] = Pieces.through(x, 1e-6 * density)
        elif own:
            edges = np.array([low, *own["between"], high])
            channels[channel] = Pieces(edges, 1e-6 * np.array(own["A"]), np.array(own["n"]))
    return Spectrum(name, channels, (f"{data['description']} ({data['source']})", data["note"]))


@cache
def published(name: str) -> Mapping[str, Pieces]:
    """Densities by channel of one of `PUBLISHED`, without those that are nothing."""
    if name in NAMES:
        return chinese(name).channels
    number, x = SPECTRA.index(name.replace("-", "_")), np.geomspace(*WIDEST[::-1], POINTS)
    return {
        channel: Pieces.through(
            1 / x,
            2 * np.pi * block_density(channel, 2 * np.pi / x, level, *corners()[:, number]),
        )
        for channel, level in zip(CHANNELS, amplitudes()[:, number], strict=True)
        if level > 0
    }


ANGULAR, CYCLIC = "wavenumber", "frequency"
DENSITIES = dict.fromkeys(CHANNELS, "m^3")
SIDES = {"one-sided": 1.0, "two-sided": 2.0}


def is_spectrum_file(path: Path) -> bool:
    """Whether a file's first column is that of a spectrum; a track's is the station."""
    if not path.is_file():
        return False
    heads = _heads(path.read_text("latin-1"))
    return re.match(rf"\s*({CYCLIC}|{ANGULAR})", heads, re.IGNORECASE) is not None


def _heads(text: str) -> str:
    """The line that names the columns."""
    return next((line for line in text.splitlines() if line.strip() and line[0] != "#"), "")


def read_spectrum(path: Path) -> Spectrum:
    """The spectrum of a table: `wavenumber [rad/m]` or `frequency [1/m]`, and channels.

    A density is per unit of the first column: [mm^2*m] beside [rad/m] is mm^2/(rad/m). Whether it
    is one- or two-sided has to be said. Raises GeometryError.
    """
    text = read_text(path)
    first = CYCLIC if re.match(rf"\s*{CYCLIC}", _heads(text), re.IGNORECASE) else ANGULAR
    units = {first: "1/m" if first == CYCLIC else "rad/m", **DENSITIES}
    table = read_table(path.name, text, units, first)
    word, place = table.said.get("density", ("", path.name))
    if word not in SIDES:
        raise GeometryError(
            f"{place} has to say whether the density is one- or two-sided: add the line "
            "'# density = one-sided' or '# density = two-sided' above the columns"
        )
    x = table.columns[first]
    turn = 2 * np.pi if first == ANGULAR else 1.0
    for name, column in table.columns.items():
        if (wrong := np.flatnonzero(~(column > 0))).size:
            raise GeometryError(
                f"{table.place(wrong[0])}: the {name} is {column[wrong[0]]:g}; a spectrum takes "
                "numbers above zero"
            )
    if len(x) < 2 or (np.diff(x) <= 0).any():
        row = int(np.argmax(np.diff(x) <= 0)) + 1 if len(x) > 1 else 0
        raise GeometryError(f"{table.place(row)}: the {first} has to rise from line to line")
    given = {name: table.columns[name] for name in CHANNELS if name in table.columns}
    if not given:
        raise GeometryError(f"{path.name} has no channel; give {', '.join(CHANNELS)}, or some")
    channels = {
        name: Pieces.through(x / turn, SIDES[word] * turn * density)
        for name, density in given.items()
    }
    return Spectrum(path.stem, channels, (f"spectrum from {path.name}, {word}, over the {first}",))
