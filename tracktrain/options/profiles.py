"""Options of a pair of profiles: how the wheels stand on the axle, and the rails in the track."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import click

from .fields import adding
from .types import Quantity

LENGTH = ("mm", "in", "m")
STEEPEST = 0.2
"""Inclination of a rail, at most."""
YAW = Quantity("yaw", "rad", ("mrad", "deg", "rad"), "20 mrad", most="100 mrad")
"""Of a wheelset. From some 50 mrad on flanges meet their rails with their tips."""


class Inclination(click.ParamType):
    """1:40, 1/40, 0.025 or 0 as a number; two with a comma are left and right."""

    name = "inclination"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | tuple[float, float]:
        if not isinstance(value, str):
            return value
        found = [self._number(text) for text in value.replace("/", ":").split(",")]
        if len(found) > 2 or not all(abs(number) <= STEEPEST for number in found):
            self.fail(
                f"'{value}' is no inclination; give one such as 1:40, 1:20 or 0, or left and right "
                "as in 1:40,1:20",
                param,
                ctx,
            )
        return found[0] if len(found) == 1 else (found[0], found[1])

    @staticmethod
    def _number(text: str) -> float:
        one, _, to = text.partition(":")
        try:
            return float(one) / (float(to) if to else 1.0)
        except (ValueError, ZeroDivisionError):
            return math.nan


def _length(name: str, default: str, text: str) -> Callable[[Any], Any]:
    kind = Quantity(name.strip("-").replace("-", " "), "m", LENGTH, default)
    return click.option(
        name, type=kind, default=default, show_default=True, metavar="LENGTH", help=text
    )


RADIUS = Quantity("rolling radius", "m", LENGTH, "459 mm")


def right_radius_option() -> Callable[[Any], Any]:
    """--right-radius, of the wheels on the right [m]."""
    return click.option(
        "--right-radius",
        type=RADIUS,
        metavar="LENGTH",
        help="Rolling radius of the right wheels, if not as that of the left ones.",
    )


SIDES = (
    click.option("--right-wheel", metavar="WHEEL", help="If not as the left one."),
    click.option("--right-rail", metavar="RAIL", help="If not as the left one."),
    right_radius_option(),
)

PAIRING = (
    _length("--rolling-radius", "16.5 in", "Of the wheels, at their tape circles."),
    _length("--tape-spacing", "59.5 in", "From tape circle to tape circle."),
    _length("--gauge", "56.5 in", "Of the track."),
    _length("--gauge-depth", "0.625 in", "Below the rails' tops, where the gauge is measured."),
    click.option(
        "--inclination",
        type=Inclination(),
        default="1:40",
        show_default=True,
        metavar="1:N[,1:N]",
        help="Of the rails, to the inside; or of the left and the right one.",
    ),
    click.option(
        "--say",
        "says",
        multiple=True,
        metavar="[wheel.|rail.]KEY=VALUE",
        help="What a file does not say of itself, such as 'rail.y_positive=inside' or "
        "'wheel.smoothing=5 mm' (docs/profiles.md). Repeatable.",
    ),
)


def pairing_options() -> Callable[[Any], Any]:
    """rolling_radius, tape_spacing, gauge, gauge_depth [m], inclination [1], says; and of the right
    side right_wheel, right_rail, right_radius [m]."""
    return adding((*PAIRING, *SIDES))


def on_the_right(given: dict[str, Any]) -> dict[str, Any]:
    """What `Pairing.placed` and `contact_table` take of the right side, out of a command's."""
    right = given.pop("right_wheel"), given.pop("right_rail")
    return {"right": right, "right_radius": given.pop("right_radius")}
