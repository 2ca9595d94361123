"""The wheelrail block: creep, gravity and flange forces of one wheelset; it has no states."""

from __future__ import annotations

import casadi as ca

from ..block import Block, Input, Output, Parameter, Signals

SIDES = {"left": 1, "right": -1}
"""Sides of the wheelset, with the sign of their y."""

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
}


def _positive(name: str, unit: str, text: str, symbol: str, tunable: bool = False) -> Parameter:
    return Parameter(name, unit, text, symbol=symbol, minimum=1e-3, tunable=tunable)


def _from_zero(name: str, unit: str, text: str, symbol: str) -> Parameter:
    return Parameter(name, unit, text, symbol=symbol, minimum=0.0, tunable=True)


class WheelRail(Block):
    """One wheelset, linear creep law. Equation numbers: README.md of this folder."""

    name = "wheelrail"
    description = "Wheelset on two rails: linear creep, gravity, flange contact"
    parameters = (
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
    )
    inputs = (
        *(Input(name, unit, text) for name, (unit, text) in _MOTION.items()),
        Input("speed", "m/s", "Forward speed", start=18.288),
        *(Input(f"load_{s}", "N", f"Vertical load on the {s} wheel", start=1.2e5) for s in SIDES),
        *(Input(f"rail_y_{s}", "m", f"Lateral displacement of the {s} rail") for s in SIDES),
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
    )

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        speed = ca.fmax(u["speed"], p["speed_floor"])
        half_spacing = p["half_contact_spacing"]
        y_rel = u["y"] - 0.5 * (u["rail_y_left"] + u["rail_y_right"])
        # report (5-16), (5-17), errata 2, 15: gravity restores with the weight itself
        gravity = -p["gravity_factor"] * p["axle_load"] * p["conicity"] / half_spacing * y_rel
        force_y = gravity
        moment_z = p["gravity_yaw"] * p["axle_load"] * half_spacing * p["conicity"] * u["yaw"]
        y: dict[str, ca.SX] = {}
        for side, sign in SIDES.items():
            off_rail = u["y"] - u[f"rail_y_{side}"]
            # report (5-7), (5-13), errata 3, 6: opposite signs left and right
            creep_x = -sign * (
                p["conicity"] * off_rail / p["rolling_radius"] + half_spacing * u["wz"] / speed
            )
            creep_y = u["vy"] / speed - u["yaw"]  # report (5-11), erratum 1
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
            }
        return {"force_y": force_y, "moment_z": moment_z, **y, "y_rel": y_rel}

    def _flange(self, sign: int, off_rail: ca.SX, u: Signals, p: Signals) -> ca.SX:
        """Force of one rail on the flange, (6): elastic, damped in proportion, never pulling."""
        overlap = ca.fmax(sign * off_rail - p["flange_clearance"], 0)
        damped = ca.fmax(1 + p["flange_damping"] * sign * u["vy"], 0)
        return -sign * p["flange_stiffness"] * overlap * damped
