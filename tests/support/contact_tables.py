"""Tables of contact geometry in closed form: cones with a flange, circles on circles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import root

from fmus.wheelrail.contact_table import ContactTable, Patch

RADIUS, SPACING = 0.4191, 0.75565
CLEARANCE = 0.008


def nodes(first: float, last: float, step: float = 1e-4) -> np.ndarray:
    return np.linspace(first, last, round((last - first) / step) + 1)


def cone(
    taper: float = 0.05,
    flange: float | None = np.radians(70.0),
    wheel_curvature: float = 0.0,
    rail_curvature: float = 1 / 0.254,
) -> ContactTable:
    """A cone on knife edges to first order in its taper, and a conical flange from 8 mm on.

    flange: its angle [rad]; the last 2 mm of a climb of 6 mm its tip is round, down to 20 deg.
    """
    shift = nodes(-0.02, CLEARANCE)
    one = np.ones_like(shift)
    tread = Patch(
        over=shift,
        radius=RADIUS + taper * shift,
        angle=np.arctan(taper * (1 + shift / SPACING)),
        roll=np.arctan(taper * (1 + shift / SPACING)) - np.arctan(taper),
        place=SPACING - shift,
        height=taper * shift,
        wheel_curvature=wheel_curvature * one,
        rail_curvature=rail_curvature * one,
    )
    if flange is None:
        return ContactTable("cone", RADIUS, tread)
    climb = nodes(0.0, 6e-3)
    round_off = np.clip((climb - 4e-3) / 2e-3, 0, 1)
    angle = flange + (np.radians(20.0) - flange) * round_off**2 * (3 - 2 * round_off)
    steep = Patch(
        over=climb,
        radius=RADIUS + 0.012 + 0 * climb,
        angle=angle,
        roll=np.tan(flange) * climb / (2 * SPACING),
        place=SPACING - 0.035 + 0 * climb,
        height=np.tan(flange) * climb,
        wheel_curvature=0 * climb,
        rail_curvature=1 / 0.013 + 0 * climb,
    )
    return ContactTable("cone", RADIUS, tread, steep)


def cone_at(yaw: float) -> ContactTable:
    """The cone with a flange at a yaw [rad], after which its columns go as its square does."""
    square, straight = yaw**2, cone()
    nearer = {"tread": 0.24 * square, "flange": 0.0}
    patches = {
        name: replace(
            patch,
            over=patch.over - nearer[name],
            radius=patch.radius + 0.3 * square,
            angle=np.arcsin(np.sin(patch.angle) * (1 - 20 * square)),
            place=patch.place - 0.7 * square,
        )
        for name, patch in straight.patches().items()
    }
    return ContactTable("cone", RADIUS, **patches)


def circles(wheel_radius: float, rail_radius: float, angle: float) -> ContactTable:
    """Hollow circular wheels on round rails, exactly: centres of circles that touch stay as far
    apart as their radii differ. Radii [m]; angle of contact of the centred wheelset [rad]."""
    normal = np.array([-np.sin(angle), np.cos(angle)])
    first = np.array([SPACING, 0.0])
    rail, hollow = first - rail_radius * normal, first - wheel_radius * normal
    axle, apart = np.array([0.0, RADIUS]), wheel_radius - rail_radius
    shift = nodes(-4e-3, 4e-3, 2e-4)
    rows = []
    for y in shift:

        def centre(sign, lift, roll, y=y):
            turned = _turned(np.array([sign, 1]) * (hollow - axle), roll)
            return axle + np.array([y, lift]) + turned

        def misses(q, centre=centre):
            ends = (np.array([sign, 1]) * rail - centre(sign, *q) for sign in (1, -1))
            return [np.hypot(*end) - apart for end in ends]

        lift, roll = root(misses, [0.0, 0.0], tol=1e-13).x
        up = (rail - centre(1, lift, roll)) / apart
        on_wheel = _turned(rail + rail_radius * up - axle - np.array([y, lift]), -roll)
        tilt = np.arctan2(-up[0], up[1])
        rows.append([-on_wheel[1], tilt, roll, on_wheel[0], lift + SPACING * roll])
    one = np.ones_like(shift)
    curvatures = {"wheel_curvature": -one / wheel_radius, "rail_curvature": one / rail_radius}
    columns = ("radius", "angle", "roll", "place", "height")
    found = dict(zip(columns, np.array(rows).T, strict=True))
    return ContactTable("circles", RADIUS, Patch(over=shift, **found, **curvatures))


def _turned(point: np.ndarray, roll: float) -> np.ndarray:
    c, s = np.cos(roll), np.sin(roll)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])
