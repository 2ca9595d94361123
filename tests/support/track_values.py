"""Parameter values of the track for its tests, apart from any parameter file."""

from __future__ import annotations

from fmus.track.spectra import SPECTRA

INCH = 0.0254
L_C, L_X = 203 * INCH, 34 * INCH


def track_values(spectrum: str = "report", **changes: float) -> dict[str, float]:
    values = {
        "spectrum": SPECTRA.index(spectrum) + 1,
        "seed": 1,
        "report_rms": 0.088 * INCH,
        "wavelength_min": 3.0,
        "wavelength_max": 41.7,
        "fade_length": 10.0,
        "alignment_scale": 1.0,
        "profile_scale": 1.0,
        "cross_level_scale": 1.0,
        "gauge_scale": 1.0,
        "half_truck_spacing": L_C,
        "half_wheelbase": L_X,
        "gauge_range": 1,
    }
    assert set(changes) <= set(values)
    return values | changes
