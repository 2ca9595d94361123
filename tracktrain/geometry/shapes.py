"""Shapes of track in closed form: each a function of the distance from where it stands.

A shape adds to a channel, or to one rail: y_left = a + g/2, z_left = v + xl/2 and so on, so that a
rail raised by z adds z/2 to the profile and +z or -z to the cross-level.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from fmus.track.spectra import CHANNELS
from orchestrator import DimensionError, Quantity, UnitError, choices

from .errors import GeometryError

Array = np.ndarray
Form = Callable[[Array, Mapping[str, float]], Array]

RAILS = {
    "left_alignment": {"alignment": 0.5, "gauge": 1.0},
    "right_alignment": {"alignment": 0.5, "gauge": -1.0},
    "left_profile": {"profile": 0.5, "cross_level": 1.0},
    "right_profile": {"profile": 0.5, "cross_level": -1.0},
}
"""What a unit of a rail's own displacement adds to the channels."""

ON = (*CHANNELS, *RAILS)


def _smoothstep(u: Array) -> Array:
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (10 - u * (15 - 6 * u))


def _sinusoid(x: Array, of: Mapping[str, float]) -> Array:
    inside = (x >= 0) & (x <= of["count"] * of["length"])
    return np.where(inside, np.sin(2 * np.pi * x / of["length"]), 0.0)


def _versine(x: Array, of: Mapping[str, float]) -> Array:
    inside = (x >= 0) & (x <= of["count"] * of["length"])
    return np.where(inside, 0.5 - 0.5 * np.cos(2 * np.pi * x / of["length"]), 0.0)


def _joints(x: Array, of: Mapping[str, float]) -> Array:
    rail = of["length"]
    inside = (x >= -rail / 2) & (x <= (of["count"] - 0.5) * rail)
    return np.where(inside, np.abs(np.sin(np.pi * x / rail)) - 1.0, 0.0)


FORMS: dict[str, tuple[Form, str, float]] = {
    "cusp": (lambda x, of: np.exp(-np.abs(x) / of["length"]), "a kink at its place", 1.0),
    "bump": (lambda x, of: np.exp(-0.5 * (x / of["length"]) ** 2), "a smooth hump", 1.0),
    "step": (lambda x, of: _smoothstep(x / of["length"]), "a rise from its place on", 1.0),
    "sinusoid": (_sinusoid, "`count` waves from its place on", 1.0),
    "versine": (_versine, "`count` humps, level at both ends", 1.0),
    "dips": (_joints, "`count` low joints, rails of `length` between", 10.0),
}
"""Functions of the distance [m], for a size of 1; what they are; and their count."""

TESTS = ("twist-and-roll", "pitch-and-bounce", "yaw-and-sway")


@dataclass(frozen=True)
class Shape:
    """A form of `FORMS` on a channel or rail of `ON`; lengths [m].

    size: of the displacement [m], positive to the left, upwards, left high, wide; the depth of
    dips. at: its station. length: 1/e of a cusp, deviation of a bump, rise of a step, wave, rail.
    """

    form: str
    on: str
    size: float
    at: float
    length: float
    count: float = 1.0

    def add_to(self, values: Array, stations: Array) -> None:
        """Add it to the channels (4, stations) [m]."""
        own = self.size * FORMS[self.form][0](
            stations - self.at, {"length": self.length, "count": self.count}
        )
        for channel, part in RAILS.get(self.on, {self.on: 1.0}).items():
            values[CHANNELS.index(channel)] += part * own


KEYS = ("on", "size", "at", "length", "count")
EXAMPLE = "cusp:on=left_profile,size=-20mm,at=100m,length=1m"


def read_shape(text: str, station: float = 0.0) -> list[Shape]:
    """Shapes as they are typed: `form:key=value,...`, or a test of `TESTS` with a place.

    station: where a shape stands that does not say. Raises GeometryError.
    """
    form, _, rest = text.partition(":")
    form = form.strip().lower().replace("_", "-")
    known = (*FORMS, *TESTS)
    if form not in known:
        raise GeometryError(f"there is no shape '{form}'; {choices(form, known)}; as in {EXAMPLE}")
    given = dict(_pair(text, part) for part in rest.split(",") if part.strip())
    numbers: dict[str, Any] = {k: _number(text, k, v) for k, v in given.items() if k != "on"}
    numbers.setdefault("at", station)
    if form in TESTS:
        if unfit := sorted(given.keys() - {"at", "size", "count"}):
            raise GeometryError(f"'{text}': {form} takes at, size and count, not {unfit[0]}")
        return _test(form.replace("-", "_"), **numbers)
    missing = [key for key in ("on", "size", "length") if key not in given]
    if missing:
        raise GeometryError(f"'{text}' lacks {', '.join(missing)}; write it as {EXAMPLE}")
    on = given["on"].replace("-", "_")
    if on not in ON:
        raise GeometryError(f"'{text}': there is no channel '{on}'; {choices(on, ON)}")
    numbers.setdefault("count", FORMS[form][2])
    return [Shape(form, on, **numbers)]


def _pair(text: str, part: str) -> tuple[str, str]:
    key, equals, value = part.partition("=")
    if not equals or key.strip() not in KEYS:
        raise GeometryError(
            f"'{text}': '{part.strip()}' is none of {', '.join(KEYS)}; as in {EXAMPLE}"
        )
    return key.strip(), value.strip()


def _number(text: str, key: str, value: str) -> float:
    try:
        given = Quantity.parsed(value)
        number = given.value if key == "count" else given.to("m")
        fits = bool(given.unit) != (key == "count") and np.isfinite(number)
    except (UnitError, DimensionError):
        fits, number = False, 0.0
    if not fits or (key in ("length", "count") and number <= 0):
        what = "a number above zero" if key == "count" else "a length with its unit, such as 20mm"
        raise GeometryError(f"'{text}': {key} is '{value}'; give {what}")
    return number


@cache
def _data() -> dict[str, Any]:
    return tomllib.loads(files(__package__).joinpath("shapes.toml").read_text("utf-8"))


def _given(table: Mapping[str, Any]) -> float:
    """The number of an entry in SI."""
    return Quantity(float(table["value"]), "" if table["unit"] == "1" else table["unit"]).to(
        "1" if table["unit"] == "1" else "m"
    )


def _test(
    name: str, at: float, size: float | None = None, count: float | None = None
) -> list[Shape]:
    """The shapes of a test track; `at` is where its perturbations begin."""
    data, rail = _data()[name], _given(_data()["rail"])
    size = _given(data["size"]) if size is None else size
    count = _given(data["count"]) if count is None else count
    first = at + rail / 2
    if name == "yaw_and_sway":
        wide, end = _given(data["widening"]), at + count * rail
        return [
            Shape("sinusoid", "alignment", size, at, rail, count),
            Shape("step", "gauge", wide, at - rail, rail),
            Shape("step", "gauge", -wide, end, rail),
        ]
    stagger = rail / 2 if name == "twist_and_roll" else 0.0
    return [
        Shape("dips", "left_profile", size, first, rail, count),
        Shape("dips", "right_profile", size, first + stagger, rail, count),
    ]


def span(shapes: Sequence[Shape]) -> float:
    """Station [m] behind which they are level."""
    return max(
        (s.at + s.length * (s.count + 8 * (s.form in ("cusp", "bump"))) for s in shapes),
        default=0.0,
    )
