"""Results of a co-simulated hopper car in the order of the monolithic car."""

from __future__ import annotations

import numpy as np
import xarray as xr

from reference.car_data import Array, CarData

WHEELSETS = ("wheelset_11", "wheelset_12", "wheelset_21", "wheelset_22")
ENDS = ("front", "rear")
AXLES = tuple((end, axle) for end in ENDS for axle in (1, 2))


def columns(results: xr.Dataset, *names: str) -> Array:
    """The named variables side by side (n, names)."""
    return np.stack([results[name].to_numpy() for name in names], axis=1)


def rails(results: xr.Dataset) -> Array:
    """Rail displacement under the axles (n, 16) [m]: lateral left, right, vertical left, right."""
    places = ("rail_y_left", "rail_y_right", "rail_z_left", "rail_z_right")
    names = [f"track.axle[{axle}].{place}" for axle in range(1, 5) for place in places]
    return columns(results, *names)


def rail_accelerations(results: xr.Dataset) -> Array:
    """Vertical accelerations of the rails, left and right under each axle (n, 8) [m/s2]."""
    sides = ("left", "right")
    names = [f"track.axle[{axle}].rail_az_{side}" for axle in range(1, 5) for side in sides]
    return columns(results, *names)


def axle_lateral(results: xr.Dataset) -> Array:
    """Lateral motion of the wheelsets (n, 4) [m]."""
    return columns(results, *(f"truck_{end}.axle[{axle}].y" for end, axle in AXLES))


def wheel_load(results: xr.Dataset) -> Array:
    """Wheel loads, left and right of each axle (n, 8) [N]."""
    sides = ("left", "right")
    names = [f"truck_{end}.axle[{axle}].load_{side}" for end, axle in AXLES for side in sides]
    return columns(results, *names)


def wheel_force(results: xr.Dataset) -> tuple[Array, Array]:
    """Lateral force [N] and yaw moment [N.m] of the rails on the wheelsets, (n, 4) each."""
    force = columns(results, *(f"{wheelset}.force_y" for wheelset in WHEELSETS))
    moment = columns(results, *(f"{wheelset}.moment_z" for wheelset in WHEELSETS))
    return force, moment


def truck_forces(results: xr.Dataset, kind: str) -> Array:
    """`spring` or `friction` forces of the truck elements (n, 12), front 1..6, rear 1..6."""
    return columns(results, *(f"truck_{end}.{kind}[{i}]" for end in ENDS for i in range(1, 7)))


def state(results: xr.Dataset, data: CarData) -> Array:
    """State (n, 40) of the monolithic car: p and p'."""
    inertia = [data.body_mass, data.body_mass]
    inertia += [data.roll_inertia, data.yaw_inertia, data.pitch_inertia, 1.0, 1.0, 1.0]
    halves = []
    for q in ("q", "qd"):
        modal = columns(results, *(f"carbody.{q}[{i}]" for i in range(1, 9)))
        trucks = columns(results, *(f"truck_{e}.{q}[{i}]" for e in ENDS for i in range(1, 7)))
        halves.append(np.hstack([modal / np.sqrt(inertia), trucks]))
    return np.hstack(halves)
