"""The truck block: six coordinates, six spring-and-friction elements, centre plate contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from ..describe.block import Block, Signals
from ..describe.elements import slider_indicator, slider_mode, stop_indicator
from .joints import TIPPING, Joints, Motion, joints_of, slips_after, strains
from .mass import mass_matrix
from .ports import (
    ARRAYS,
    AXLES,
    COORDINATES,
    ELEMENTS,
    INPUTS,
    MODES,
    OUTPUTS,
    OWN_MOTION,
    PARAMETERS,
    SHARES,
    SIDES,
    STATES,
    TANGENTS,
    TERMINALS,
)

GRAVITY = 9.80665  # [m/s2]
NEVER = 1e30
"""Load [N] that a contact always holds, gap [m] that never closes."""

PLANAR = (0, 1, 3, 4)
"""Places in q of the coordinates that the mass matrix couples."""


class Truck(Block):
    """Three-piece truck under a carbody, on two wheelsets. Numbers: README.md of this folder."""

    name = "truck"
    description = "Three-piece freight truck: six coordinates, springs with free play, friction"
    parameters = PARAMETERS
    inputs = INPUTS
    outputs = OUTPUTS
    states = STATES
    modes = MODES
    arrays = ARRAYS
    tangents = TANGENTS
    terminals = TERMINALS

    def derived(self, p: Signals) -> Signals:
        """Inverse mass matrix, damping and friction constants, and limits of the micro step."""
        mass = mass_matrix(p)
        mobility = ca.inv(mass[PLANAR, PLANAR])  # (3)
        length = p["half_wheelbase"]
        leading, frame = ca.vertcat(1, 2 * length, 2 * length, 0), ca.vertcat(0, 0, 1, 0)
        centre_plate = ca.vertcat(1, length, length, 1)
        trailing, yaw, bolster = (ca.DM.eye(4)[:, i] for i in (0, 1, 3))
        by_strain = [
            _form(mobility, centre_plate),
            _form(mobility, yaw),
            1 / p["bolster_roll_inertia"],
            1 / p["bolster_mass"],
            _form(mobility, bolster),
            _form(mobility, frame),
        ]
        contacts = (("contact_roll", "bolster_roll_inertia"), ("contact_vertical", "bolster_mass"))
        damping = [
            2 * p[f"{name}.damping_ratio"] * ca.sqrt(p[f"{name}.stiffness"] * p[inertia])
            for name, inertia in contacts
        ]
        stiffness_trace = sum(
            p[f"{name}.stiffness"] / p[inertia] for name, inertia in contacts
        ) + sum(
            by * (p[f"{name}.stiffness"] + p[f"{name}.stop_stiffness"]
                  + p[f"{name}.friction_stiffness"])
            for name, by in zip(ELEMENTS, by_strain, strict=True)
        )  # fmt: skip
        below_springs = 2 * (p["wheelset_mass"] + p["side_frame_mass"]) * GRAVITY
        spring_load = ca.fmax(2 * p["axle_load"] - below_springs, 1.0)
        plate_weight = p["centre_plate_weight"]
        held = p["centre_plate_contact"] == 2
        rocking = p["contact_roll.stiffness"] / p["centre_plate_radius"] ** 2
        spacing = p["half_side_bearing_spacing"]
        stiffness_trace += (
            2
            * p["side_bearing_stiffness"]
            * (1 / p["bolster_mass"] + spacing**2 / p["bolster_roll_inertia"])
        )
        return {
            "plate_hold": ca.if_else(held, NEVER, plate_weight),
            "plate_sensitivity": (p["centre_plate_friction"] - 1) / plate_weight,
            "rim_share": p["contact_vertical.stiffness"]
            / ca.fmax(p["contact_vertical.stiffness"] + rocking, 1e-30),
            "bearing_gap": ca.if_else(held, NEVER, p["side_bearing_gap"]),
            "compliance": ca.vertcat(
                *(1 / ca.fmax(p[f"{n}.friction_stiffness"], 1e-30) for n in ELEMENTS)
            ),
            "unsprung_mass": below_springs / GRAVITY,
            "unsprung_roll_inertia": 2
            * (
                p["wheelset_yaw_inertia"] + p["side_frame_mass"] * p["half_side_frame_spacing"] ** 2
            ),
            "mobility": mobility,
            "bolster_mobility": ca.vertcat(*by_strain[2:4]),
            "contact_damping": ca.vertcat(*damping),
            "reach": ca.vertcat(
                *(
                    p[f"{n}.friction_limit"] / ca.fmax(p[f"{n}.friction_stiffness"], 1e-30)
                    for n in ELEMENTS
                )
            ),
            "load_sensitivity": (p["wedge_law"] - 1) / spring_load,
            "axle_mobility": ca.vertcat(
                _form(mobility, leading), _form(mobility, trailing), _form(mobility, yaw)
            ),
            "damping_trace": damping[0] * by_strain[2] + damping[1] * by_strain[3],
            "stiff_step": 2 / ca.sqrt(stiffness_trace),
        }

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """Coordinates as the parameters say; friction at zero, whatever these are."""
        q = [p[f"initial.{name}"] for name in COORDINATES]
        qd = [p[f"initial.{name}_rate"] for name in COORDINATES]
        kinds = ("friction_stiffness", "friction_limit")
        smooth = {**p, **{f"{name}.{kind}": ca.SX(0) for name in ELEMENTS for kind in kinds}}
        return _states(q, qd, joints_of(q, qd, strains(q, u, p), u, smooth, d).strain)

    def largest_step(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """(12): bounds on the spectrum of M^-1 K, and of M^-1 D, which grows at low speed."""
        leading, trailing, yaw = ca.vertsplit(d["axle_mobility"])
        damping = d["damping_trace"]
        for k, lateral in zip(AXLES, (leading, trailing), strict=True):
            damping -= ca.fmin(u[f"axle[{k}].force_y_per_vy"], 0) * lateral
            damping -= ca.fmin(u[f"axle[{k}].moment_z_per_wz"], 0) * yaw
        return ca.fmin(ca.fmin(p["micro_step"], d["stiff_step"]), 2 / ca.fmax(damping, 1e-9))

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        return self._step(x, u, rate, p, d, h, touching=True)

    def step_beyond(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        return self._step(x, u, rate, p, d, h, touching=False)

    def _step(
        self,
        x: Signals,
        u: Signals,
        rate: Signals,
        p: Signals,
        d: Signals,
        h: ca.SX,
        *,
        touching: bool,
    ) -> tuple[Signals, Signals]:
        """Classical Runge-Kutta step; friction follows the strain inside it, (10), (11)."""
        q, qd, slip = _coordinates(x)
        middle = {name: u[name] + rate[name] * (0.5 * h) for name in u}
        end = {name: u[name] + rate[name] * h for name in u}
        start_motion = _axle_motions(q, qd, p)

        def acceleration(at: Signals, q: Motion, qd: Motion) -> Motion:
            loads = _axle_loads(at, u, _axle_motions(q, qd, p), start_motion)
            joints = joints_of(q, qd, slip, at, p, d, touching=touching)
            return _acceleration(joints, loads, p, d)

        # For y'' = a(t, y, y') the classical step needs the accelerations only.
        half, sixth = 0.5 * h, h / 6
        a1 = acceleration(u, q, qd)
        q2, v2 = _axpy(q, half, qd), _axpy(qd, half, a1)
        a2 = acceleration(middle, q2, v2)
        q3, v3 = _axpy(q, half, v2), _axpy(qd, half, a2)
        a3 = acceleration(middle, q3, v3)
        q4, v4 = _axpy(q, h, v3), _axpy(qd, h, a3)
        a4 = acceleration(end, q4, v4)
        travel = [a + b + c for a, b, c in zip(a1, a2, a3, strict=True)]
        q_end = _axpy(_axpy(q, h, qd), h * sixth, travel)
        qd_end = _axpy(
            qd, sixth, [s + b + c + e for s, b, c, e in zip(travel, a2, a3, a4, strict=True)]
        )

        joints = joints_of(q_end, qd_end, slip, end, p, d, touching=touching)
        loads = _axle_loads(end, u, _axle_motions(q_end, qd_end, p), start_motion)
        return _states(q_end, qd_end, slips_after(joints, slip)), loads

    def margin(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """(19)"""
        return joints_of(*_coordinates(x), u, p, d, touching=True).margin

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        return self._output(x, u, p, d, touching=True)

    def output_beyond(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        return self._output(x, u, p, d, touching=False)

    def _output(self, x: Signals, u: Signals, p: Signals, d: Signals, *, touching: bool) -> Signals:
        q, qd, slip = _coordinates(x)
        joints = joints_of(q, qd, slip, u, p, d, touching=touching)
        motions = _axle_motions(q, qd, p)
        # (9): half of the truck's loads to each axle
        load, moment = joints.rails.carried(*map(joints.total, TIPPING))
        both, left_less_right = 0.5 * load, 0.5 * moment / p["half_contact_spacing"]
        lifted = [height > 0 for height in (joints.lift.left, joints.lift.right)]
        both = ca.if_else(lifted[0] * lifted[1], 0, both)
        left_less_right = ca.if_else(lifted[0], -both, ca.if_else(lifted[1], both, left_less_right))
        wheels = {
            "left": ca.fmax(0.5 * (both + left_less_right), 0),
            "right": ca.fmax(0.5 * (both - left_less_right), 0),
        }
        ratios = [
            ca.fabs(e) / ca.fmax(p[f"{n}.measured_strain"], 1e-30)
            for n, e in zip(ELEMENTS, joints.strain, strict=True)
        ]
        return {
            **{f"axle[{k}].{name}": motions[k][name] for k in AXLES for name in OWN_MOTION},
            **{f"axle[{k}].load_{side}": wheels[side] for k in AXLES for side in SIDES},
            "car.force_y": joints.total(0),
            "car.force_z": joints.plate.force_z,
            "car.moment_x": joints.plate.moment_x,
            "car.moment_z": joints.total(1),
            **_numbered("q", q),
            **_numbered("qd", qd),
            **_numbered("spring", joints.spring),
            **_numbered("friction", joints.friction),
            "centre_plate_load": joints.plate.load,
            **{
                f"side_bearing_{side}": load
                for side, load in zip(SIDES, joints.plate.bearings, strict=True)
            },
            "lift_left": joints.lift.left,
            "lift_right": joints.lift.right,
            **_numbered("strain_ratio", ratios),
        }

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """(3) with the sliders where they are; an element at its limit gives no stiffness."""
        q, qd, slip = _coordinates(x)
        loads = {f"axle[{k}].{name}": u[f"axle[{k}].{name}"] for k in AXLES for name in SHARES}
        acceleration = _acceleration(joints_of(q, qd, slip, u, p, d), loads, p, d)
        return {**_numbered("q", qd), **_numbered("qd", acceleration)}

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """(14), (15) for the six elements."""
        q, qd, slip = _coordinates(x)
        joints = joints_of(q, qd, slip, u, p, d)
        ports_at_rest: dict[str, ca.SX] = dict.fromkeys(u, ca.SX(0))
        moving = ports_at_rest | {"car.y": u["car.vy"], "car.yaw": u["car.wz"]}
        rate = strains(qd, moving, p)
        sliders = [
            slider_indicator(joints.strain[i], rate[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        stops = [
            stop_indicator(joints.strain[i], p[f"{name}.stop_stiffness"], p[f"{name}.free_play"])
            for i, name in enumerate(ELEMENTS)
        ]
        overlap = [
            q[5] - u["car.z"] + sign * p["half_side_bearing_spacing"] * (q[2] - u["car.roll"])
            for sign in (1, -1)
        ]
        touching = joints_of(q, qd, slip, u, p, d, touching=True)
        contacts = {
            "wheels": touching.wheels,
            "centre_plate": touching.plate.rim,
            "side_bearing_left": d["bearing_gap"] - overlap[0],
            "side_bearing_right": d["bearing_gap"] - overlap[1],
        }
        return {**_numbered("slider", sliders), **_numbered("stop", stops), **contacts}

    def memory_after(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> tuple[Signals, Signals]:
        """(6), (13): the sliders follow, and the modes with them."""
        q, qd, slip = _coordinates(x)
        joints = joints_of(q, qd, slip, u, p, d)
        modes = [
            slider_mode(joints.strain[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        return _numbered("slip", slips_after(joints, slip)), _numbered("slider", modes)


def _axle_motions(q: Motion, qd: Motion, p: Signals) -> dict[int, dict[str, ca.SX]]:
    """Lateral and yaw motion of the leading and the trailing axle, (1)."""
    wheelbase = 2 * p["half_wheelbase"]
    leading_y, leading_vy = (v[0] + wheelbase * (v[1] + v[3]) for v in (q, qd))
    return {
        1: {"y": leading_y, "yaw": q[1], "vy": leading_vy, "wz": qd[1]},
        2: {"y": q[0], "yaw": q[1], "vy": qd[0], "wz": qd[1]},
    }


def _axle_loads(
    at: Signals,
    u: Signals,
    motion: Mapping[int, Mapping[str, ca.SX]],
    start: Mapping[int, Mapping[str, ca.SX]],
) -> dict[str, ca.SX]:
    """Wheel/rail loads: the inputs `at` a time, and what the axles' own motion since adds, (11)."""
    loads = {}
    for k in AXLES:
        moved = {name: motion[k][name] - start[k][name] for name in OWN_MOTION}
        for name in SHARES:
            load = f"axle[{k}].{name}"
            loads[load] = at[load] + sum(u[f"{load}_per_{own}"] * moved[own] for own in OWN_MOTION)
    return loads


def _acceleration(joints: Joints, loads: Signals, p: Signals, d: Signals) -> Motion:
    """M^-1 times the generalised forces, (3)."""
    force_y = [loads[f"axle[{k}].force_y"] for k in AXLES]
    moments = sum(loads[f"axle[{k}].moment_z"] for k in AXLES)
    lateral, yaw, roll, vertical, bolster, warp = (joints.total(i) for i in range(6))
    at_leading_axle = p["half_wheelbase"] * (2 * force_y[0] - lateral)
    planar = ca.vertcat(
        force_y[0] + force_y[1] - lateral,
        at_leading_axle + moments - yaw,
        at_leading_axle - warp,
        -lateral - bolster,
    )
    a = ca.vertsplit(d["mobility"] @ planar)
    by_roll, by_vertical = ca.vertsplit(d["bolster_mobility"])
    return [
        a[0],
        a[1],
        -by_roll * (roll + joints.plate.moment_x),
        a[2],
        a[3],
        -by_vertical * (vertical + joints.plate.force_z),
    ]


def _form(mobility: ca.SX, row: ca.SX | ca.DM) -> ca.SX:
    """Acceleration of a motion under its own unit force."""
    return row.T @ mobility @ row


def _axpy(x: Motion, factor: ca.SX, y: Motion) -> Motion:
    return [a + factor * b for a, b in zip(x, y, strict=True)]


def _coordinates(x: Signals) -> tuple[Motion, Motion, Motion]:
    """q, qd and slip out of the states."""
    q, qd, slip = ([x[f"{name}[{i}]"] for i in range(1, 7)] for name in ("q", "qd", "slip"))
    return q, qd, slip


def _states(q: Sequence[ca.SX], qd: Sequence[ca.SX], slip: Sequence[ca.SX]) -> Signals:
    return {**_numbered("q", q), **_numbered("qd", qd), **_numbered("slip", slip)}


def _numbered(name: str, values: Sequence[ca.SX]) -> dict[str, ca.SX]:
    return {f"{name}[{i}]": value for i, value in enumerate(values, start=1)}
