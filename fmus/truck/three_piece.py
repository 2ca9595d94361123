"""What every description of a three-piece truck shares: contacts, friction, the step, outputs."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from ..describe.block import Block, Signals
from ..describe.elements import slider_indicator, slider_mode, stop_indicator
from .contact import Bolster, Hung, overlaps
from .joints import Assembly, Joints, Motion, joints_of, slips_after
from .ports import AXLES, OWN_MOTION, SHARES, SIDES
from .wedges import friction_limit, stiffening

GRAVITY = 9.80665  # [m/s2]
NEVER = 1e30
"""Load [N] that a contact always holds, gap [m] that never closes."""

Axles = Mapping[int, Mapping[str, ca.SX]]
"""Lateral and yaw motion of the leading (1) and the trailing (2) axle."""


@dataclass(frozen=True)
class Mobility:
    """Accelerations of a truck that is free in its elements, under unit forces.

    by_strain: of each element's strain under the force of this element. axles: leading axle
    lateral, trailing axle lateral, yaw. kept: derived constants that the block's accelerations use.
    """

    by_strain: Sequence[ca.SX]
    axles: Sequence[ca.SX]
    kept: Signals = field(default_factory=dict)


class ThreePieceTruck(Block):
    """Two wheelsets, two side frames, a bolster, held together by elements; README.md.

    A block of this kind states its coordinates and its elements. The states are the coordinates
    `place`[i], their rates `place`d[i], and the slips of the elements.
    """

    place = "q"
    assembly: Assembly

    @abstractmethod
    def strains(self, q: Motion, u: Signals, p: Signals) -> Motion:
        """Strains of the elements on wheels that stand on the rails."""

    @abstractmethod
    def hung(self, p: Signals) -> Sequence[Hung]:
        """The elements that are strained against what is under the springs."""

    @abstractmethod
    def bolster(self, q: Motion, qd: Motion) -> Bolster:
        """Motion of the bolster under the centre plate."""

    @abstractmethod
    def axles(self, q: Motion, qd: Motion, p: Signals) -> Axles:
        """Motion of the axles, y, yaw, vy and wz of each."""

    @abstractmethod
    def mobility(self, p: Signals) -> Mobility:
        """How the truck's parts give way."""

    @abstractmethod
    def acceleration(self, joints: Joints, loads: Signals, p: Signals, d: Signals) -> Motion:
        """Accelerations of the coordinates under the joints' forces and the wheels' loads."""

    @abstractmethod
    def carried(self, u: Signals, p: Signals) -> Motion:
        """Accelerations of the coordinates of a truck that stands still in its frame, (24)."""

    @abstractmethod
    def start(self, p: Signals) -> tuple[Motion, Motion]:
        """Coordinates and rates at the start."""

    @abstractmethod
    def observed(self, q: Motion, qd: Motion, joints: Joints, p: Signals) -> Signals:
        """The outputs that tell of coordinates and elements."""

    def derived(self, p: Signals) -> Signals:
        """What gives way, damping and friction constants, and limits of the micro step."""
        mobility, names = self.mobility(p), self.assembly.elements
        below_springs = 2 * (p["wheelset_mass"] + p["side_frame_mass"]) * GRAVITY
        spring_load = ca.fmax(2 * p["axle_load"] - below_springs, 1.0)
        limits, stiffnesses = self._elements(p, spring_load)
        on_bolster = 1 / p["bolster_roll_inertia"], 1 / p["bolster_mass"]
        contacts = (("contact_roll", "bolster_roll_inertia"), ("contact_vertical", "bolster_mass"))
        damping = [
            2 * p[f"{name}.damping_ratio"] * ca.sqrt(p[f"{name}.stiffness"] * p[inertia])
            for name, inertia in contacts
        ]
        stiffness_trace = sum(
            p[f"{name}.stiffness"] / p[inertia] for name, inertia in contacts
        ) + sum(
            by * (stiffness + p[f"{name}.stop_stiffness"] + p[f"{name}.friction_stiffness"])
            for name, by, stiffness in zip(names, mobility.by_strain, stiffnesses, strict=True)
        )
        held = p["centre_plate_contact"] == 2
        preload = ca.if_else(held, 0, p["side_bearing_preload"])
        plate_weight = ca.fmax(p["centre_plate_weight"] - 2 * preload, 1.0)
        gap = ca.if_else(held, NEVER, p["side_bearing_gap"])
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
            "plate_weight": plate_weight,
            "bearing_gap": gap,
            # A bearing that always touches is no case for the form without bearings.
            "bearing_free": ca.if_else(preload > 0, -NEVER, gap),
            "bearing_spring": ca.vertcat(
                preload, ca.if_else(preload > 0, p["side_bearing_preload_stiffness"], 0)
            ),
            "compliance": ca.vertcat(
                *(1 / ca.fmax(p[f"{n}.friction_stiffness"], 1e-30) for n in names)
            ),
            "tipping_mass": (below_springs / GRAVITY + p["bolster_mass"]) * p["mass_height"],
            "unsprung_mass": below_springs / GRAVITY,
            "unsprung_roll_inertia": 2
            * (
                p["wheelset_yaw_inertia"] + p["side_frame_mass"] * p["half_side_frame_spacing"] ** 2
            ),
            **mobility.kept,
            "bolster_mobility": ca.vertcat(*on_bolster),
            "contact_damping": ca.vertcat(*damping),
            "friction_limit": ca.vertcat(*limits),
            "stiffness": ca.vertcat(*stiffnesses),
            "reach": ca.vertcat(
                *(
                    limit / ca.fmax(p[f"{n}.friction_stiffness"], 1e-30)
                    for n, limit in zip(names, limits, strict=True)
                )
            ),
            "load_sensitivity": (p["wedge_law"] - 1) / spring_load,
            "axle_mobility": ca.vertcat(*mobility.axles),
            "damping_trace": damping[0] * on_bolster[0] + damping[1] * on_bolster[1],
            "stiff_step": 2 / ca.sqrt(stiffness_trace),
        }

    def _elements(self, p: Signals, spring_load: ca.SX) -> tuple[Motion, Motion]:
        """Friction limits and stiffnesses of the elements; of the wedges' by geometry, (21), (22).

        The wedges' part of every element is in proportion to what was measured of the vertical one.
        """
        assembly, by_geometry = self.assembly, p["wedge_friction"] == 2
        vertical = assembly.elements[min(assembly.wedges.values())]
        measured = ca.fmax(assembly.groups * p[f"{vertical}.friction_limit"], 1e-30)
        ratio = ca.if_else(by_geometry, friction_limit(p) / measured, 1)
        stiffer = ca.if_else(by_geometry, 1 + stiffening(p, spring_load), 1)
        upright = assembly.wedges.keys() & {hung.place for hung in self.hung(p)}
        limits = [
            p[f"{name}.friction_limit"] * (ratio if i in assembly.wedges else 1)
            for i, name in enumerate(assembly.elements)
        ]
        return limits, [
            p[f"{name}.stiffness"] * (stiffer if i in upright else 1)
            for i, name in enumerate(assembly.elements)
        ]

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """Coordinates as the parameters say; friction at zero, whatever these are."""
        q, qd = self.start(p)
        kinds, names = ("friction_stiffness", "friction_limit"), self.assembly.elements
        smooth = {**p, **{f"{name}.{kind}": ca.SX(0) for name in names for kind in kinds}}
        free = self.strains(q, u, p)
        return self._states(q, qd, joints_of(self, q, qd, free, u, smooth, d).strain)

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
        q, qd, slip = self._coordinates(x)
        middle = {name: u[name] + rate[name] * (0.5 * h) for name in u}
        end = {name: u[name] + rate[name] * h for name in u}
        start_motion = self.axles(q, qd, p)

        def acceleration(at: Signals, q: Motion, qd: Motion) -> Motion:
            loads = _axle_loads(at, u, self.axles(q, qd, p), start_motion)
            joints = joints_of(self, q, qd, slip, at, p, d, touching=touching)
            return self._accelerations(joints, loads, at, p, d)

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

        joints = joints_of(self, q_end, qd_end, slip, end, p, d, touching=touching)
        loads = _axle_loads(end, u, self.axles(q_end, qd_end, p), start_motion)
        return self._states(q_end, qd_end, slips_after(joints, slip)), loads

    def margin(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """(19)"""
        return joints_of(self, *self._coordinates(x), u, p, d, touching=True).margin

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        return self._output(x, u, p, d, touching=True)

    def output_beyond(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        return self._output(x, u, p, d, touching=False)

    def _output(self, x: Signals, u: Signals, p: Signals, d: Signals, *, touching: bool) -> Signals:
        q, qd, slip = self._coordinates(x)
        joints = joints_of(self, q, qd, slip, u, p, d, touching=touching)
        motions = self.axles(q, qd, p)
        # (9): half of the truck's loads to each axle
        load, moment = joints.rails.carried(joints.standing)
        both, left_less_right = 0.5 * load, 0.5 * moment / p["half_contact_spacing"]
        lifted = [height > 0 for height in (joints.lift.left, joints.lift.right)]
        both = ca.if_else(lifted[0] * lifted[1], 0, both)
        left_less_right = ca.if_else(lifted[0], -both, ca.if_else(lifted[1], both, left_less_right))
        wheels = {
            "left": ca.fmax(0.5 * (both + left_less_right), 0),
            "right": ca.fmax(0.5 * (both - left_less_right), 0),
        }
        return {
            **{f"axle[{k}].{name}": motions[k][name] for k in AXLES for name in OWN_MOTION},
            **{f"axle[{k}].load_{side}": wheels[side] for k in AXLES for side in SIDES},
            "car.force_y": joints.total(0),
            "car.force_z": joints.plate.force_z,
            "car.moment_x": joints.plate.moment_x,
            "car.moment_z": joints.total(1),
            "centre_plate_load": joints.plate.load,
            **{
                f"side_bearing_{side}": load
                for side, load in zip(SIDES, joints.plate.bearings, strict=True)
            },
            "lift_left": joints.lift.left,
            "lift_right": joints.lift.right,
            **self.observed(q, qd, joints, p),
        }

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """(3) with the sliders where they are; an element at its limit gives no stiffness."""
        q, qd, slip = self._coordinates(x)
        loads = {f"axle[{k}].{name}": u[f"axle[{k}].{name}"] for k in AXLES for name in SHARES}
        joints = joints_of(self, q, qd, slip, u, p, d)
        acceleration = self._accelerations(joints, loads, u, p, d)
        return {**numbered(self.place, qd), **numbered(f"{self.place}d", acceleration)}

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """(14), (15) for the elements."""
        q, qd, slip = self._coordinates(x)
        joints = joints_of(self, q, qd, slip, u, p, d)
        ports_at_rest: dict[str, ca.SX] = dict.fromkeys(u, ca.SX(0))
        moving = ports_at_rest | {"car.y": u["car.vy"], "car.yaw": u["car.wz"]}
        rate = self.strains(qd, moving, p)
        sliders = [
            slider_indicator(joints.strain[i], rate[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        stops = [
            stop_indicator(joints.strain[i], p[f"{name}.stop_stiffness"], p[f"{name}.free_play"])
            for i, name in enumerate(self.assembly.elements)
        ]
        bolster, spacing = self.bolster(q, qd), p["half_side_bearing_spacing"]
        overlap = [overlaps(bolster, sign * spacing, u) for sign in (1, -1)]
        touching = joints_of(self, q, qd, slip, u, p, d, touching=True)
        contacts = {
            "wheels": touching.wheels,
            "centre_plate": touching.plate.rim,
            "side_bearing_left": d["bearing_gap"] - overlap[0],
            "side_bearing_right": d["bearing_gap"] - overlap[1],
        }
        return {**numbered("slider", sliders), **numbered("stop", stops), **contacts}

    def memory_after(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> tuple[Signals, Signals]:
        """(6), (13): the sliders follow, and the modes with them."""
        q, qd, slip = self._coordinates(x)
        joints = joints_of(self, q, qd, slip, u, p, d)
        modes = [
            slider_mode(joints.strain[i], slip[i], joints.reach[i], m)
            for i, m in enumerate(mode.values())
        ]
        return numbered("slip", slips_after(joints, slip)), numbered("slider", modes)

    def _accelerations(
        self, joints: Joints, loads: Signals, u: Signals, p: Signals, d: Signals
    ) -> Motion:
        """Those in the car's frame: that of the frame itself is none of them, (24)."""
        absolute = self.acceleration(joints, loads, p, d)
        return [a - b for a, b in zip(absolute, self.carried(u, p), strict=True)]

    def _coordinates(self, x: Signals) -> tuple[Motion, Motion, Motion]:
        """Coordinates, rates and slips out of the states."""
        q, qd, slip = (
            [value for name, value in x.items() if name.startswith(f"{group}[")]
            for group in (self.place, f"{self.place}d", "slip")
        )
        return q, qd, slip

    def _states(self, q: Motion, qd: Motion, slip: Motion) -> Signals:
        place = self.place
        return {**numbered(place, q), **numbered(f"{place}d", qd), **numbered("slip", slip)}


def rails_under(u: Signals, p: Signals) -> tuple[ca.SX, ca.SX]:
    """Mean height [m] and roll [rad] of the rails under the truck."""
    heights = [u[f"axle[{k}].rail_z_{side}"] for k in AXLES for side in SIDES]
    left_1, right_1, left_2, right_2 = heights
    left, right = left_1 + left_2, right_1 + right_2
    return 0.25 * (left + right), 0.25 * (left - right) / p["half_contact_spacing"]


def strain_ratios(strains: Mapping[str, ca.SX], p: Signals) -> Motion:
    """Strains of the report's elements over the largest that were measured."""
    return [
        ca.fabs(e) / ca.fmax(p[f"{name}.measured_strain"], 1e-30) for name, e in strains.items()
    ]


def numbered(name: str, values: Sequence[ca.SX]) -> dict[str, ca.SX]:
    """The values as name[1], name[2] and so on."""
    return {f"{name}[{i}]": value for i, value in enumerate(values, start=1)}


def _axle_loads(
    at: Signals,
    u: Signals,
    motion: Axles,
    start: Axles,
) -> dict[str, ca.SX]:
    """Wheel/rail loads: the inputs `at` a time, and what the axles' own motion since adds, (11)."""
    loads = {}
    for k in AXLES:
        moved = {name: motion[k][name] - start[k][name] for name in OWN_MOTION}
        for name in SHARES:
            load = f"axle[{k}].{name}"
            loads[load] = at[load] + sum(u[f"{load}_per_{own}"] * moved[own] for own in OWN_MOTION)
    return loads


def _axpy(x: Motion, factor: ca.SX, y: Motion) -> Motion:
    return [a + factor * b for a, b in zip(x, y, strict=True)]
