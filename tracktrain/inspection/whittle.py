"""A spectrum fitted to a channel by maximum likelihood, with intervals.

Whittle's likelihood: the periodogram I at a frequency is exponential about the density S, so that
-log L = sum of log S + I/S. P. Whittle, Arkiv foer Matematik 2 (1953) 423. The record is tapered,
since spectra of track fall by powers of ten and would leak. Bins of a tapered record are
correlated: variances are larger by N sum w^4/(sum w^2)^2 (R. Dahlhaus, Stochastic Processes and
their Applications 30 (1988) 69).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft, signal, stats

from fmus.track.spectra import data

from ..geometry.errors import GeometryError

Array = np.ndarray

LEVEL = 0.95
TAPER = 0.2
"""Share of the record over which a cosine taper rises and falls."""
LEAST_WAVES = 10
"""Longest waves of the band that a record must hold."""
STEPS, CLOSE = 100, 1e-9
"""Most steps of the iteration, and the change of a parameter's logarithm that ends it."""
CM2 = 1e-4


@dataclass(frozen=True, eq=False)
class Periodogram:
    """Of a record: [cycle/m], [m^2/(cycle/m)] one-sided, and what its taper adds to variances."""

    frequency: Array
    density: Array
    inflation: float

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency [cycle/m]."""
        return float(self.frequency[0]), float(self.frequency[-1])


@dataclass(frozen=True)
class Estimate:
    """A parameter in its published unit, and its interval; low and high are it where it is held."""

    symbol: str
    unit: str
    value: float
    low: float
    high: float
    held: bool = False


class NoCornerError(GeometryError):
    """A channel that no parameters of the form make likeliest."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A spectrum of a channel: its parameters, its density [m^2/(cycle/m)] over [cycle/m].

    misfit: how likely such a misfit is by chance; small where the form is wrong. form: its name.
    band: lowest and highest frequency [cycle/m] of the fit.
    """

    channel: str
    parameters: Sequence[Estimate]
    density: Callable[[Array], Array]
    misfit: float
    form: str
    band: tuple[float, float]


def periodogram(values: Array, spacing: float, band: tuple[float, float]) -> Periodogram:
    """That of a channel [m] within waves of `band` (shortest, longest) [m].

    Raises GeometryError for a record that does not hold such waves.
    """
    shortest, longest = band
    length = spacing * len(values)
    if not 2 * spacing <= shortest < longest <= length / LEAST_WAVES * (1 + 1e-9):
        raise GeometryError(
            f"{length:.4g} m of track with stations each {spacing:.4g} m cannot tell a spectrum of "
            f"waves of {shortest:.4g} to {longest:.4g} m; give --waves within {2 * spacing:.4g} to "
            f"{length / LEAST_WAVES:.4g} m, or a longer track"
        )
    taper = signal.windows.tukey(len(values), TAPER, sym=False)
    power = np.sum(taper**2)
    found = np.abs(fft.rfft(signal.detrend(values) * taper)) ** 2 * (2 * spacing / power)
    frequency = fft.rfftfreq(len(values), spacing)
    inside = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    inflation = len(values) * float(np.sum(taper**4) / power**2)
    return Periodogram(frequency[inside], found[inside], inflation)


def fit_form(measured: Periodogram, channel: str) -> Fit:
    """The published form of the FRA classes, (1) and (2) of the track block; or GeometryError.

    Alignment and profile: A and Omega_c. Cross-level and gauge: A and Omega_s, since Omega_c enters
    as Omega_s does and cannot be told from it; it is held at its published value.
    """
    corner = float(data()["fra"]["corner"]["value"])
    factor = float(data()["fra"]["factor"]["value"]) * CM2
    crossing = channel in ("cross_level", "gauge")
    square = (2 * np.pi * measured.frequency) ** 2

    def logarithm(square: Array, level: float, own: float) -> Array:
        """Of the density over [rad/m] at logarithms of A [cm^2.rad/m] and of the corner."""
        pole = np.exp(2 * own)
        if crossing:
            numerator = np.log(4 * factor * corner**2) + level
            return numerator - np.log((square + corner**2) * (square + pole))
        return np.log(factor) + level + 2 * own - np.log(square * (square + pole))

    def slopes(own: float) -> Array:
        """Of the logarithm by both parameters."""
        share = 2 * np.exp(2 * own) / (square + np.exp(2 * own))
        return np.stack([np.ones_like(square), -share if crossing else 2 - share])

    ordinate = measured.density / (2 * np.pi)
    start = float(np.log(np.mean(ordinate / np.exp(logarithm(square, 0.0, np.log(corner))))))
    try:
        found, covariance = _maximum(
            ordinate,
            lambda p: np.asarray(logarithm(square, p[0], p[1])),
            lambda p: slopes(p[1]),
            np.array([start, np.log(corner)]),
        )
    except np.linalg.LinAlgError:
        low, high = measured.band
        raise NoCornerError(
            f"the {channel} is not of the form of the FRA classes: no corner within waves of "
            f"{1 / high:.4g} to {1 / low:.4g} m makes it likeliest; give other --waves, or "
            "--form nearest, which fits a published spectrum by its scale"
        ) from None
    spread = np.sqrt(np.diag(covariance) * measured.inflation)
    symbols = ("A_v", "Omega_s") if crossing else ("A_a", "Omega_c")
    if channel == "profile":
        symbols = ("A_v", "Omega_c")
    parameters = [
        _interval(symbol, unit, value, deviation)
        for symbol, unit, value, deviation in zip(
            symbols, ("cm^2.rad/m", "rad/m"), found, spread, strict=True
        )
    ]
    if crossing:
        parameters.append(Estimate("Omega_c", "rad/m", corner, corner, corner, held=True))

    def density(frequency: Array) -> Array:
        return 2 * np.pi * np.exp(logarithm((2 * np.pi * frequency) ** 2, found[0], found[1]))

    wrong = misfit(measured, density(measured.frequency), 2)
    return Fit(channel, parameters, density, wrong, "FRA form", measured.band)


def fit_scale(
    measured: Periodogram, channel: str, density: Callable[[Array], Array], name: str
) -> Fit:
    """A published density times a factor: the mean of I/S."""
    given = density(measured.frequency)
    factor = float(np.mean(measured.density / given))
    spread = np.sqrt(measured.inflation / len(given))
    estimate = _interval("scale", "1", np.log(factor), spread)
    return Fit(
        channel,
        [estimate],
        lambda frequency: factor * density(frequency),
        misfit(measured, factor * given, 1),
        name,
        measured.band,
    )


def likelihood(measured: Periodogram, density: Array) -> float:
    """Logarithm of Whittle's likelihood."""
    return -float(np.sum(np.log(density) + measured.density / density))


def misfit(measured: Periodogram, density: Array, fitted: int) -> float:
    """Probability of a worse agreement by chance, of bands of equal width over logarithms.

    Each band's mean of I/S is Gamma of its bins; their logarithms' squares add up to chi-square.
    """
    place = np.log2(measured.frequency / measured.frequency[0]) * 3
    bands = [np.flatnonzero(place.astype(int) == n) for n in range(int(place[-1]) + 1)]
    ratio, total, count = measured.density / density, 0.0, 0
    for band in bands:
        if len(band) >= 5:
            degrees = 2 * len(band) / measured.inflation
            below = stats.chi2.cdf(degrees * float(np.mean(ratio[band])), degrees)
            total += float(stats.norm.ppf(np.clip(below, 1e-15, 1 - 1e-15))) ** 2
            count += 1
    return float(stats.chi2.sf(total, max(count - fitted, 1)))


def _maximum(
    ordinate: Array,
    logarithm: Callable[[Array], Array],
    slopes: Callable[[Array], Array],
    start: Array,
) -> tuple[Array, Array]:
    """Where the likelihood is largest, by Fisher's scoring, and the inverse of its information.

    A step that does not raise it is halved.
    """

    def loss(at: Array) -> float:
        log = logarithm(at)
        with np.errstate(over="ignore"):  # of a step too far, which is halved
            return float(np.sum(log + ordinate * np.exp(-log)))

    point, lowest = start, loss(start)
    for _ in range(STEPS):
        gradient = slopes(point)
        information = gradient @ gradient.T
        step = np.linalg.solve(information, gradient @ (ordinate * np.exp(-logarithm(point)) - 1))
        while loss(point + step) > lowest and np.abs(step).max() > CLOSE:
            step = step / 2
        point = point + step
        lowest = loss(point)
        if np.abs(step).max() <= CLOSE:
            break
    return point, np.linalg.inv(information)


def _interval(symbol: str, unit: str, logarithm: float, deviation: float) -> Estimate:
    """Normal over the logarithm."""
    reach = float(stats.norm.ppf((1 + LEVEL) / 2)) * float(deviation)
    value, low, high = (float(np.exp(logarithm + k * reach)) for k in (0, -1, 1))
    return Estimate(symbol, unit, value, low, high)


def nearest(measured: Periodogram, of_class: Mapping[str, Callable[[Array], Array]]) -> str:
    """Which density the record is most likely of, as it stands; of those that are there at all."""
    found = {name: density(measured.frequency) for name, density in of_class.items()}
    whole = {name: density for name, density in found.items() if (density > 0).all()}
    return max(whole, key=lambda name: likelihood(measured, whole[name]))
