"""The wheelrail block on real profiles: the same ports, contact geometry from a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca

from ..describe.block import Signals
from ..describe.ranges import read_range
from ..describe.variables import Constant, Limit, Output
from .block import SIDES, WheelRail
from .columns import LINEAR, Columns
from .contact_table import ContactTable
from .creep import LAWS
from .rolling import Rotation, common_creepage, in_proportion
from .spots import Spots
from .touching import Wheels

FROM_TABLE = (
    "half_contact_spacing",
    "rolling_radius",
    "conicity",
    "flange_clearance",
    "poisson_ratio",
    "rail_transverse_radius",
    "wheel_transverse_curvature",
)
"""Parameters of the coned wheelset that a table of contact geometry takes the place of."""

_PER_WHEEL = {
    "normal_force": ("N", "Normal force at the tread of the {} wheel", 1e5),
    "flange_force": ("N", "Normal force at the flange of the {} wheel", 1e5),
    "contact_angle": ("rad", "Angle of the {} wheel's steepest contact to the track plane", 0.1),
    "climb": ("m", "Shift of the {} wheel beyond flange contact, up the flange", 1e-3),
}


RANGE = Path(__file__).with_name("range_profiled.toml")
FLANGED, FLANGELESS = ("off_the_flange", "flange"), ("off_the_tread",)
"""Limits in it that are for wheels with flanges alone, and without."""


class ProfiledWheelRail(WheelRail):
    """One wheelset on profiles. Equation numbers: README.md of this folder.

    geometry: of the contacts. poisson_ratio: of wheel and rail. name: of the block, letters, digits
    and _. small_angles: as of `Columns`.
    """

    home = "wheelrail"
    stands_for = "wheelrail"
    parameters = tuple(p for p in WheelRail.parameters if p.name not in FROM_TABLE)
    outputs = (
        *WheelRail.outputs,
        *(
            Output(f"{side}.{name}", unit, text.format(side), nominal=nominal)
            for side in SIDES
            for name, (unit, text, nominal) in _PER_WHEEL.items()
        ),
        Output(
            "yaw_rel", "rad", "Yaw of the wheelset against the way over the ground", nominal=1e-2
        ),
    )
    constants = (
        Constant("rolling_radius", "m", "Nominal rolling radius of the table"),
        Constant("half_contact_spacing", "m", "Half distance of the contacts when centred"),
        Constant("flange_clearance", "m", "Least shift at which a flange touches"),
        Constant("flange_angle", "rad", "Steepest contact angle of the less steep side"),
        Constant("nadal_limit", "1", "Nadal's limit of l_over_v at that angle and the friction"),
    )

    def __init__(
        self,
        geometry: ContactTable,
        poisson_ratio: float,
        name: str = "wheelrail",
        small_angles: bool = False,
    ) -> None:
        self.geometry, self.name, self.poisson_ratio = geometry, name, poisson_ratio
        sides = [Columns(own, poisson_ratio, small_angles) for own in geometry.different]
        self.columns = {"left": sides[0], "right": sides[-1]}
        self._seldom: dict[tuple[bool, tuple[str, ...]], Spots] = {}
        self.limits = _limits(geometry, sides)
        self.description = f"Wheelset on two rails, profiles {geometry.name!r}: creep, flange"

    def constant(self, p: Signals, d: Signals) -> Signals:
        slope, mu = ca.tan(self.geometry.flange_angle), p["friction_coefficient"]
        return {
            "rolling_radius": ca.SX(self.geometry.rolling_radius),
            "half_contact_spacing": ca.SX(self.geometry.half_spacing),
            "flange_clearance": ca.SX(self.geometry.clearance),
            "flange_angle": ca.SX(self.geometry.flange_angle),
            "nadal_limit": (slope - mu) / (1 + mu * slope),  # Nadal (1896)
        }

    def derived(self, p: Signals) -> Signals:
        """Compliance [1/Pa], and the lateral creepages [1] that ask for a flange's friction."""
        compliance = (1 - self.poisson_ratio) / p["shear_modulus"]
        derived, load = {"compliance": compliance}, 0.5 * p["axle_load"]
        for side, columns in self.columns.items():
            g22 = columns.first("flange")["g22"] if "flange" in columns.patches else 1.0
            stiffness = p["shear_modulus"] * g22 * (load * compliance) ** (2 / 3)
            derived[f"sliding_{side}"] = p["friction_coefficient"] * load / stiffness
        return derived

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """(21)"""
        wheels = self._wheels(LINEAR, u, p, d)
        left = {side: wheels.clearance(side) - wheels.shift(side) for side in SIDES}
        return {
            f"{side}.clearance": ca.if_else(p["flange_stiffness"] > 0, clearance, 1)
            for side, clearance in left.items()
        }

    def _branch(
        self,
        law_name: str,
        rotation: Rotation,
        options: dict[str, Any] | None = None,
        *,
        name: str | None = None,
        outputs: Sequence[str] | None = None,
    ) -> ca.Function:
        """As of the coned wheelset; flanges cost nothing while neither touches its rail."""
        wanted = [*(outputs or (v.name for v in self.outputs))]
        x, lookup = ca.MX(0, 1), ca.MX(0, 0)
        every = self._touching(law_name, rotation, tuple(self.geometry.patches()), wanted)
        u, p, d = every.mx_in()
        if self.geometry.flange is None or (outputs is None and rotation is not common_creepage):
            # what is asked for seldom, or for what depends on what: a choice would hide that
            found = every(u, p, d)
        else:
            treads = self._touching(law_name, rotation, ("tread",), wanted)
            touching = self._of_signals("overlap", ca.SX, self._largest_overlap)(u, p, d)
            found = ca.Function.if_else("by_flange", every, treads)(touching > 0, u, p, d)
        return ca.Function(name or law_name, [x, u, p, d, lookup], [found], options or {})

    def _largest_overlap(self, *at: Signals) -> list[ca.SX]:
        wheels = self._wheels(LINEAR, *at)
        return [ca.fmax(*(wheels.overlap(side) for side in SIDES))]

    def _wheels(self, law: str, u: Signals, p: Signals, d: Signals) -> Wheels:
        return Wheels(law, self.columns, u, p, d)

    def _touching(
        self, law: str, rotation: Rotation, patches: tuple[str, ...], wanted: Sequence[str]
    ) -> ca.Function:
        """(u, p, d) -> outputs of a wheelset that touches with these patches of both wheels."""
        kind: Any = ca.MX if law == "fastsim" else ca.SX  # the grid stays a loop in C
        spots = self._spots(law, patches, often=rotation is common_creepage)

        def forces(u: Any, p: Any, d: Any, columns: Any, *touching: Any) -> list[Any]:
            each, grips, normals, common = touching
            wheels = self._wheels(law, u, p, d)
            touches = wheels.turning(spots.named(columns), each, grips, normals)
            found = wheels.outputs(touches, common)
            return [ca.vertcat(*(found[name] for name in wanted))]

        def linear(u: Any, p: Any, d: Any, *rows: Any) -> list[Any]:
            wheels, (columns,) = self._wheels(law, u, p, d), spots.looked_up(u, p, d, *rows)
            each, grips, pull, normals = wheels.rotation(wheels.touches(spots.named(columns)))
            common = in_proportion(each, grips, pull)
            return forces(u, p, d, columns, each, grips, normals, common)

        u, p = (ca.MX.sym(n, len(v)) for n, v in (("u", self.inputs), ("p", self.parameters)))
        d = ca.MX.sym("d", len(self.derived_shapes))
        if law == LINEAR:  # without a root to find one expression costs least
            parts, rows = spots.rows(u, p, d)
            one = self._of_signals("forces", kind, linear, **spots.shapes)
            result = one(u, p, d, parts, *rows)
        else:
            columns, each, grips, pull, normals = spots.met(u, p, d)
            common = rotation(LAWS[law], kind, len(spots.spots))(each, grips, pull)
            found = {"columns": columns, "contacts": each, "grips": grips, "normals": normals}
            found["common"] = common
            shapes = {name: value.shape for name, value in found.items()}
            result = self._of_signals("forces", kind, forces, **shapes)(u, p, d, *found.values())
        return ca.Function(
            f"{'_'.join(patches)}_{law}",
            [u, p, d],
            [result],
            {"is_diff_in": [True, False, False]},  # none asks for derivatives by parameters
        )

    def _spots(self, law: str, patches: tuple[str, ...], often: bool) -> Spots:
        """Where the patches touch, once for all that is asked for seldom: less to compile.

        What is asked for often has its own, which a compiler makes part of it: that is faster.
        """
        if often:
            return Spots(self._of_signals, self.columns, law, patches)
        key = (law == LINEAR, patches)
        if key not in self._seldom:
            self._seldom[key] = Spots(self._of_signals, self.columns, law, patches)
        return self._seldom[key]


def _limits(table: ContactTable, sides: Sequence[Columns]) -> tuple[Limit, ...]:
    """What the laws hold for; flange and yaw as far as the table has them."""
    ends: dict[str, dict[str, Any]] = {}
    others: tuple[str, ...] = FLANGELESS
    if table.flange is None:
        others = FLANGED
    else:
        climbs = (float(columns.patches["flange"].over[-1]) for columns in sides)
        ends["off_the_flange"] = {"largest": min(climbs)}
    if table.yawed:
        last = max(table.yawed)
        ends["yaw"] = {"least": -last, "largest": last}
    found = read_range(RANGE, ProfiledWheelRail.outputs) or ()
    return tuple(
        replace(limit, **ends.get(limit.name, {})) for limit in found if limit.name not in others
    )
