"""What has to be known of a measured track beside its numbers: signs, chords, filters, repairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from orchestrator import DimensionError, Quantity, UnitError, choices

from .errors import GeometryError

SIGNS = {
    "alignment_positive": ("left", "right"),
    "profile_positive": ("up", "down"),
    "cross_level_positive": ("left high", "right high"),
    "curvature_positive": ("left", "right"),
    "cant_positive": ("left high", "right high"),
}
"""What a positive number means; the first one is that of our axes."""

LENGTHS = {
    "alignment_chord": "chord of a mid-chord offset that the alignment is, such as 62 ft",
    "profile_chord": "chord of a mid-chord offset that the profile is",
    "nominal_gauge": "what the gauge is compared with",
    "longest_gap": "stretch without values that is interpolated over",
    "longest_wave": "waves beyond it are taken out of alignment, profile and cross-level; with "
    "curvature and without cant, what is taken out of the cross-level is the cant",
}
WORDS = {
    **SIGNS,
    "spikes": ("keep", "interpolate", "refuse"),
    "absent_channels": ("refuse", "perfect"),
}
KEYS = (*WORDS, *LENGTHS)

NOMINAL_GAUGE = 56.5 * 0.0254
LONGEST_GAP = 1.0
"""[m]"""

Given = Mapping[str, tuple[str, str]]
"""Key -> value and the place where it is said."""


@dataclass(frozen=True)
class Said:
    """What a file says of itself; lengths [m], None where nothing is said.

    A sign that is None was not said. chords: none where a channel is a space curve.
    """

    alignment_positive: str | None = None
    profile_positive: str | None = None
    cross_level_positive: str | None = None
    curvature_positive: str | None = None
    cant_positive: str | None = None
    spikes: str = "keep"
    absent_channels: str = "refuse"
    alignment_chord: float | None = None
    profile_chord: float | None = None
    nominal_gauge: float = NOMINAL_GAUGE
    longest_gap: float = LONGEST_GAP
    longest_wave: float | None = None

    @classmethod
    def of(cls, given: Given) -> Said:
        """Raises GeometryError for a key or a value that there is not. Other remarks are free."""
        taken: dict[str, Any] = {}
        for key, (value, place) in given.items():
            if key in WORDS:
                taken[key] = word(key, value, place, WORDS[key])
            elif key in LENGTHS:
                taken[key] = _length(key, value, place)
            elif key.endswith(("positive", "chord", "gauge", "gap", "wave")):
                raise GeometryError(f"{place}: '{key}' is not known; {choices(key, KEYS)}")
        return cls(**taken)


def typed(options: Sequence[str], keys: Sequence[str] = KEYS) -> Given:
    """`key=value` of a command line, by keys there are; raises GeometryError for what is not so."""
    found = {}
    for text in options:
        key, equals, value = text.partition("=")
        key = "_".join(key.strip().lower().replace("-", " ").split())
        if not equals or key not in keys:
            raise GeometryError(f"--say '{text}' cannot be read; {choices(key, keys)}")
        found[key] = (value.strip(), f"--say {text}")
    return found


def word(key: str, value: str, place: str, words: Sequence[str]) -> str:
    """One of the words that a key may have; raises GeometryError."""
    plain = " ".join(value.lower().replace("_", " ").split())
    if plain not in words:
        raise GeometryError(
            f"{place}: {key.replace('_', ' ')} is '{value}'; say {' or '.join(words)}"
        )
    return plain


def _length(key: str, value: str, place: str) -> float:
    try:
        given = Quantity.parsed(value)
        length = given.to("m") if given.unit else 0.0
    except (UnitError, DimensionError):
        length = 0.0
    if not 0.0 < length < float("inf"):
        raise GeometryError(
            f"{place}: {key.replace('_', ' ')} is '{value}', which is no length with its unit "
            f"({LENGTHS[key]})"
        )
    return length
