"""The wheelrail block: creep, gravity and flange forces of one wheelset; it has no states."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import casadi as ca

from ..describe.block import Block, Signals
from ..describe.terminals import RAILS, WHEELSET, Terminal
from ..describe.variables import Input, Output, Parameter, choice
from .creep import LAWS, Law
from .loaded_contact import loaded_contact, static_contact
from .rolling import (
    FIELDS,
    Rotation,
    at_rest,
    common_creepage,
    contacts_of,
    differentiable,
)

SIDES = {"left": 1, "right": -1}
"""Sides of the wheelset, with the sign of their y."""

CREEP_LAWS = ("linear", *LAWS)
"""In the order of the enumeration, from 1."""

LIFTED = 0.01
"""Part of the static wheel load below which a wheel counts as lifted in l_over_v."""

TINY_FORCE = 1e-3
"""Force [N] that keeps the derivative of a resultant finite where the resultant vanishes."""

_MOTION = {
    "y": ("m", "Lateral displacement of the wheelset"),
    "yaw": ("rad", "Yaw of the wheelset"),
    "vy": ("m/s", "Lateral velocity of the wheelset"),
    "wz": ("rad/s", "Yaw rate of the wheelset"),
}

_PER_WHEEL = {
    "force_x": ("N", "Longitudinal creep force on the {} wheel", 1e4),
    "force_y": ("N", "Lateral creep force on the {} wheel", 1e4),
    "creep_x": ("1", "Longitudinal creepage of the {} wheel", 1e-3),
    "creep_y": ("1", "Lateral creepage of the {} wheel", 1e-3),
    "l_over_v": ("1", "Outward force of the {} wheel on its rail over its load", 0.1),
    "saturation": ("1", "Creep force of the {} wheel over its friction limit", 0.1),
    "wear_number": ("N", "T gamma of the {} wheel: what its creep forces lose, per metre", 10.0),
}

_PATH = {
    "path_yaw": ("rad", "Yaw of the way that the car's frame takes over the ground here"),
    "path_curvature": ("1/m", "Curvature of that way, positive to the left"),
}
"""Zero on straight track."""


def _positive(name: str, unit: str, text: str, symbol: str, tunable: bool = False) -> Parameter:
    return Parameter(name, unit, text, symbol=symbol, minimum=1e-3, tunable=tunable)


def _from_zero(name: str, unit: str, text: str, symbol: str) -> Parameter:
    return Parameter(name, unit, text, symbol=symbol, minimum=0.0, tunable=True)


class WheelRail(Block):
    """One wheelset. Equation numbers: README.md of this folder."""

    name = "wheelrail"
    description = "Wheelset on two rails: creep, gravity, flange contact"
    parameters: Sequence[Parameter] = (
        choice("creep_law", "Law of the creep forces", CREEP_LAWS),
        _positive("half_contact_spacing", "m", "Half distance of the contact points", "L_Y"),
        _positive("rolling_radius", "m", "Nominal rolling radius", "r_0"),
        Parameter("conicity", "1", "Wheel taper", symbol="alpha", minimum=0.0, tunable=True),
        _positive("axle_load", "N", "Static weight on the rails of one axle", "W_axle"),
        _from_zero("longitudinal_creep_coefficient", "N", "Longitudinal creep coefficient", "f_11"),
        _from_zero("lateral_creep_coefficient", "N", "Lateral creep coefficient", "f_22"),
        _positive("friction_coefficient", "1", "Friction coefficient", "mu", tunable=True),
        _from_zero("gravity_factor", "1", "Factor on the gravity restoring force", "f_n"),
        Parameter(
            "gravity_yaw",
            "1",
            "Whether gravity also gives a (destabilising) yaw moment",
            kind="boolean",
            default=0.0,
            tunable=True,
        ),
        _from_zero("flange_clearance", "m", "Lateral clearance of a flange", "c"),
        _from_zero("flange_stiffness", "N/m", "Lateral stiffness of a rail", "k_fl"),
        _from_zero("flange_damping", "s/m", "Damping over elastic force, per velocity", "lambda"),
        _positive("speed_floor", "m/s", "Smallest speed of the creepages", "V_min"),
        _positive("shear_modulus", "Pa", "Shear modulus of wheel and rail", "G"),
        Parameter(
            "poisson_ratio",
            "1",
            "Poisson's ratio of wheel and rail",
            symbol="nu",
            minimum=0.0,
            maximum=0.5,
        ),
        _positive("rail_transverse_radius", "m", "Radius of the rail's crown", "R_r"),
        Parameter(
            "wheel_transverse_curvature",
            "1/m",
            "Curvature of the wheel's tread across it; below zero where hollow",
            symbol="kappa_w",
        ),
        _from_zero(
            "creep_reduction", "1", "Factor on Kalker's creep coefficients (not polach)", "k"
        ),
        _from_zero("adhesion_reduction", "1", "Factor in the area of adhesion (polach)", "k_A"),
        _from_zero("slip_reduction", "1", "Factor in the area of slip (polach)", "k_S"),
        Parameter(
            "friction_ratio",
            "1",
            "Friction coefficient at fast over slow slip (polach)",
            symbol="A",
            minimum=0.0,
            maximum=1.0,
            tunable=True,
        ),
        _from_zero("friction_decay", "s/m", "Decay of the friction with the slip (polach)", "B"),
    )
    inputs = (
        *(Input(name, unit, text) for name, (unit, text) in _MOTION.items()),
        Input("speed", "m/s", "Forward speed", start=18.288),
        *(Input(f"load_{s}", "N", f"Vertical load on the {s} wheel", start=1.2e5) for s in SIDES),
        *(Input(f"rail_y_{s}", "m", f"Lateral displacement of the {s} rail") for s in SIDES),
        Input(
            "torque", "N.m", "Driving torque on the wheelset; below zero it brakes", optional=True
        ),
        *(Input(name, unit, text, optional=True) for name, (unit, text) in _PATH.items()),
    )
    outputs = (
        Output("force_y", "N", "Lateral force on the wheelset", nominal=1e4),
        Output("moment_z", "N.m", "Yaw moment on the wheelset", nominal=1e4),
        *(
            Output(f"{side}.{name}", unit, text.format(side), nominal=nominal)
            for side in SIDES
            for name, (unit, text, nominal) in _PER_WHEEL.items()
        ),
        Output("y_rel", "m", "Wheelset relative to the mean of the two rails", nominal=1e-2),
        Output("floor_ratio", "1", "Speed floor of the creepages over the speed", nominal=1.0),
        *(
            Output(f"{side}.load_ratio", "1", f"Load on the {side} wheel over its static load")
            for side in SIDES
        ),
        *(
            Output(
                f"{side}.clearance", "m", f"Clearance of the {side} flange; below zero it touches"
            )
            for side in SIDES
        ),
    )

    terminals = (
        Terminal("wheelset", WHEELSET, "Truck on the wheelset", (0, 34)),
        Terminal("rails", RAILS, "Rails under the wheelset", (0, -78)),
    )

    switch = "creep_law"
    led = ("force_y", "moment_z")

    def derived(self, p: Signals) -> Signals:
        return static_contact(p)

    def output_branches(self) -> list[ca.Function]:
        """Each law near straight running with equal loads, where the common creepage is linear."""
        return [self._branch(name, at_rest) for name in CREEP_LAWS]

    def output_function(self) -> ca.Function:
        return self._by_law("outputs", common_creepage)

    def output_slope(self) -> ca.Function:
        return self._by_law("outputs_slope", differentiable)

    def output_laws(self) -> list[ca.Function]:
        return [self._branch(law, common_creepage, name=f"outputs_{law}") for law in CREEP_LAWS]

    def led_laws(self) -> list[ca.Function]:
        return [
            self._branch(law, differentiable, name=f"led_{law}", outputs=self.led)
            for law in CREEP_LAWS
        ]

    def _by_law(self, name: str, rotation: Rotation) -> ca.Function:
        """One branch for each creep law, so that a law costs nothing where it is not chosen."""
        # Only derivatives by inputs are ever asked for: that keeps the derivative's code small.
        only_inputs = {"is_diff_in": [False, True, False, False, False]}
        branches = [self._branch(law, rotation, only_inputs) for law in CREEP_LAWS]
        linear, *others = branches
        chosen = ca.Function.conditional("by_law", others, linear)
        x, u, p, d, lookup = linear.mx_in()
        law = p[[parameter.name for parameter in self.parameters].index(self.switch)]
        y = chosen(law - 2, x, u, p, d, lookup)  # any other number: the last, linear
        return ca.Function(name, [x, u, p, d, lookup], [y])

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """(21): each flange touches its rail, or leaves it; no event without rail stiffness."""
        return {
            f"{side}.clearance": ca.if_else(
                p["flange_stiffness"] > 0, -_overlap(sign, u["y"] - u[f"rail_y_{side}"], p), 1
            )
            for side, sign in SIDES.items()
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
        """Outputs under one creep law, with the wheelset's rotation found in this way.

        outputs: names of some; None for all. name: of the function, else the law's.
        """
        law = LAWS.get(law_name)
        kind: Any = ca.MX if law_name == "fastsim" else ca.SX  # the grid stays a loop in C

        def wanted(*at: Any) -> list[Any]:
            found = self._outputs(law, *at)
            return [ca.vertcat(*(found[n] for n in outputs or (v.name for v in self.outputs)))]

        # The search's contacts are those of the forces: each has its cube root once.
        shapes = {"contacts": (FIELDS, len(SIDES)), "grips": (len(SIDES), 1)} if law else {}
        forces = self._of_signals("forces", kind, wanted, common=(1, 1), **shapes)
        # Without a root to find all is one expression, which costs least.
        outer: Any = ca.MX if law else ca.SX
        x, lookup = outer(0, 1), outer(0, 0)
        u, p = (outer.sym(n, len(v)) for n, v in (("u", self.inputs), ("p", self.parameters)))
        d, turned = outer.sym("d", len(self.derived_shapes)), [outer(0)]
        if law:
            wheels = self._of_signals("wheels", ca.SX, _wheels)(u, p, d)
            turned = [rotation(law, kind, len(SIDES))(*wheels), *wheels[:2]]
        return ca.Function(
            name or law_name, [x, u, p, d, lookup], [forces(u, p, d, *turned)], options or {}
        )

    def _of_signals(
        self, name: str, kind: Any, function: Callable[..., Any], **more: tuple[int, int]
    ) -> Any:
        """CasADi function of u, p, d and more symbols of a shape, out of one of their signals."""
        u, p = (kind.sym(n, len(v)) for n, v in (("u", self.inputs), ("p", self.parameters)))
        d, further = (
            kind.sym("d", len(self.derived_shapes)),
            [kind.sym(n, *s) for n, s in more.items()],
        )
        found = function(
            by_name((port.name for port in self.inputs), u),
            by_name((parameter.name for parameter in self.parameters), p),
            by_name(self.derived_shapes, d),
            *further,
        )
        return ca.Function(name, [u, p, d, *further], found)

    def _outputs(
        self, law: Law | None, u: Signals, p: Signals, d: Signals, common: ca.SX, *loaded: Any
    ) -> Signals:
        """All outputs; common: the creepage of both wheels that their rotation leaves.

        loaded: contacts and grips, as of `_wheels`, for a creep law.
        """
        half_spacing = p["half_contact_spacing"]
        y_rel, creepages = _creepages(u, p)
        if not law:  # (22) in closed form
            common = -u["torque"] / (
                2 * p["rolling_radius"] * ca.fmax(p["longitudinal_creep_coefficient"], 1e-30)
            )
        # report (5-16), (5-17), errata 2, 15: gravity restores with the weight itself
        gravity = -p["gravity_factor"] * p["axle_load"] * p["conicity"] / half_spacing * y_rel
        force_y = gravity
        moment_z = p["gravity_yaw"] * p["axle_load"] * half_spacing * p["conicity"] * u["yaw"]
        y: dict[str, ca.SX] = {}
        for i, (side, sign) in enumerate(SIDES.items()):
            off_rail = u["y"] - u[f"rail_y_{side}"]
            creep_x, creep_y, _ = creepages[side]
            creep_x += common
            if law:
                contacts, grips = loaded
                contact = contacts_of(contacts)[i].rolling(common)
                force_x, creep_force_y, spin_moment = (grips[i] * force for force in law(contact))
                moment_z += spin_moment
            else:
                force_x = -p["longitudinal_creep_coefficient"] * creep_x
                creep_force_y = -p["lateral_creep_coefficient"] * creep_y
            flange = self._flange(sign, off_rail, u, p)
            force_y += creep_force_y + flange
            moment_z -= sign * half_spacing * force_x
            outward = -sign * (creep_force_y + flange + 0.5 * gravity)  # of the wheel on the rail
            load = ca.fmax(u[f"load_{side}"], 0.5 * LIFTED * p["axle_load"])
            resultant = ca.sqrt(force_x**2 + creep_force_y**2 + TINY_FORCE**2)
            y |= {
                f"{side}.force_x": force_x,
                f"{side}.force_y": creep_force_y,
                f"{side}.creep_x": creep_x,
                f"{side}.creep_y": creep_y,
                f"{side}.l_over_v": outward / load,
                f"{side}.saturation": resultant / (p["friction_coefficient"] * load),
                f"{side}.wear_number": ca.fabs(force_x * creep_x)
                + ca.fabs(creep_force_y * creep_y),  # (24)
                f"{side}.load_ratio": u[f"load_{side}"] / (0.5 * p["axle_load"]),
                f"{side}.clearance": -_overlap(sign, off_rail, p),
            }
        return {
            "force_y": force_y,
            "moment_z": moment_z,
            **y,
            "y_rel": y_rel,
            "floor_ratio": floor_ratio(u, p),
        }

    def _flange(self, sign: int, off_rail: ca.SX, u: Signals, p: Signals) -> ca.SX:
        """Force of one rail on the flange, (6): elastic, damped in proportion, never pulling."""
        overlap = ca.fmax(_overlap(sign, off_rail, p), 0)
        damped = ca.fmax(1 + p["flange_damping"] * sign * u["vy"], 0)
        return -sign * p["flange_stiffness"] * overlap * damped


def speed_of(u: Signals, p: Signals) -> ca.SX:
    """The speed of the creepages [m/s]."""
    return ca.fmax(u["speed"], p["speed_floor"])


def floor_ratio(u: Signals, p: Signals) -> ca.SX:
    """Speed floor of the creepages over the speed [1]."""
    return p["speed_floor"] / ca.fmax(u["speed"], 1e-3 * p["speed_floor"])


def motion(u: Signals, p: Signals) -> tuple[ca.SX, ca.SX]:
    """Lateral creepage [1] and turning [1/m] of a wheelset over the ground, (2), (23)."""
    speed = speed_of(u, p)
    creep_y = u["vy"] / speed - u["yaw"] + u["path_yaw"]  # report (5-11), erratum 1
    return creep_y, u["wz"] / speed + u["path_curvature"]


def relative(u: Signals) -> ca.SX:
    """Lateral displacement of the wheelset relative to the mean of the two rails [m]."""
    return u["y"] - 0.5 * (u["rail_y_left"] + u["rail_y_right"])


def _creepages(u: Signals, p: Signals) -> tuple[ca.SX, dict[str, tuple[ca.SX, ca.SX, ca.SX]]]:
    """y_rel [m], and creepages x, y [1] and spin [1/m] of each wheel, (1), (2), (9).

    The longitudinal ones are those of a wheelset that turns at V/r_0.
    """
    half_spacing, y_rel = p["half_contact_spacing"], relative(u)
    creep_y, turning = motion(u, p)
    found = {}
    for side, sign in SIDES.items():
        # report (5-7), (5-13), errata 3, 6: opposite signs left and right
        creep_x = -sign * (p["conicity"] * y_rel / p["rolling_radius"] + half_spacing * turning)
        spin = turning - sign * p["conicity"] / p["rolling_radius"]
        found[side] = creep_x, creep_y, spin
    return y_rel, found


def _wheels(u: Signals, p: Signals, d: Signals) -> list[ca.SX]:
    """What `common_creepage` needs: both contacts, their grips, the net force wanted [N]."""
    speed, (_, creepages) = speed_of(u, p), _creepages(u, p)
    loaded = [loaded_contact(creepages[s], speed, u[f"load_{s}"], p, d) for s in SIDES]
    contacts = [ca.vertcat(*vars(contact).values()) for contact, _ in loaded]
    grips = ca.vertcat(*(grip for _, grip in loaded))
    return [ca.horzcat(*contacts), grips, u["torque"] / p["rolling_radius"]]


def _overlap(sign: int, off_rail: ca.SX, p: Signals) -> ca.SX:
    """How far [m] the flange of one side is beyond its clearance; negative before it touches."""
    return sign * off_rail - p["flange_clearance"]


def by_name(names: Iterable[str], vector: ca.SX) -> Signals:
    return dict(zip(names, ca.vertsplit(vector), strict=True))
