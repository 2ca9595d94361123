"""The contact geometry of one wheel on its rail as the table that a wheelset block holds."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ..errors import ParameterError
from ..wheelrail.contact_table import ContactTable, Patch
from .geometry import ContactGeometry, Jump, Track, Wheelset, contact_geometry
from .profile import Array

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
BLUR = 2.5e-4
"""Deviation [m] of the Gaussian that rounds off what jumps on the tread."""


def contact_table(wheelset: Wheelset, track: Track, climb: float = CLIMB) -> ContactTable:
    """The table of a wheelset and a track with both sides alike.

    The tread ends where the flange touches, which is then followed for `climb` [m]. Raises
    ParameterError for sides that differ, and for profiles without a flange that touches.
    """
    if not (wheelset.alike and track.alike):
        raise ParameterError(
            "a table holds a wheel and a rail that are alike on both sides; give one wheel, one "
            "rail and one inclination"
        )
    found = flange_begins(wheelset, track)
    if found is None:
        return _flangeless(wheelset, track)
    clearance, jump = found
    spacing = clearance / np.ceil(clearance / NODE)
    back, on = (round(float(length / spacing)) for length in (clearance + climb, climb))
    over = spacing * np.arange(-back, round(float(clearance / spacing)) + 1)
    tread = contact_geometry(wheelset, track, over)
    flange = contact_geometry(wheelset, track, clearance + spacing * np.arange(on + 1))
    rounded = [j for j in tread.jumps if j.side == "left" and j.shift < clearance - spacing]
    resting = float(np.interp(0.0, over, tread.lift))
    parts = (
        _patch(tread, over, resting, jump.before if jump else None, -1),
        _patch(flange, flange.shift - clearance, resting, jump.after if jump else None, 0),
    )
    said = [*wheelset.left.said, *track.left.said]
    if rounded:
        parts = (_blurred(parts[0], spacing), parts[1])
        places = ", ".join(f"{j.shift * 1e3:.3g}" for j in rounded)
        said.append(
            f"the contact jumps on the tread at shifts of {places} mm: rounded off there over "
            f"{BLUR * 1e3:g} mm"
        )
    return ContactTable(_name(wheelset, track), wheelset.rolling_radius, *parts, tuple(said))


def _flangeless(wheelset: Wheelset, track: Track) -> ContactTable:
    """The tread alone, to `WITHOUT_FLANGE` on both sides."""
    count = round(WITHOUT_FLANGE / NODE)
    over = NODE * np.arange(-count, count + 1)
    tread = contact_geometry(wheelset, track, over)
    patch = _patch(tread, over, float(tread.lift[count]), None, 0)
    said = (*wheelset.left.said, *track.left.said, "the wheel has no flange")
    return ContactTable(_name(wheelset, track), wheelset.rolling_radius, patch, None, said)


def _name(wheelset: Wheelset, track: Track) -> str:
    return f"{wheelset.left.name} on {track.left.name}"


def flange_begins(
    wheelset: Wheelset, track: Track, yaw: float = 0.0
) -> tuple[float, Jump | None] | None:
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


def _patch(
    geometry: ContactGeometry, over: Array, resting: float, contact: object, row: int
) -> Patch:
    """Columns of the left wheel; contact: what the contact is in a row that has two, else None."""
    points = geometry.left
    names = ("radius", "angle", "place", "wheel_curvature", "rail_curvature")
    columns = {name: np.array(getattr(points, name)) for name in names}
    if contact is not None:
        for name, column in columns.items():
            column[row] = getattr(contact, name)
    lifted = geometry.lift - resting + columns["place"] * np.sin(geometry.roll)
    return Patch(over=over, roll=geometry.roll, height=lifted, **columns)


def _blurred(patch: Patch, spacing: float) -> Patch:
    """Radius, angle, place and curvatures rounded off."""
    columns = patch.columns()
    for name in ("radius", "angle", "place", "wheel_curvature", "rail_curvature"):
        columns[name] = gaussian_filter1d(columns[name], BLUR / spacing, mode="nearest")
    return Patch(**columns)
