"""The truck block: six coordinates, six spring-and-friction elements, centre plate contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ..describe.block import Block, Signals
from ..describe.elements import (
    friction_force,
    slider_indicator,
    slider_mode,
    slip_after,
    spring_force,
    stop_indicator,
)
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
    STATES,
    TANGENTS,
    TERMINALS,
)

GRAVITY = 9.80665  # [m/s2]
PLANAR = (0, 1, 3, 4)
"""Places in q of the coordinates that the mass matrix couples."""

WEDGE_ELEMENTS = (2, 3, 4)
"""Places of the elements whose friction is the wedges': bolster roll, vertical, lateral."""

Motion = list[ca.SX]
"""The six coordinates, or their rates."""


@dataclass(frozen=True)
class Joints:
    """Forces of the elements and of the contact, [N] or [N.m], with what they came from."""

    strain: Motion
    reach: Motion
    spring: Motion
    friction: Motion
    contact_z: ca.SX
    contact_roll: ca.SX

    def total(self, element: int) -> ca.SX:
        """Spring and friction of the element at this place."""
        return self.spring[element] + self.friction[element]


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
        return {
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
        return _states(q, qd, _strains(q, u, p))

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
        """Classical Runge-Kutta step; friction follows the strain inside it, (10), (11)."""
        q, qd, slip = _coordinates(x)
        middle = {name: u[name] + rate[name] * (0.5 * h) for name in u}
        end = {name: u[name] + rate[name] * h for name in u}
        start_motion = _axle_motions(q, qd, p)

        def acceleration(at: Signals, q: Motion, qd: Motion) -> Motion:
            loads = _axle_loads(at, u, _axle_motions(q, qd, p), start_motion)
            return _acceleration(_joints(q, qd, slip, at, p, d), loads, p, d)

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

        joints = _joints(q_end, qd_end, slip, end, p, d)
        loads = _axle_loads(end, u, _axle_motions(q_end, qd_end, p), start_motion)
        return _states(q_end, qd_end, _slip_after(joints, slip)), loads

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        q, qd, slip = _coordinates(x)
        joints = _joints(q, qd, slip, u, p, d)
        motions = _axle_motions(q, qd, p)
        car_force_y = joints.total(0)
        # (9): half of the truck's loads to each axle
        both = p["axle_load"] - 0.5 * joints.total(3)
        tilting = joints.total(2) + p["centre_plate_height"] * car_force_y
        left_less_right = -0.5 * tilting / p["half_contact_spacing"]
        return {
            **{f"axle[{k}].{name}": motions[k][name] for k in AXLES for name in OWN_MOTION},
            **{f"axle[{k}].load_left": ca.fmax(0.5 * (both + left_less_right), 0) for k in AXLES},
            **{f"axle[{k}].load_right": ca.fmax(0.5 * (both - left_less_right), 0) for k in AXLES},
            "car.force_y": car_force_y,
            "car.force_z": joints.contact_z,
            "car.moment_x": joints.contact_roll,
            "car.moment_z": joints.total(1),
            **_numbered("q", q),
            **_numbered("qd", qd),
            **_numbered("spring", joints.spring),
            **_numbered("friction", joints.friction),
        }

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """(3) with the sliders where they are; an element at its limit gives no stiffness."""
        q, qd, slip = _coordinates(x)
        loads = {f"axle[{k}].{name}": u[f"axle[{k}].{name}"] for k in AXLES for name in SHARES}
        acceleration = _acceleration(_joints(q, qd, slip, u, p, d), loads, p, d)
        return {**_numbered("q", qd), **_numbered("qd", acceleration)}

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """(14), (15) for the six elements."""
        q, qd, slip = _coordinates(x)
        joints = _joints(q, qd, slip, u, p, d)
        ports_at_rest: dict[str, ca.SX] = dict.fromkeys(u, ca.SX(0))
        moving = ports_at_rest | {"car.y": u["car.vy"], "car.yaw": u["car.wz"]}
        rate = _strains(qd, moving, p)
        sliders = [
            slider_indicator(joints.strain[i], rate[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        stops = [
            stop_indicator(joints.strain[i], p[f"{name}.stop_stiffness"], p[f"{name}.free_play"])
            for i, name in enumerate(ELEMENTS)
        ]
        return {**_numbered("slider", sliders), **_numbered("stop", stops)}

    def memory_after(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> tuple[Signals, Signals]:
        """(6), (13): the sliders follow, and the modes with them."""
        q, qd, slip = _coordinates(x)
        joints = _joints(q, qd, slip, u, p, d)
        modes = [
            slider_mode(joints.strain[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        return _numbered("slip", _slip_after(joints, slip)), _numbered("slider", modes)


def _slip_after(joints: Joints, slip: Motion) -> Motion:
    """The slips once the sliders have followed the strains, (6)."""
    return [
        slip_after(strain, s, reach)
        for strain, s, reach in zip(joints.strain, slip, joints.reach, strict=True)
    ]


def _strains(q: Motion, u: Signals, p: Signals) -> Motion:
    """Strains of the six elements, (4)."""
    heights = [u[f"axle[{k}].rail_z_{side}"] for k in AXLES for side in ("left", "right")]
    left_1, right_1, left_2, right_2 = heights
    left, right = left_1 + left_2, right_1 + right_2
    return [
        q[0] + p["half_wheelbase"] * (q[1] + q[3]) + q[4] - u["car.y"],
        q[1] - u["car.yaw"],
        q[2] - 0.25 * (left - right) / p["half_contact_spacing"],
        q[5] - 0.25 * (left + right),
        q[4],
        q[3],
    ]


def _joints(q: Motion, qd: Motion, slip: Motion, u: Signals, p: Signals, d: Signals) -> Joints:
    """Forces of the six elements, (5) to (7), and of the centre plate contact, (8)."""
    strain = _strains(q, u, p)
    spring = [
        spring_force(e, p[f"{n}.stiffness"], p[f"{n}.stop_stiffness"], p[f"{n}.free_play"])
        for n, e in zip(ELEMENTS, strain, strict=True)
    ]
    # (7): a bolster that comes down adds to the load on the wedges
    load_ratio = ca.fmax(1 - d["load_sensitivity"] * spring[3], 0)
    scale = [load_ratio if i in WEDGE_ELEMENTS else 1 for i in range(len(ELEMENTS))]
    friction = [
        friction_force(e, s, p[f"{n}.friction_stiffness"], p[f"{n}.friction_limit"] * scale[i])
        for i, (n, e, s) in enumerate(zip(ELEMENTS, strain, slip, strict=True))
    ]
    c_roll, c_z = ca.vertsplit(d["contact_damping"])
    return Joints(
        strain=strain,
        reach=[d["reach"][i] * scale[i] for i in range(len(ELEMENTS))],
        spring=spring,
        friction=friction,
        contact_z=p["contact_vertical.stiffness"] * (q[5] - u["car.z"])
        + c_z * (qd[5] - u["car.vz"]),
        contact_roll=p["contact_roll.stiffness"] * (q[2] - u["car.roll"])
        + c_roll * (qd[2] - u["car.wx"]),
    )


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
        -by_roll * (roll + joints.contact_roll),
        a[2],
        a[3],
        -by_vertical * (vertical + joints.contact_z),
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
