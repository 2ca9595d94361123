"""Unit names as FMI writes them, such as `N.m/rad` or `m/s2`, read with pint.

Those of the shipped parameter sets are known here: pint takes a second to load.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

INCH, POUND = 0.0254, 0.45359237
"""[m], [kg]; exact."""

LBF = POUND * 9.80665
"""[N]; exact."""

GAINS = {
    ("GPa", "Pa"): 1e9,
    ("deg", "rad"): math.pi / 180,
    ("in", "m"): INCH,
    ("lb", "kg"): POUND,
    ("lbf", "N"): LBF,
    ("lbf*in", "N.m"): LBF * INCH,
    ("lbf*in*s**2", "kg.m2"): LBF * INCH,
    ("lbf*in/rad", "N.m/rad"): LBF * INCH,
    ("lbf/in", "N/m"): LBF / INCH,
}
"""What a number in the first unit is multiplied by to be in the second one."""

PLAIN = {"1", "1/m", "Hz", "kg", "m", "m/s", "N", "N.m", "N/m", "Pa", "rad", "s", "s/m"}
"""Units that are known to be some."""

BASE = {"kilogram": "kg", "meter": "m", "second": "s", "radian": "rad"}


class MismatchError(ValueError):
    """Units of different things. own, other: their dimensions."""

    def __init__(self, own: str, other: str) -> None:
        super().__init__(f"{own} is not {other}")
        self.own, self.other = own, other


def registry() -> pint.UnitRegistry:
    """The units of all packages."""
    import pint

    return pint.get_application_registry()


def gain(unit: str, target: str) -> float:
    """What a number in a unit, written for pint, is multiplied by to be in an FMI unit.

    A unit is always its own, also one that FMI knows by its name alone. Raises MismatchError, and
    pint's errors for a unit that is not known.
    """
    if unit == target:
        return 1.0
    return GAINS.get((unit, target)) or _by_pint(unit, target)


def is_known(unit: str) -> bool:
    """Whether a unit, written for pint, is one."""
    if unit in PLAIN or any(unit == own for own, _ in GAINS):
        return True
    try:
        registry().Unit(unit)
    except Exception:  # pint raises many kinds, tokenizer errors among them
        return False
    return True


@cache
def _by_pint(unit: str, target: str) -> float:
    own = registry().Quantity(1.0, "" if unit == "1" else unit)
    goal = parse(target)
    if own.dimensionality != goal.dimensionality:
        raise MismatchError(str(own.dimensionality), str(goal.dimensionality))
    return float(own.to(goal).magnitude)


def parse(unit: str) -> pint.Unit:
    """The unit of an FMI name; `1` is a plain number. Raises pint's error for an unknown unit."""
    if unit == "1":
        return registry().Unit("")
    parts = ("*".join(_power(factor) for factor in part.split(".")) for part in unit.split("/"))
    return registry().Unit("/".join(parts))


@cache
def base_exponents(unit: str) -> dict[str, int]:
    """Exponents of kg, m, s, rad of an FMI unit name such as `N.m/rad` or `m/s2`.

    Raises ValueError for a unit that is no product of these with factor one.
    """
    base = registry().Quantity(1.0, parse(unit)).to_base_units()
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
