"""Units of FMI variables: which may drive which, and the affine conversion between them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from ..errors import DimensionError, MixtureError, UnitError
from .common_units import common

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

_BASE_UNITS = {
    "kilogram": "kg",
    "meter": "m",
    "second": "s",
    "ampere": "A",
    "kelvin": "K",
    "mole": "mol",
    "candela": "cd",
    "radian": "rad",
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


def definitions(read: Any) -> dict[str, BaseUnit]:
    """Units that a model description defines, as fmpy reads it."""
    return {
        unit.name: BaseUnit(
            {k: getattr(unit.baseUnit, k) for k in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")},
            unit.baseUnit.factor,
            unit.baseUnit.offset,
        )
        for unit in read.unitDefinitions
        if unit.baseUnit is not None
    }


def scale_of(unit: str, definitions: Definitions | None = None) -> Scale:
    """Scale of a unit as its file defines it, else as FMI or pint writes it; raises UnitError."""
    if definitions and unit in definitions:
        return definitions[unit].scale()
    return _known_scale(unit)


@dataclass(frozen=True)
class Unit:
    """A unit by name, what the file that it comes from says of it, and what its values are.

    difference: whether they are differences, for which FMI has `relativeQuantity` and which no
    offset belongs to: 10 degC are 10 K. None: as at the other end.
    """

    name: str
    definitions: Definitions = field(default_factory=dict)
    difference: bool | None = None

    @property
    def scale(self) -> Scale:
        """As the file defines it, else as FMI or pint writes it; raises UnitError."""
        return scale_of(self.name, self.definitions)

    def to(self, target: Unit) -> tuple[float, float] | None:
        """Gain and offset from this unit to another; None if they measure different things.

        Units of one name are the same, known or not, unless both files define it, and differently.
        Raises UnitError for one that is not known, MixtureError for a difference at one end alone
        where an offset would tell it from the whole.
        """
        if self.name == target.name:
            own, other = (unit.definitions.get(unit.name) for unit in (self, target))
            if own is None or other is None or own == other:
                return 1.0, 0.0
        first, second = self.scale, target.scale
        found = first.to(second)
        if found is None:
            return None
        differences = {self.difference, target.difference}
        if True not in differences:
            return found
        if False in differences and (second if self.difference else first).offset:
            raise MixtureError(
                f"only {'the first' if self.difference else 'the second'} is a difference "
                "(relativeQuantity), and the zero of the other one is its own"
            )
        return found[0], 0.0


def conversion(
    source: str,
    target: str,
    source_definitions: Definitions | None = None,
    target_definitions: Definitions | None = None,
) -> tuple[float, float] | None:
    """Gain and offset from one unit to another; None if they measure different things."""
    return Unit(source, source_definitions or {}).to(Unit(target, target_definitions or {}))


@dataclass(frozen=True)
class Quantity:
    """A number with its unit; an empty unit where none was given."""

    value: float
    unit: str = ""

    @classmethod
    def parsed(cls, text: str) -> Quantity:
        """Number and unit of text such as "200 lbf/in"; raises UnitError without a number."""
        match = _NUMBER.fullmatch(text.strip())
        if match is None:
            raise UnitError(f"'{text}' is no number with a unit")
        return cls(float(match[1]), match[2].strip())

    def to(self, unit: str) -> float:
        """The value in another unit; raises UnitError, DimensionError where that cannot be."""
        found = conversion(self.unit, unit)
        if found is None:
            raise DimensionError(f"{self} is of {self.dimension}, which cannot be in {unit or '1'}")
        gain, offset = found
        return gain * self.value + offset

    @property
    def dimension(self) -> str:
        """What it measures, as "[mass]" or "[length] / [time]"; raises UnitError."""
        return str(_parsed(self.unit).dimensionality)

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit}".rstrip()


def base_unit(unit: str, definitions: Definitions) -> BaseUnit | None:
    """A unit by exponents of SI base units, as the FMU defines it or as pint knows it.

    None for one with broken exponents, which FMI and SSP cannot define. Raises UnitError.
    """
    if unit in definitions:
        return definitions[unit]
    scale = scale_of(unit)
    powers = dict(registry().Quantity(1.0, _parsed(unit)).to_base_units().unit_items())
    if any(power != int(power) for power in powers.values()):
        return None
    exponents = {_BASE_UNITS[name]: int(power) for name, power in sorted(powers.items())}
    return BaseUnit(exponents, scale.factor, scale.offset)


@cache
def _known_scale(unit: str) -> Scale:
    if found := common(_spelled_for_pint(unit)):
        factor, exponents = found
        known = zip(("[mass]", "[length]", "[time]"), exponents, strict=True)
        return Scale(factor, 0.0, {name: float(n) for name, n in known if n})
    parsed = _parsed(unit)
    zero, one = (registry().Quantity(n, parsed).to_base_units().magnitude for n in (0.0, 1.0))
    dimension = {k: float(n) for k, n in dict(parsed.dimensionality).items()}
    return Scale(float(one - zero), float(zero), dimension)


def _parsed(unit: str) -> Any:
    """The unit as pint has it; raises UnitError."""
    units = registry()
    for spelling in dict.fromkeys((_spelled_for_pint(unit), unit)):
        try:
            parsed = units.Unit(spelling)
            units.Quantity(1.0, parsed).to_base_units()
        except Exception:  # pint raises many kinds, tokenizer errors among them
            continue
        return parsed
    raise UnitError(f"'{unit}' is not a known unit")


def _spelled_for_pint(unit: str) -> str:
    """FMI's "kg.m2/s2" as "kg*m**2/s**2"; "1" is no unit."""
    unit = re.sub(r"(?<=[^\W_])\.(?=[^\W\d])|(?<=\))\.|\.(?=\()", "*", unit.strip())
    unit = re.sub(r"(?<=[^\W\d_])(-?\d)", r"**\1", unit)
    return "dimensionless" if unit in ("", "1") else unit


def registry() -> Any:
    """The units of all packages, which take their time and are therefore read when first needed."""
    import pint

    return pint.get_application_registry()
