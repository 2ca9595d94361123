"""Standard deviations of track by ranges of waves, and classes of its quality, after EN 13848."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import pandas as pd
from scipy import fft, signal

from fmus.track.recorded_data import TrackData

from .federal import SIDES, rail

Array = np.ndarray

QUANTITIES = {"longitudinal level": "profile", "alignment": "alignment"}
"""Of each rail, and what the channels call them."""
LEAST_WAVES = 2.0
"""How many of a range's longest waves a track must hold for a standard deviation."""


@cache
def standard() -> Mapping[str, Any]:
    """european.toml."""
    return tomllib.loads((files(__package__) / "european.toml").read_text(encoding="utf-8"))


def response(frequency: Array, shortest: float, longest: float, order: int) -> Array:
    """Amplitude of the band-pass of Butterworth flanks: 0.71 at both waves [m]; f [cycle/m]."""
    with np.errstate(divide="ignore"):
        high_pass = 1 / np.sqrt(1 + (1 / (longest * frequency)) ** (2 * order))
    return np.asarray(high_pass / np.sqrt(1 + (shortest * frequency) ** (2 * order)))


def filtered(values: Array, spacing: float, shortest: float, longest: float) -> Array:
    """Values with the waves of a range [m] alone; no phase, mirrored at both ends."""
    frequency = np.arange(len(values)) / (2 * spacing * len(values))
    share = response(frequency, shortest, longest, standard()["filter"]["order"])
    return np.asarray(fft.idct(fft.dct(signal.detrend(values)) * share))


def deviations(track: TrackData) -> pd.DataFrame:
    """Standard deviation [mm] of each rail in each range: median and largest over the sections.

    Indexed by quantity, rail and range. A track that is shorter than a section is one section.
    """
    section = standard()["section"]["value"]
    count = max(int(track.length // section), 1)
    rows = []
    for quantity, channel in QUANTITIES.items():
        for side in SIDES:
            values = rail(track, f"{side}_{channel}")
            for name in ("D1", "D2", "D3"):
                shortest, longest = standard()["ranges"][name]
                row = {"quantity": quantity, "rail": side, "range": name}
                of_sections = np.full(count, np.nan)
                if track.length >= LEAST_WAVES * longest:
                    within = filtered(values, track.spacing, shortest, longest)
                    parts = np.array_split(within, count)
                    of_sections = 1e3 * np.array([part.std() for part in parts])
                rows.append(
                    row
                    | {
                        "waves [m]": f"{shortest:g} to {longest:g}",
                        "median [mm]": float(np.median(of_sections)),
                        "largest [mm]": float(of_sections.max()),
                        **_classes(quantity, name, float(of_sections.max())),
                    }
                )
    return pd.DataFrame(rows).set_index(["quantity", "rail", "range"])


def _classes(quantity: str, name: str, deviation: float) -> dict[str, str]:
    """The class of the worst section at each range of speeds that limits are known for."""
    classes = standard()["classes"]
    found = {}
    for speeds in classes["speeds"]:
        place = int(np.searchsorted(speeds["most"], deviation, "left"))
        known = quantity == "longitudinal level" and name == "D1" and not np.isnan(deviation)
        title = f"class at {speeds['from']} to {speeds['to']} km/h"
        found[title] = classes["names"][place] if known else "-"
    return found
