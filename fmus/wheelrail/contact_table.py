"""The contact geometry of a wheel profile on a rail profile: tables over the lateral shift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import ParameterError

IN_FMU = "extra/org.tracktrain/contact.csv"
"""Place of the table in the FMU of a wheelset on profiles."""

SIDE, YAW = "side", "yaw [rad]"
"""Columns of the side and the yaw angle in its text, where it has some."""

FEWEST = 4
"""Nodes that a cubic spline needs."""

STEEPEST = np.radians(89.0)
"""Contact angle [rad] beyond which forces have no bound."""


@dataclass(frozen=True)
class Patch:
    """One contact of a wheel, node by node; all columns (nodes,) are smooth.

    over: shift or climb [m], equally spaced; see `ContactTable`
    radius: rolling radius [m]
    angle: of the contact plane to the track plane [rad], above zero on a tread that rises outwards
    roll: of the wheelset [rad], above zero where it lifts this wheel
    place: lateral distance of the contact from the middle of the wheelset [m]
    height: by how much this wheel is lifted [m]
    wheel_curvature, rail_curvature: of the profiles in their own plane [1/m], convex above zero
    """

    over: np.ndarray
    radius: np.ndarray
    angle: np.ndarray
    roll: np.ndarray
    place: np.ndarray
    height: np.ndarray
    wheel_curvature: np.ndarray
    rail_curvature: np.ndarray

    def columns(self) -> dict[str, np.ndarray]:
        """All columns by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def check(self, name: str) -> None:
        """Raise ParameterError for what makes no contact; name: of the table and the patch."""
        count = self.over.size
        shapes = {field: column.shape for field, column in self.columns().items()}
        if count < FEWEST or set(shapes.values()) != {(count,)}:
            raise ParameterError(
                f"{name} has columns of the shapes {shapes}; give {FEWEST} nodes at least, and "
                "every column at each node"
            )
        if not all(np.isfinite(column).all() for column in self.columns().values()):
            raise ParameterError(f"{name} has values that are not finite; give finite numbers")
        steps = np.diff(self.over)
        if not (steps > 0).all() or np.ptp(steps) > 1e-6 * steps.mean():
            raise ParameterError(f"{name} is not equally spaced, rising; give equal steps")
        if np.abs(self.angle).max() > STEEPEST:
            raise ParameterError(
                f"{name} has a contact angle of {np.degrees(np.abs(self.angle).max()):.3g} deg; "
                f"give angles below {np.degrees(STEEPEST):.3g} deg"
            )
        flat = self.wheel_curvature + self.rail_curvature
        if not ((flat > 0).all() and (self.radius > 0).all() and (self.place > 0).all()):
            raise ParameterError(
                f"{name} has a contact that is no point: radius and place must be above zero, and "
                "so must the sum of the two curvatures (a convex rail in a hollow wheel that is "
                "less curved)"
            )


@dataclass(frozen=True)
class ContactTable:
    """A wheel on its rail: the left one, and the right one too where that is alike.

    name: of the pair. rolling_radius: nominal one [m]. tread: over the shift of the wheel towards
    its own rail [m], up to the shift at which the flange touches; the wheelset is rolled so that
    both wheels touch. flange: over the climb [m], by how much the wheel is shifted beyond that with
    the flange alone on the rail, from 0; None where none touches. said: where it comes from, a line
    each. yawed: the same at further yaw angles [rad], rising from above zero, its nodes as far from
    the shift at which the flange touches; none where the contacts are taken as those of no yaw.
    right: the same of the right wheel over its own shift, at the same yaw angles, where it is not
    as the left one. Raises ParameterError.
    """

    name: str
    rolling_radius: float
    tread: Patch
    flange: Patch | None = None
    said: tuple[str, ...] = ()
    yawed: Mapping[float, ContactTable] = field(default_factory=dict)
    right: ContactTable | None = None

    def __post_init__(self) -> None:
        for part, patch in self.patches().items():
            patch.check(f"{self.name}, {part}")
        first, last = self.tread.over[[0, -1]]
        if not first < 0 < last:
            raise ParameterError(
                f"{self.name}: the tread is given from {first:g} to {last:g} m; give it on both "
                "sides of shift 0"
            )
        if self.flange is not None and self.flange.over[0] != 0:
            raise ParameterError(
                f"{self.name}: the flange begins at a climb of {self.flange.over[0]:g} m; give it "
                "from 0"
            )
        self._check_yawed()
        self._check_right()

    def _check_yawed(self) -> None:
        yaws = (0.0, *self.yawed)
        if not (np.diff(yaws) > 0).all() or not np.isfinite(yaws).all():
            raise ParameterError(
                f"{self.name} is given at yaw angles of {', '.join(map(str, self.yawed))} rad; "
                "give them above zero, rising"
            )
        for yaw, other in self.yawed.items():
            patches = other.patches()
            alike = other.rolling_radius == self.rolling_radius
            alike &= not other.yawed and other.right is None
            alike &= patches.keys() == self.patches().keys() and all(
                patch.over.shape == patches[name].over.shape
                and np.allclose(np.diff(patch.over), np.diff(patches[name].over), atol=1e-9)
                for name, patch in self.patches().items()
            )
            if not alike:
                raise ParameterError(
                    f"{self.name} has other nodes, patches or another radius at a yaw of {yaw:g} "
                    "rad; give the same ones, as far from the shift at which the flange touches"
                )

    def _check_right(self) -> None:
        other = self.right
        if other is None:
            return
        same = other.rolling_radius == self.rolling_radius and other.right is None
        same &= other.patches().keys() == self.patches().keys()
        if not same or [*other.yawed] != [*self.yawed]:
            raise ParameterError(
                f"{self.name} has other patches, yaw angles or another nominal radius on the right "
                "than on the left; give the same ones, and both wheels a flange or neither"
            )

    @cached_property
    def different(self) -> tuple[ContactTable, ...]:
        """The table of the left wheel and that of the right one; one of both where they are
        alike."""
        return (self,) if self.right is None else (replace(self, right=None), self.right)

    @property
    def sides(self) -> dict[str, ContactTable]:
        """Left and right, each as a table of its own."""
        return {"left": self.different[0], "right": self.different[-1]}

    @property
    def over_yaw(self) -> dict[float, ContactTable]:
        """This table at yaw 0, and those at further yaw angles [rad]."""
        return {0.0: self, **self.yawed}

    @property
    def clearance(self) -> float:
        """Least shift at which a flange touches, or the table ends [m]."""
        return min(float(side.tread.over[-1]) for side in self.different)

    @property
    def half_spacing(self) -> float:
        """Half distance of the contact points of a centred wheelset [m]."""
        treads = [side.tread for side in self.sides.values()]
        return sum(float(np.interp(0.0, tread.over, tread.place)) for tread in treads) / 2

    @property
    def flange_angle(self) -> float:
        """Steepest contact angle, of the side on which that is less [rad]."""
        return min(
            float(max(patch.angle.max() for patch in side.patches().values()))
            for side in self.different
        )

    def patches(self) -> dict[str, Patch]:
        """Tread and flange, as far as there are; the left ones."""
        parts = {"tread": self.tread, "flange": self.flange}
        return {name: patch for name, patch in parts.items() if patch is not None}


def as_text(table: ContactTable) -> str:
    """The table as CSV, to the last bit: said lines after #, then a row for each node.

    Columns of side and yaw stand first in a table whose sides differ, or that has some yaw.
    """
    lines = [f"# {line}" for line in (table.name, *table.said)]
    lines.append(f"# rolling_radius = {table.rolling_radius!r} m")
    keys = [*([SIDE] if table.right else []), *([YAW] if table.yawed else [])]
    lines.append(",".join([*keys, "patch", *_heads()]))
    for side, own in table.sides.items() if table.right else [("", table)]:
        for yaw, at_yaw in own.over_yaw.items():
            places = {SIDE: side, YAW: repr(float(yaw))}
            first = [places[key] for key in keys]
            for name, patch in at_yaw.patches().items():
                rows = zip(*patch.columns().values(), strict=True)
                lines += [",".join([*first, name, *(repr(float(v)) for v in row)]) for row in rows]
    return "\n".join(lines) + "\n"


def of_text(text: str) -> ContactTable:
    """The table of such a text; raises ParameterError."""
    said = [line[2:] for line in text.splitlines() if line.startswith("# ")]
    rows = [line.split(",") for line in text.splitlines() if line and not line.startswith("#")]
    try:
        for place, (key, usual) in enumerate(((SIDE, "left"), (YAW, "0"))):
            if rows[0][place] != key:
                for number, row in enumerate(rows):
                    row.insert(place, usual if number else key)
        if rows[0] != [SIDE, YAW, "patch", *_heads()]:
            raise ValueError(f"the columns are {', '.join(rows[0])}")
        radius = float(said[-1].removeprefix("rolling_radius = ").removesuffix(" m"))
        found: dict[str, dict[float, dict[str, list[list[float]]]]] = {}
        for side, yaw, patch, *numbers in rows[1:]:
            parts = found.setdefault(side, {}).setdefault(float(yaw), {})
            parts.setdefault(patch, []).append([float(number) for number in numbers])
        left = _over_yaw(said[0], radius, found["left"])
        other = found.get("right")
        right = _over_yaw(f"{said[0]} (right)", radius, other) if other else None
        return replace(left, said=tuple(said[1:-1]), right=right)
    except (ValueError, IndexError, TypeError, KeyError) as error:
        raise ParameterError(
            f"a contact table cannot be read: {error}; 'tracktrain profile build' makes such"
        ) from None


def _over_yaw(
    name: str, radius: float, found: Mapping[float, Mapping[str, list[list[float]]]]
) -> ContactTable:
    """The table of one side, of rows by yaw angle [rad] and patch."""
    tables: dict[float, ContactTable] = {}
    for angle, parts in found.items():
        patches: dict[str, Any] = {patch: Patch(*np.array(v).T) for patch, v in parts.items()}
        tables[angle] = ContactTable(name, radius, **patches)
    straight = tables.pop(0.0)
    return replace(straight, yawed=tables)


def _heads() -> list[str]:
    units = {"angle": "rad", "roll": "rad", "wheel_curvature": "1/m", "rail_curvature": "1/m"}
    return [f"{field.name} [{units.get(field.name, 'm')}]" for field in fields(Patch)]
