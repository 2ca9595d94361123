"""Rails that move smoothly under the four axles, for studies of the reference itself."""

from __future__ import annotations

import numpy as np

from reference.car_data import FOOT, INCH, Array, CarData

ALIGNMENT_RMS = 0.088 * INCH  # report, section 5


def irregular_rails(data: CarData, speed: float, duration: float, spacing: float) -> Array:
    """Rails (n, 16) [m] every `spacing` [s] at `speed` [m/s], the same track at any spacing.

    Alignment, profile, cross-level and gauge are sums of 40 sinusoids of 12 to 200 ft with
    amplitudes proportional to the wavelength, faded in over the first 15 m.
    """
    generator = np.random.default_rng(20260101)
    wave_numbers = 2 * np.pi / (FOOT * np.geomspace(12, 200, 40))
    amplitudes = ALIGNMENT_RMS / wave_numbers / np.sqrt(np.sum(wave_numbers**-2.0) / 2)
    phases = generator.uniform(0, 2 * np.pi, (4, wave_numbers.size))
    travelled = speed * spacing * np.arange(round(duration / spacing) + 1)
    entry = np.clip(travelled / 15.0, 0, 1)
    fade = entry**3 * (10 - 15 * entry + 6 * entry**2)
    rails = np.zeros((travelled.size, 16))
    ends = (data.half_truck_spacing, -data.half_truck_spacing)
    positions = [end + side * data.half_wheelbase for end in ends for side in (1, -1)]
    for axle, position in enumerate(positions):
        station = travelled + position
        alignment, profile, crosslevel, gauge = (
            fade * (amplitudes * np.cos(np.outer(station, wave_numbers) + phase)).sum(axis=1)
            for phase in phases
        )
        rails[:, 4 * axle] = alignment + gauge / 2
        rails[:, 4 * axle + 1] = alignment - gauge / 2
        rails[:, 4 * axle + 2] = profile + crosslevel / 2
        rails[:, 4 * axle + 3] = profile - crosslevel / 2
    return rails
