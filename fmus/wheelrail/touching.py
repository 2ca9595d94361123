"""The equations of a wheelset on profiles, (25) to (31): where it touches and what acts there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..describe.block import Signals
from .block import LIFTED, SIDES, TINY_FORCE, floor_ratio, motion, relative, speed_of
from .columns import LINEAR, Columns
from .creep import LAWS, Contact
from .creep.kalker import kalker
from .loaded_contact import REDUCTIONS, cube_root, pressed
from .rolling import contacts_of

PATCHES = ("tread", "flange")
"""Of a wheel, in the order of their touches."""

STEEP = 1e-3
"""Least part of its normal force that a flange carries vertically, before friction locks it."""


@dataclass(frozen=True)
class Touch:
    """One contact of a wheel under its forces.

    side: 1 left, -1 right. at: columns. normal: force [N]. contact, grip: as `loaded_contact` has
    them.
    """

    side: int
    at: Signals
    normal: ca.SX
    contact: Contact
    grip: ca.SX

    @property
    def lateral(self) -> ca.SX:
        """The normal force's lateral component on the wheelset [N]."""
        return -self.side * self.normal * self.at["sine"]


@dataclass(frozen=True)
class Wheels:
    """A wheelset under one creep law, of inputs u, parameters p and derived constants d.

    columns: by side.
    """

    law: str
    columns: Mapping[str, Columns]
    u: Signals
    p: Signals
    d: Signals

    def clearance(self, side: str) -> float:
        """Shift at which a flange touches [m]."""
        return self.columns[side].table.clearance

    @property
    def yaw(self) -> ca.SX:
        """Against the way over the ground [rad]."""
        return self.u["yaw"] - self.u["path_yaw"]

    def shift(self, side: str) -> ca.SX:
        """Of a wheel towards its own rail, as far from flange contact as without yaw [m]."""
        shift = SIDES[side] * (self.u["y"] - self.u[f"rail_y_{side}"])
        if not self.columns[side].table.yawed:
            return shift
        return shift + self.columns[side].earlier(self.yaw)

    def overlap(self, side: str) -> ca.SX:
        """How far a wheel is shifted beyond flange contact [m]."""
        return ca.fmax(self.shift(side) - self.clearance(side), 0)

    def places(self) -> list[ca.SX]:
        """Shift of each tread, and climb of each flange if there is one [m]."""
        # (27): the rail moves with the flange
        shifts = [ca.fmin(self.shift(side), self.clearance(side)) for side in SIDES]
        return [*shifts, *(self.climb(side) for side in SIDES)]

    def climb(self, side: str) -> ca.SX:
        """What the rail cannot give way by under the force that lifts the tread [m], (29)."""
        if self.columns[side].table.flange is None:
            return ca.SX(0)
        at = self.columns[side].first("flange", self.yaw)
        lifting = self._lifting(side, at) * at["sine"]
        return ca.fmax(self.overlap(side) - lifting / ca.fmax(self.p["flange_stiffness"], 1), 0)

    def touches(self, at: Mapping[tuple[str, str], Signals]) -> list[Touch]:
        """All contacts under their normal forces; at: their columns, by side and patch."""
        return [touch for side in SIDES for touch in self._touches(side, at)]

    def rotation(self, touches: Sequence[Touch]) -> list[ca.SX]:
        """What the common creepage needs: contacts, their grips, the net force wanted [N]; and the
        contacts' normal forces [N]."""
        contacts = [ca.vertcat(*vars(touch.contact).values()) for touch in touches]
        grips, normals = zip(*((touch.grip, touch.normal) for touch in touches), strict=True)
        pull = self.u["torque"] / self.columns["left"].table.rolling_radius
        return [ca.horzcat(*contacts), ca.vertcat(*grips), pull, ca.vertcat(*normals)]

    def turning(
        self, at: Mapping[tuple[str, str], Signals], contacts: Any, grips: Any, normals: Any
    ) -> list[Touch]:
        """All contacts again, out of what `rotation` gives of them."""
        spots = [(side, patch) for side in SIDES for patch in PATCHES if (side, patch) in at]
        return [
            Touch(SIDES[side], at[side, patch], normals[i], contact, grips[i])
            for i, ((side, patch), contact) in enumerate(
                zip(spots, contacts_of(contacts), strict=True)
            )
        ]

    def outputs(self, touches: Sequence[Touch], common: ca.SX) -> Signals:
        """All outputs; common: the creepage of all contacts that their rotation leaves."""
        wheels = {
            side: self._wheel(side, [t for t in touches if t.side == sign], common)
            for side, sign in SIDES.items()
        }
        forces, moments, _ = zip(*wheels.values(), strict=True)
        return {
            "force_y": sum(forces),
            "moment_z": sum(moments),
            **{
                f"{s}.{name}": v for s, (_, _, found) in wheels.items() for name, v in found.items()
            },
            "y_rel": relative(self.u),
            "floor_ratio": floor_ratio(self.u, self.p),
            "yaw_rel": self.yaw,
        }

    def _lift(self, side: str, at: Mapping[str, Any]) -> ca.SX:
        """Friction up the flange over its normal force, as its lateral creepage asks, (28)."""
        if self.law == LINEAR:  # whose flange has no friction
            return ca.SX(0)
        creep = motion(self.u, self.p)[0] / at["cosine"]
        share = creep / ca.sqrt(creep**2 + self.d[f"sliding_{side}"] ** 2)
        return -SIDES[side] * self.p["friction_coefficient"] * share

    def _lifting(self, side: str, at: Mapping[str, Any]) -> ca.SX:
        """Normal force [N] of a flange that carries the wheel's load alone, (29)."""
        borne = at["cosine"] + self._lift(side, at) * at["sine"]
        return ca.fmax(self.u[f"load_{side}"], 0) / ca.fmax(borne, STEEP)

    def _touches(self, side: str, at: Mapping[tuple[str, str], Signals]) -> list[Touch]:
        """Tread, and flange if there is one, (30)."""
        tread, flange = at[side, "tread"], at.get((side, "flange"))
        load = ca.fmax(self.u[f"load_{side}"], 0)
        if flange is None:
            return [self._touch(side, tread, load / tread["cosine"])]
        damped = ca.fmax(1 + self.p["flange_damping"] * SIDES[side] * self.u["vy"], 0)
        pushed = self.p["flange_stiffness"] * self.overlap(side) * damped / flange["sine"]
        normal = ca.fmin(pushed, self._lifting(side, flange))
        carried = normal * (flange["cosine"] + self._lift(side, flange) * flange["sine"])
        return [
            self._touch(side, tread, (load - carried) / tread["cosine"]),
            self._touch(side, flange, normal, slips=self.law != LINEAR),
        ]

    def _touch(self, side: str, at: Signals, normal: ca.SX, slips: bool = True) -> Touch:
        """A contact under a normal force [N]; slips: whether it has creep forces."""
        creep_y, turning = motion(self.u, self.p)
        # (25)
        creepages = {
            "creep_x": -(at["widening"] + SIDES[side] * at["arm"] * turning),
            "creep_y": creep_y / at["cosine"],
            "spin": turning * at["cosine"] - SIDES[side] * at["camber"],
        }
        if self.law == LINEAR:
            return Touch(SIDES[side], at, normal, self._given(creepages, at), ca.SX(slips))
        force, grip = pressed(normal, self.p)
        return Touch(SIDES[side], at, normal, self._loaded(creepages, at, force), grip)

    def _loaded(self, creepages: Signals, at: Signals, force: ca.SX) -> Contact:
        """Hertz' ellipse and Kalker's coefficients under a normal force [N], (26)."""
        size = cube_root(force * self.d["compliance"])
        stiffness = self.p["shear_modulus"] * size**2
        return Contact(
            **creepages,
            speed=speed_of(self.u, self.p),
            a=size * at["a"],
            b=size * at["b"],
            f11=stiffness * at["g11"],
            f22=stiffness * at["g22"],
            f23=stiffness * size * at["g23"],
            f33=stiffness * size**2 * at["g33"],
            load=force,
            friction=self.p["friction_coefficient"],
            **{name: self.p[name] for name in REDUCTIONS},
            leverage=at["leverage"],
        )

    def _given(self, creepages: Signals, at: Signals) -> Contact:
        """A contact of the law `linear`: coefficients as they are given, no spin."""
        names = ("speed", "a", "b", "load", "friction", *REDUCTIONS)
        return Contact(
            **{**creepages, "spin": ca.SX(0)},
            f11=self.p["longitudinal_creep_coefficient"],
            f22=self.p["lateral_creep_coefficient"],
            f23=ca.SX(0),
            f33=ca.SX(0),
            **dict.fromkeys(names, ca.SX(1)),
            leverage=at["leverage"],
        )

    def _wheel(
        self, side: str, touches: Sequence[Touch], common: ca.SX
    ) -> tuple[Any, Any, dict[str, Any]]:
        """Lateral force and yaw moment of the contacts of one wheel, (31), and its outputs."""
        u, p, sign, tread, flange = self.u, self.p, SIDES[side], touches[0], touches[1:]
        yaw = self.yaw
        force_x: Any = 0
        force_y, moment_z, sizes, wear = force_x, force_x, force_x, force_x
        for touch in touches:
            contact, at = touch.contact.rolling(common), touch.at
            along, across, spin = (touch.grip * f for f in LAWS.get(self.law, kalker)(contact))
            force_x += along
            force_y += across * at["cosine"]
            wear += ca.fabs(along * contact.creep_x) + ca.fabs(across * contact.creep_y)  # (24)
            sizes += ca.sqrt(along**2 + across**2 + TINY_FORCE**2)
            moment_z += spin * at["cosine"] - sign * at["arm"] * along
            # yaw moves a contact forwards, and its normal force with it
            moment_z += p["gravity_yaw"] * sign * at["ahead"] * yaw * touch.lateral
        pushing = p["gravity_factor"] * tread.lateral + sum(touch.lateral for touch in flange)
        least = 0.5 * LIFTED * p["axle_load"]
        borne = ca.fmax(sum(touch.normal for touch in touches), least)
        outputs = {
            "force_x": force_x,
            "force_y": force_y,
            "creep_x": tread.contact.rolling(common).creep_x,
            "creep_y": tread.contact.creep_y,
            "l_over_v": -sign * (force_y + pushing) / ca.fmax(u[f"load_{side}"], least),
            "saturation": sizes / (p["friction_coefficient"] * borne),
            "wear_number": wear,
            "load_ratio": u[f"load_{side}"] / (0.5 * p["axle_load"]),
            "clearance": self.clearance(side) - self.shift(side),
            "normal_force": tread.normal,
            "flange_force": sum(touch.normal for touch in flange),
            "contact_angle": ca.if_else(
                self.overlap(side) > 0, touches[-1].at["angle"], tread.at["angle"]
            ),
            "climb": self.climb(side) if flange else 0,
        }
        return force_y + pushing, moment_z, outputs
