"""Scales of the units that are met often: a run need not wait for pint, which knows all units."""

from __future__ import annotations

import math
import re

Exponents = tuple[int, int, int]
"""Of kg, m and s."""

_INCH, _POUND, _GRAVITY = 0.0254, 0.45359237, 9.80665
_LBF = _POUND * _GRAVITY

UNITS: dict[str, tuple[float, Exponents]] = {
    "1": (1.0, (0, 0, 0)),
    "dimensionless": (1.0, (0, 0, 0)),
    "rad": (1.0, (0, 0, 0)),
    "deg": (math.pi / 180.0, (0, 0, 0)),
    "m": (1.0, (0, 1, 0)),
    "km": (1e3, (0, 1, 0)),
    "cm": (1e-2, (0, 1, 0)),
    "mm": (1e-3, (0, 1, 0)),
    "inch": (_INCH, (0, 1, 0)),
    "in": (_INCH, (0, 1, 0)),
    "ft": (12.0 * _INCH, (0, 1, 0)),
    "mi": (5280.0 * 12.0 * _INCH, (0, 1, 0)),
    "kg": (1.0, (1, 0, 0)),
    "t": (1e3, (1, 0, 0)),
    "lb": (_POUND, (1, 0, 0)),
    "s": (1.0, (0, 0, 1)),
    "ms": (1e-3, (0, 0, 1)),
    "min": (60.0, (0, 0, 1)),
    "h": (3600.0, (0, 0, 1)),
    "hr": (3600.0, (0, 0, 1)),
    "Hz": (1.0, (0, 0, -1)),
    "mph": (5280.0 * 12.0 * _INCH / 3600.0, (0, 1, -1)),
    "N": (1.0, (1, 1, -2)),
    "kN": (1e3, (1, 1, -2)),
    "lbf": (_LBF, (1, 1, -2)),
    "kip": (1e3 * _LBF, (1, 1, -2)),
    "g_0": (_GRAVITY, (0, 1, -2)),
    "J": (1.0, (1, 2, -2)),
    "W": (1.0, (1, 2, -3)),
    "byte": (8.0, (0, 0, 0)),
    "kB": (8e3, (0, 0, 0)),
    "MB": (8e6, (0, 0, 0)),
    "GB": (8e9, (0, 0, 0)),
}
"""Factor to SI, and exponents, by name as pint spells it."""

_SIGN = re.compile(r"\s*(?<!\*)([*/])(?!\*)\s*")
_FACTOR = re.compile(r"([A-Za-z]+(?:_0)?|1)(?:\*\*(-?\d))?")


def common(spelled: str) -> tuple[float, Exponents] | None:
    """Factor and exponents of a product of `UNITS`, such as "kg*m**2/s**2"; None for any other."""
    total, exponents = 1.0, (0, 0, 0)
    parts = iter(_SIGN.split(f"*{spelled}")[1:])
    for sign, text in zip(parts, parts, strict=True):
        found = _FACTOR.fullmatch(text)
        if found is None or found[1] not in UNITS:
            return None
        factor, own = UNITS[found[1]]
        power = int(found[2] or 1) * (1 if sign == "*" else -1)
        total = total * factor**power if power > 0 else total / factor**-power
        kg, m, s = (a + power * b for a, b in zip(exponents, own, strict=True))
        exponents = kg, m, s
    return total, exponents
