"""The contact geometry of a wheelset on its rails as the table that a wheelset block holds."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from ..errors import ParameterError
from ..wheelrail.contact_table import ContactTable, Patch
from .geometry import (
    SIDES,
    ContactGeometry,
    Jump,
    Track,
    Wheelset,
    climbing_geometry,
    contact_geometry,
)
from .profile import Array
from .trace import Points

NODE = 1e-4
"""Distance of the table's nodes [m], at most."""
STEEP = np.radians(25.0)
"""A contact plane that is steeper is that of a flange [rad]."""
CLIMB = 4e-3
"""How far the flange is followed up the rail [m]."""
WITHOUT_FLANGE = 8e-3
"""How far a wheel without a flange is followed [m]."""
OFF_TREAD = 0.01
"""Rolling radius less the nominal one [m] that no tread has."""
FARTHEST, SEARCH = 0.025, 2.5e-4
"""Largest shift, and steps [m] at which the flange's contact is looked for."""
RISEN = 1e-4
"""Roll [rad] from a tread's last contact to a flange's first from which on they are not one."""
ELASTIC = 2e-5
"""Gap [m] over which a second contact on a tread that jumps loses its part to e^-1: some part of
the 0.1 mm by which wheel and rail approach each other under a wheel load."""


YAW_NODES = 3
"""Of a table over yaw, with that of none, as far from each other in the yaw's square: contacts are
even in yaw, and smooth, so that they go with it."""

Begins = tuple[float, Jump | None] | None
"""What `flange_begins` finds."""


def contact_table(
    wheelset: Wheelset, track: Track, climb: float = CLIMB, yaw: float = 0.0
) -> ContactTable:
    """The table of a wheelset on a track; of both sides where they are not alike.

    The tread ends where the flange touches, which is then followed for `climb` [m]; wheels
    without flanges have their treads alone, to `WITHOUT_FLANGE` on both sides. yaw: largest one
    [rad] of a table over yaw, 0 for one without. Raises ParameterError for profiles whose flange
    does not touch, and for a flange on one side alone.
    """
    sides = [(wheelset, track)]
    if not (wheelset.alike and track.alike):
        sides.append((wheelset.mirrored, track.mirrored))
    begins = [flange_begins(*side) for side in sides]
    if (begins[0] is None) != (begins[-1] is None):
        raise ParameterError(
            "one wheel has a flange and the other has none; give both one, or neither"
        )
    found = [
        _of_left(*side, own, begins[-1 - number], climb, yaw)
        for number, (side, own) in enumerate(zip(sides, begins, strict=True))
    ]
    if len(found) == 1:
        return found[0]
    left, right = found
    said = [line for line in left.said if line in right.said]
    for side, table in zip(SIDES, found, strict=True):
        said += [f"{side}: {line}" for line in table.said if line not in said]
    name = f"{left.name}, right {right.name}"
    return replace(left, name=name, said=tuple(said), right=right)


def _of_left(
    wheelset: Wheelset, track: Track, begins: Begins, opposite: Begins, climb: float, yaw: float
) -> ContactTable:
    """The table of the left wheel; begins, opposite: what `flange_begins` has of both."""
    straight = _Solved.found(wheelset, track, begins, *_spaced(begins, opposite, climb))
    angles = yaw * np.sqrt(np.linspace(0.0, 1.0, YAW_NODES)[1:]) if yaw else ()
    nodes = [straight, *(straight.yawed(float(angle)) for angle in angles)]
    jumping = next((node for node in nodes if node.rounded), None)
    said = [*wheelset.left.said, *track.left.said]
    if jumping is not None:
        places = ", ".join(f"{j.shift * 1e3:.3g}" for j in jumping.rounded)
        said.append(
            f"the contact jumps on the tread at shifts of {places} mm: means over all places, "
            f"weighted by exp(-gap/{ELASTIC * 1e6:g} um)"
        )
    if straight.flange is None:
        said.append("the wheel has no flange")
    elif straight.snaps:
        steep, above = np.degrees(np.abs(straight.flange.left.angle[:2]))
        said.append(
            f"the flange is so steep, {steep:.3g} deg, that the wheelset rolls away from it as it "
            f"climbs: it comes to rest at once above that, at {above:.3g} deg"
        )
    tables = [node.table(means=jumping is not None) for node in nodes]
    if yaw:
        ends = " to ".join(f"{table.clearance * 1e3:.3f}" for table in (tables[0], tables[-1]))
        said.append(
            f"yaw from 0 to {yaw * 1e3:g} mrad, along which the flange touches at {ends} mm"
        )
    yawed = dict(zip(map(float, angles), tables[1:], strict=True))
    return replace(tables[0], said=tuple(said), yawed=yawed)


@dataclass(frozen=True, eq=False)
class _Solved:
    """The contacts of one yaw. clearance: shift at which the flange touches [m], and the jump of
    the contact there, if any; over, climb: nodes of tread and flange [m], none of a flange that
    there is not."""

    clearance: float
    jump: Jump | None
    over: Array
    climb: Array
    tread: ContactGeometry
    flange: ContactGeometry | None

    @classmethod
    def found(
        cls,
        wheelset: Wheelset,
        track: Track,
        begins: Begins,
        over: Array,
        climb: Array,
        yaw: float = 0.0,
    ) -> _Solved:
        """begins: what `flange_begins` has."""
        clearance, jump = begins or (float(over[-1]), None)
        tread = contact_geometry(wheelset, track, over, yaw)
        flange = climbing_geometry(wheelset, track, clearance + climb, yaw) if begins else None
        return cls(clearance, jump, over, climb, tread, flange)

    def yawed(self, yaw: float) -> _Solved:
        """The same at a yaw [rad], its nodes as far from the shift at which the flange touches."""
        wheelset, track = self.tread.wheelset, self.tread.track
        begins = flange_begins(wheelset, track, yaw)
        over = self.over + (begins[0] - self.clearance if begins else 0.0)
        return self.found(wheelset, track, begins, over, self.climb, yaw)

    @property
    def rounded(self) -> list[Jump]:
        """Jumps of the contact on the tread."""
        last = self.clearance - (self.over[1] - self.over[0])
        return [j for j in self.tread.jumps if j.side == "left" and j.shift < last]

    @property
    def snaps(self) -> bool:
        """Whether the flange is so steep that the wheelset rests above its steep part at once."""
        risen = self.flange.roll[0] - self.tread.roll[-1] if self.flange is not None else 0.0
        return bool(risen > RISEN)

    def table(self, means: bool) -> ContactTable:
        """means: over all places of a tread on which the contact jumps."""
        wheelset, track = self.tread.wheelset, self.tread.track
        resting = float(np.interp(0.0, self.over, self.tread.lift))
        if means:
            points = self.tread.left_means(ELASTIC, float(STEEP))
        else:
            points = _with(self.tread.left, -1, self.jump.before if self.jump else None)
        tread, flange = _patch(self.tread, points, self.over, resting), None
        if self.flange is not None:
            met = self.jump.after if self.jump and not self.snaps else None
            points = _with(self.flange.left, 0, met)
            climbed = self.flange.shift - self.clearance
            flange = _patch(self.flange, points, climbed, resting)
        name = f"{wheelset.left.name} on {track.left.name}"
        return ContactTable(name, wheelset.nominal_radius, tread, flange)


def _spaced(begins: Begins, opposite: Begins, climb: float) -> tuple[Array, Array]:
    """Shifts of the tread's nodes, to where the opposite flange climbs, and climbs of the flange's
    [m]."""
    if begins is None or opposite is None:
        count = round(WITHOUT_FLANGE / NODE)
        return NODE * np.arange(-count, count + 1), np.zeros(0)
    clearance = begins[0]
    spacing = clearance / np.ceil(clearance / NODE)
    back, on = (round(float(length / spacing)) for length in (opposite[0] + climb, climb))
    over = spacing * np.arange(-back, round(float(clearance / spacing)) + 1)
    return over, spacing * np.arange(on + 1)


def flange_begins(wheelset: Wheelset, track: Track, yaw: float = 0.0) -> Begins:
    """Shift to the left [m] at which the left flange touches, and the jump of the contact there.

    Where the contact wanders up the flange there is no jump, and the flange begins at `STEEP`.
    None for a wheel without a flange. Raises ParameterError for one that does not touch.
    """
    _check_centred(contact_geometry(wheelset, track, [0.0], yaw))
    if not wheelset.left.flanged:
        return None
    for end in np.arange(0.01, FARTHEST, 0.005):
        found = contact_geometry(wheelset, track, np.arange(0.0, end, SEARCH), yaw)
        clearance = found.flange_contact("left", float(STEEP))
        if clearance is not None:
            at = [j for j in found.jumps if j.side == "left" and j.shift == clearance]
            return clearance, at[0] if at else None
    raise ParameterError(
        f"the flange of {wheelset.left.name} does not touch {track.left.name} within a shift of "
        f"{FARTHEST * 1e3:g} mm; check the tape spacing and the gauge"
    )


def _check_centred(geometry: ContactGeometry) -> None:
    """Raise ParameterError for a wheelset that stands on its flanges when it is centred."""
    wheel, rail = geometry.wheelset, geometry.track
    off_tread = np.abs(geometry.left.radius[0] - wheel.rolling_radius) > OFF_TREAD
    if abs(geometry.left.angle[0]) > STEEP or off_tread:
        raise ParameterError(
            f"{wheel.left.name} crosses {rail.left.name}: centred, it stands on its flanges, "
            f"{geometry.left.on_wheel[0] * 1e3:.4g} mm from the tape circle, at a contact angle of "
            f"{np.degrees(geometry.left.angle[0]):.3g} deg; check the tape spacing "
            f"({wheel.tape_spacing * 1e3:.5g} mm), the gauge ({rail.gauge * 1e3:.5g} mm) and where "
            "the tape circle is on the wheel"
        )


def _with(points: Points, row: int, contact: Points | None) -> Points:
    """The points with this contact, if any, in a row in which there are two."""
    if contact is None:
        return points
    columns = {f.name: np.array(getattr(points, f.name)) for f in fields(Points)}
    for name, column in columns.items():
        column[row] = getattr(contact, name)
    return Points(**columns)


def _patch(geometry: ContactGeometry, points: Points, over: Array, resting: float) -> Patch:
    """Columns of the left wheel with these contacts; resting: lift at shift 0 [m]."""
    return Patch(
        over=over,
        radius=points.radius,
        angle=points.angle,
        roll=geometry.roll,
        place=points.place,
        height=geometry.lift - resting + points.place * np.sin(geometry.roll),
        wheel_curvature=points.wheel_curvature,
        rail_curvature=points.rail_curvature,
    )
