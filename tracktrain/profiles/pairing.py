"""A wheel and a rail as a wheelset on a track."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fmus.profiles import tables
from fmus.profiles.geometry import Track, Wheelset
from fmus.wheelrail.contact_table import ContactTable
from orchestrator import choices

from ..geometry.errors import GeometryError
from .reading import KEYS, profile_of

INCH = 0.0254


@dataclass(frozen=True)
class Pairing:
    """Where wheels and rails lie; [m], inclination [1].

    Of the freight car: wheels of 33 in, tape circles above the middles of the rails, gauge 56.5 in
    measured 5/8 in below the top, rails inclined by 1 in 40.
    """

    rolling_radius: float = 16.5 * INCH
    tape_spacing: float = 59.5 * INCH
    gauge: float = 56.5 * INCH
    gauge_depth: float = 0.625 * INCH
    inclination: float | tuple[float, float] = 1 / 40

    def placed(
        self,
        wheel: str | Path,
        rail: str | Path,
        says: Sequence[str] = (),
        right: tuple[str | Path | None, str | Path | None] = (None, None),
        right_radius: float | None = None,
    ) -> tuple[Wheelset, Track]:
        """Of files or shapes; says: `wheel.key=value`, `rail.key=value`, or `key=value` of both.

        right: wheel and rail of the right side, where it is not as the left one.
        """
        on_wheel, on_rail = (said_of(kind, says) for kind in ("wheel", "rail"))
        left = profile_of(wheel, on_wheel, "wheel"), profile_of(rail, on_rail, "rail")
        other_wheel = profile_of(right[0], on_wheel, "wheel") if right[0] else None
        other_rail = profile_of(right[1], on_rail, "rail") if right[1] else None
        return (
            Wheelset(left[0], self.rolling_radius, self.tape_spacing, other_wheel, right_radius),
            Track(left[1], self.gauge, self.gauge_depth, self.inclination, other_rail),
        )


def said_of(kind: str, says: Sequence[str]) -> list[str]:
    """What is said of one of the two; raises GeometryError for what is said of neither."""
    found = []
    for text in says:
        of, dot, rest = text.partition(".")
        named = of.strip() in ("wheel", "rail") and dot
        if not named and "=" not in text:
            raise GeometryError(f"--say '{text}' cannot be read; {choices(text, KEYS)}")
        if not named or of.strip() == kind:
            found.append(rest if named else text)
    return found


def contact_table(
    wheel: str | Path,
    rail: str | Path,
    pairing: Pairing | None = None,
    says: Sequence[str] = (),
    yaw: float = 0.0,
    right: tuple[str | Path | None, str | Path | None] = (None, None),
    right_radius: float | None = None,
) -> ContactTable:
    """The table of a wheel and a rail, each a file or the name of a shape.

    yaw: largest one [rad] of a table over yaw; 0 for one without. right, right_radius: as
    `Pairing.placed` has them.
    """
    placed = (pairing or Pairing()).placed(wheel, rail, says, right, right_radius)
    return tables.contact_table(*placed, yaw=yaw)
