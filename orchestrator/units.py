"""Units of FMI variables: which may drive which, and the affine conversion between them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from .errors import UnitError

_NUMBER = re.compile(
    r"\s*([+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|inf(?:inity)?))(.*)", re.I
)
_DIMENSIONS = {
    "kg": "[mass]",
    "m": "[length]",
    "s": "[time]",
    "A": "[current]",
    "K": "[temperature]",
    "mol": "[substance]",
    "cd": "[luminosity]",
}


@dataclass(frozen=True)
class Scale:
    """A unit: base SI value = factor * value + offset, and the exponents of the base dimensions."""

    factor: float
    offset: float
    dimension: Mapping[str, float]

    def to(self, target: Scale) -> tuple[float, float] | None:
        """Gain and offset that turn a value of this unit into `target`'s; None if they differ."""
        if dict(self.dimension) != dict(target.dimension):
            return None
        return self.factor / target.factor, (self.offset - target.offset) / target.factor


@dataclass(frozen=True)
class BaseUnit:
    """An FMU's own definition of a unit by the exponents of SI base units."""

    exponents: Mapping[str, int] = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0

    def scale(self) -> Scale:
        """The definition as a scale; an angle has no dimension."""
        dimension = {
            _DIMENSIONS[k]: float(n) for k, n in self.exponents.items() if k != "rad" and n
        }
        return Scale(self.factor, self.offset, dimension)


Definitions = Mapping[str, BaseUnit]


def scale_of(unit: str, definitions: Definitions | None = None) -> Scale:
    """Scale of a unit as FMI or pint writes it, else as the FMU defines it; raises UnitError."""
    try:
        return _pint_scale(unit)
    except UnitError:
        if definitions and unit in definitions:
            return definitions[unit].scale()
        raise


def conversion(
    source: str,
    target: str,
    source_definitions: Definitions | None = None,
    target_definitions: Definitions | None = None,
) -> tuple[float, float] | None:
    """Gain and offset from one unit to another; None if they measure different things."""
    if source == target:
        return 1.0, 0.0
    return scale_of(source, source_definitions).to(scale_of(target, target_definitions))


def quantity(text: str) -> tuple[float, str]:
    """Number and unit of "200 lbf/in"; the unit may be empty. Raises UnitError without a number."""
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        raise UnitError(f"'{text}' is no number with a unit")
    return float(match[1]), match[2].strip()


@cache
def _pint_scale(unit: str) -> Scale:
    registry = _registry()
    for spelling in dict.fromkeys((_spelled_for_pint(unit), unit)):
        try:
            parsed = registry.Unit(spelling)
            zero, one = (registry.Quantity(n, parsed).to_base_units().magnitude for n in (0.0, 1.0))
        except Exception:  # pint raises many kinds, tokenizer errors among them
            continue
        dimension = {k: float(n) for k, n in dict(parsed.dimensionality).items()}
        return Scale(float(one - zero), float(zero), dimension)
    raise UnitError(f"'{unit}' is not a known unit")


def _spelled_for_pint(unit: str) -> str:
    """FMI's "kg.m2/s2" as "kg*m**2/s**2"; "1" is no unit."""
    unit = re.sub(r"(?<=[^\W_])\.(?=[^\W\d])|(?<=\))\.|\.(?=\()", "*", unit.strip())
    unit = re.sub(r"(?<=[^\W\d_])(-?\d)", r"**\1", unit)
    return "dimensionless" if unit in ("", "1") else unit


def _registry() -> Any:
    import pint

    return pint.get_application_registry()
