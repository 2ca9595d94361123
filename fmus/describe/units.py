"""Unit names as FMI writes them, such as `N.m/rad` or `m/s2`, read with pint."""

from __future__ import annotations

from functools import cache
from typing import Any

import pint

REGISTRY = pint.get_application_registry()
BASE = {"kilogram": "kg", "meter": "m", "second": "s", "radian": "rad"}


def parse(unit: str) -> pint.Unit:
    """The unit of an FMI name; `1` is a plain number. Raises pint's error for an unknown unit."""
    if unit == "1":
        return REGISTRY.Unit("")
    parts = ("*".join(_power(factor) for factor in part.split(".")) for part in unit.split("/"))
    return REGISTRY.Unit("/".join(parts))


@cache
def base_exponents(unit: str) -> dict[str, int]:
    """Exponents of kg, m, s, rad of an FMI unit name such as `N.m/rad` or `m/s2`.

    Raises ValueError for a unit that is no product of these with factor one.
    """
    base = REGISTRY.Quantity(1.0, parse(unit)).to_base_units()
    exponents = {str(name): power for name, power in base.unit_items()}
    if abs(base.magnitude - 1.0) > 1e-12:
        raise ValueError(f"unit {unit!r} is not SI: it is {base}")
    unknown = set(exponents) - set(BASE)
    if unknown:
        raise ValueError(f"unit {unit!r} has base units other than kg, m, s, rad: {unknown}")
    return {BASE[name]: _whole(unit, power) for name, power in sorted(exponents.items()) if power}


def _power(factor: str) -> str:
    stem = factor.rstrip("0123456789")
    return f"{stem}**{factor[len(stem) :]}" if stem and len(stem) < len(factor) else factor


def _whole(unit: str, power: Any) -> int:
    if power != int(power):
        raise ValueError(f"unit {unit!r} has a broken exponent {power}")
    return int(power)
