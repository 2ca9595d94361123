"""Unit definitions of a model description: base exponents of the unit names that we use."""

from __future__ import annotations

from functools import cache
from typing import Any
from xml.etree.ElementTree import Element, SubElement

from ...describe.units import (
    REGISTRY,
    parse,
)

BASE = {"kilogram": "kg", "meter": "m", "second": "s", "radian": "rad"}
DISPLAY = {"rad": ("deg", 57.29577951308232)}


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


def _whole(unit: str, power: Any) -> int:
    if power != int(power):
        raise ValueError(f"unit {unit!r} has a broken exponent {power}")
    return int(power)


def unit_definitions(units: set[str]) -> Element:
    """The UnitDefinitions element for the unit names, sorted."""
    definitions = Element("UnitDefinitions")
    for unit in sorted(units):
        element = SubElement(definitions, "Unit", name=unit)
        if "^" in unit:  # FMI has whole exponents only; such a unit is known by its name
            continue
        exponents = {name: str(power) for name, power in base_exponents(unit).items()}
        SubElement(element, "BaseUnit", exponents)
        if unit in DISPLAY:
            name, factor = DISPLAY[unit]
            SubElement(element, "DisplayUnit", name=name, factor=repr(factor))
    return definitions
