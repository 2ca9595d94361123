"""Units that results are shown in: one of SI's, and the report's beside it."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from importlib.resources import files

FOOT = 0.3048
INCH = 0.0254
POUND_FORCE = 4.4482216152605
GRAVITY = 9.80665
MILE_PER_HOUR = 0.44704


_REST = tomllib.loads(files(__package__).joinpath("scales.toml").read_text("utf-8")).values()

REST: dict[str, float] = {entry["unit"]: float(entry["value"]) for entry in _REST}
"""By unit, the size up to which a signal of a car is at rest."""


@dataclass(frozen=True)
class Scale:
    """A unit to show a quantity in, and the report's; factors are per SI unit.

    rest: the size [SI] up to which nothing moves.
    """

    unit: str
    factor: float
    report_unit: str = ""
    report_factor: float = 1.0
    rest: float = 0.0

    @property
    def units(self) -> str:
        """Both units, as `kN (lb)`."""
        return f"{self.unit} ({self.report_unit})" if self.report_unit else self.unit

    def numbers(self, value: float) -> str:
        """`value` [SI] in both units to three digits, as `5.34 (1,200)`."""
        number = three_digits(value * self.factor)
        return f"{number} ({self.report_number(value)})" if self.report_unit else number

    def words(self, value: float) -> str:
        """`value` [SI] with both units, as `5.34 kN (1,200 lb)`."""
        text = f"{three_digits(value * self.factor)} {self.unit}".rstrip()
        if self.report_unit:
            text += f" ({self.report_number(value)} {self.report_unit})"
        return text

    def report_number(self, value: float) -> str:
        """`value` [SI] in the report's unit, to three digits."""
        return three_digits(value * self.report_factor)


FORCE = Scale("kN", 1e-3, "lb", 1.0 / POUND_FORCE, REST["N"])
DISPLACEMENT = Scale("mm", 1e3, "in", 1.0 / INCH, REST["m"])
ACCELERATION = Scale("m/s²", 1.0, "g", 1.0 / GRAVITY, REST["m/s2"])
ANGLE = Scale("mrad", 1e3, "deg", 180.0 / math.pi, REST["rad"])
RATIO = Scale("", 1.0, rest=REST["1"])


def three_digits(value: float) -> str:
    """`value` rounded to three digits, thousands set apart."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}" if 1e3 <= abs(rounded) < 1e6 else f"{rounded:.3g}"
