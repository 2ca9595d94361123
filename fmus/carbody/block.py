"""The carbody block: five rigid and three elastic modes, loaded at two centre plates."""

from __future__ import annotations

from itertools import chain
from math import cos, cosh, pi

import casadi as ca

from ..describe.block import Block, Signals, State
from ..describe.terminals import CENTRE_PLATE, Terminal
from ..describe.variables import Array, Constant, Input, Output, Parameter, vector
from .oscillator import oscillator, rigid

MODAL = "kg^(1/2).m"
"""Unit of a modal coordinate. It is only a name, since FMI defines units by whole exponents."""

MODES = {
    "lateral": "m",
    "vertical": "m",
    "roll": "rad",
    "yaw": "rad",
    "pitch": "rad",
    "torsion": MODAL,
    "lateral_bending": MODAL,
    "vertical_bending": MODAL,
}
"""The modes 1..8, with the unit of their initial value."""

RIGID = tuple(MODES)[:5]
ELASTIC = tuple(MODES)[5:]
ENDS = {"front": 1, "rear": -1}
FORCES = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
MOTIONS = ("y", "z", "roll", "yaw")
BEAM_WAVE_NUMBER = 4.730040744862704
"""First root of cos(k) cosh(k) = 1, the free-free beam's."""


def _elastic(mode: str, symbol: str) -> Parameter:
    title = mode.replace("_", " ")
    return Parameter(
        f"{mode}_frequency",
        "Hz",
        f"First {title} frequency, free-free",
        symbol=f"f_{symbol}",
        minimum=0.0,
        tunable=True,
    )


def _inertia(mode: str, axis: str) -> Parameter:
    return Parameter(
        f"{mode}_inertia",
        "kg.m2",
        f"{mode.capitalize()} inertia about the centre of gravity",
        symbol=f"I_{axis}{axis}",
        minimum=1.0,
    )


def _mode_shape(end: str) -> Array:
    """Entries of the mode shapes at one end, row by row."""
    return Array(
        f"{end}.mode_shape",
        f"Motion of the {end} centre plate (rows y, z: kg^(-1/2); roll, yaw: kg^(-1/2).rad/m) over "
        f"the modal coordinates (columns {', '.join(MODES)})",
        tuple(
            f"{end}.mode_shape[{row},{column}]"
            for row in range(1, len(MOTIONS) + 1)
            for column in range(1, len(MODES) + 1)
        ),
        (len(MOTIONS), len(MODES)),
    )


class Carbody(Block):
    """Carbody by its modes, from static equilibrium. Equation numbers: README.md of this folder."""

    name = "carbody"
    description = "Freight car body: five rigid and three elastic modes, two centre plates"
    parameters = (
        Parameter("body_mass", "kg", "Mass of the carbody with lading", symbol="m", minimum=1.0),
        _inertia("roll", "x"),
        _inertia("pitch", "y"),
        _inertia("yaw", "z"),
        Parameter(
            "gravity_centre_height",
            "m",
            "Height of the centre of gravity above the centre plates",
            symbol="h",
        ),
        Parameter(
            "half_truck_spacing",
            "m",
            "Half distance of the truck centres",
            symbol="l_c",
            minimum=0.1,
        ),
        Parameter("body_length", "m", "Length of the carbody as a beam", symbol="L", minimum=0.1),
        Parameter(
            "torsion_shape",
            "1",
            "Rotation of the ends in first torsion, times sqrt(I_xx)",
            symbol="phi_t",
        ),
        *(_elastic(mode, mode[0]) for mode in ELASTIC),
        Parameter(
            "modal_damping",
            "1",
            "Damping ratio of the elastic modes",
            symbol="zeta",
            minimum=0.0,
            maximum=0.99,
            tunable=True,
        ),
        *(
            Parameter(
                f"initial.{mode}{suffix}",
                f"{unit}/s" if suffix else unit,
                f"{mode.replace('_', ' ').capitalize()} at the start{text}",
                default=0.0,
            )
            for suffix, text in (("", ""), ("_rate", ", rate"))
            for mode, unit in MODES.items()
        ),
    )
    inputs = tuple(
        Input(f"{end}.{force}", unit, f"{text} on the carbody at the {end} centre plate")
        for end in ENDS
        for (force, unit), text in zip(
            FORCES.items(),
            ("Lateral force", "Vertical force, beyond the static,", "Roll moment", "Yaw moment"),
            strict=True,
        )
    )
    outputs = (
        *(
            Output(f"{end}.{name}", unit, f"{text} of the {end} centre plate", **more)
            for end in ENDS
            for name, unit, text, more in (
                ("y", "m", "Lateral displacement", {"nominal": 1e-2}),
                ("z", "m", "Vertical displacement", {"nominal": 1e-2}),
                ("roll", "rad", "Roll", {"nominal": 1e-2}),
                ("yaw", "rad", "Yaw", {"nominal": 1e-2}),
                ("vy", "m/s", "Lateral velocity", {"derivative_of": f"{end}.y"}),
                ("vz", "m/s", "Vertical velocity", {"derivative_of": f"{end}.z"}),
                ("wx", "rad/s", "Roll rate", {"derivative_of": f"{end}.roll"}),
                ("wz", "rad/s", "Yaw rate", {"derivative_of": f"{end}.yaw"}),
                ("ay", "m/s2", "Lateral acceleration", {"derivative_of": f"{end}.vy"}),
                ("az", "m/s2", "Vertical acceleration", {"derivative_of": f"{end}.vz"}),
                ("wx_dot", "rad/s2", "Roll acceleration", {"derivative_of": f"{end}.wx"}),
                ("wz_dot", "rad/s2", "Yaw acceleration", {"derivative_of": f"{end}.wz"}),
            )
        ),
        Output("cg.y", "m", "Lateral displacement of the centre of gravity", nominal=1e-2),
        Output("cg.z", "m", "Vertical displacement of the centre of gravity", nominal=1e-2),
        Output("cg.roll", "rad", "Rigid roll", nominal=1e-2),
        Output("cg.pitch", "rad", "Rigid pitch", nominal=1e-2),
        Output("cg.yaw", "rad", "Rigid yaw", nominal=1e-2),
        Output("cg.ay", "m/s2", "Lateral acceleration of the centre of gravity"),
        Output("cg.az", "m/s2", "Vertical acceleration of the centre of gravity"),
        *(
            Output(f"q[{i}]", MODAL, f"Modal coordinate {i}, {mode.replace('_', ' ')}")
            for i, mode in enumerate(MODES, start=1)
        ),
        *(
            Output(
                f"qd[{i}]",
                f"{MODAL}/s",
                f"Rate of modal coordinate {i}, {mode.replace('_', ' ')}",
                derivative_of=f"q[{i}]",
            )
            for i, mode in enumerate(MODES, start=1)
        ),
    )
    states = (
        *(State(f"q[{i}]", MODAL, f"Modal coordinate {i}") for i in range(1, 9)),
        *(State(f"qd[{i}]", f"{MODAL}/s", f"Rate of modal coordinate {i}") for i in range(1, 9)),
    )
    terminals = tuple(
        Terminal(end, CENTRE_PLATE, f"Truck under the {end} centre plate", place, prefix=f"{end}.")
        for end, place in (("front", (50, -64)), ("rear", (-50, -64)))
    )

    constants = tuple(
        Constant(
            f"{end}.mode_shape[{row},{column}]",
            "kg^(-1/2)" if unit == "m" else "kg^(-1/2).rad/m",
            f"{motion} of the {end} centre plate for a unit of modal coordinate {column}, "
            f"{mode.replace('_', ' ')}",
        )
        for end in ENDS
        for row, (motion, unit) in enumerate(
            zip(("Lateral", "Vertical", "Roll", "Yaw"), ("m", "m", "rad", "rad"), strict=True), 1
        )
        for column, mode in enumerate(MODES, start=1)
    )
    arrays = (
        vector("q", len(MODES), f"Modal coordinates: {', '.join(MODES)}"),
        vector("qd", len(MODES), f"Rates of the modal coordinates: {', '.join(MODES)}"),
        *(_mode_shape(end) for end in ENDS),
    )

    def derived(self, p: Signals) -> Signals:
        """Entries of the mode shapes at the front centre plate, and frequencies [rad/s]."""
        root_mass, root_roll = ca.sqrt(p["body_mass"]), ca.sqrt(p["roll_inertia"])
        root_yaw, root_pitch = ca.sqrt(p["yaw_inertia"]), ca.sqrt(p["pitch_inertia"])
        bending, slope = beam_shape(p["half_truck_spacing"], p["body_length"])
        return {
            "mass": 1 / root_mass,
            "roll": 1 / root_roll,
            "roll_arm": p["gravity_centre_height"] / root_roll,
            "yaw": 1 / root_yaw,
            "yaw_arm": p["half_truck_spacing"] / root_yaw,
            "pitch": 1 / root_pitch,
            "pitch_arm": -p["half_truck_spacing"] / root_pitch,
            "torsion": p["torsion_shape"] / root_roll,
            "torsion_arm": p["torsion_shape"] * p["gravity_centre_height"] / root_roll,
            "bending": bending / root_mass,
            "bending_slope": slope / root_mass,
            "frequency": 2 * pi * ca.vertcat(*(p[f"{mode}_frequency"] for mode in ELASTIC)),
        }

    def constant(self, p: Signals, d: Signals) -> Signals:
        """The mode shapes, (2)."""
        entries = (ca.vertsplit(ca.vec(mode_shapes(d, end).T)) for end in ENDS)
        return {
            constant.name: entry
            for constant, entry in zip(self.constants, chain(*entries), strict=True)
        }

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """Rigid coordinates divided by the modes' scale, elastic ones as given. README (3)"""
        scale = _rigid_scale(d)
        return {
            f"{kind}[{i}]": p[f"initial.{mode}{suffix}"] / scale.get(mode, 1)
            for kind, suffix in (("q", ""), ("qd", "_rate"))
            for i, mode in enumerate(MODES, start=1)
        }

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """Exact for forces linear over the step, (5), (6)."""
        force, ramp = _modal_forces(u, d), _modal_forces(rate, d)
        transitions = [rigid(h)] * len(RIGID) + [
            oscillator(d["frequency"][i], p["modal_damping"], h) for i in range(len(ELASTIC))
        ]
        end = {}
        for i, transition in enumerate(transitions, start=1):
            end[f"q[{i}]"], end[f"qd[{i}]"] = transition.apply(
                x[f"q[{i}]"], x[f"qd[{i}]"], force[i - 1], ramp[i - 1]
            )
        return end, {}

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        q, qd, qdd = _coordinate_vectors(x, u, p, d)
        y: dict[str, ca.SX] = {}
        for end in ENDS:
            shape = mode_shapes(d, end)
            for names, coordinates in (
                (MOTIONS, q),
                (("vy", "vz", "wx", "wz"), qd),
                (("ay", "az", "wx_dot", "wz_dot"), qdd),
            ):
                values = ca.vertsplit(shape @ coordinates)
                y |= {f"{end}.{n}": value for n, value in zip(names, values, strict=True)}
        scale = _rigid_scale(d)
        cg = ("cg.y", "cg.z", "cg.roll", "cg.yaw", "cg.pitch")
        y |= {
            name: scale[mode] * q[i] for i, (name, mode) in enumerate(zip(cg, RIGID, strict=True))
        }
        y |= {"cg.ay": d["mass"] * qdd[0], "cg.az": d["mass"] * qdd[1]}
        for i in range(len(MODES)):
            y |= {f"q[{i + 1}]": q[i], f"qd[{i + 1}]": qd[i]}
        return y

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        _, qd, qdd = _coordinate_vectors(x, u, p, d)
        return {
            f"{name}[{i + 1}]": values[i]
            for name, values in (("q", qd), ("qd", qdd))
            for i in range(len(MODES))
        }


def beam_shape(x: ca.SX, length: ca.SX) -> tuple[ca.SX, ca.SX]:
    """First free-free bending shape of mean square one, and its slope, at x from the middle. (4)"""
    k, half = BEAM_WAVE_NUMBER / length, BEAM_WAVE_NUMBER / 2
    shape = ca.cos(k * x) / cos(half) + ca.cosh(k * x) / cosh(half)
    slope = k * (ca.sinh(k * x) / cosh(half) - ca.sin(k * x) / cos(half))
    return shape, slope


def mode_shapes(d: Signals, end: str) -> ca.SX:
    """Motion (y, z, roll, yaw) of a centre plate over the modal coordinates, (4, 8). README (2)"""
    sign = ENDS[end]
    shape = ca.SX(4, 8)
    shape[0, 0] = shape[1, 1] = d["mass"]
    shape[0, 2], shape[2, 2] = d["roll_arm"], d["roll"]
    shape[0, 3], shape[3, 3] = sign * d["yaw_arm"], d["yaw"]
    shape[1, 4] = sign * d["pitch_arm"]
    shape[0, 5], shape[2, 5] = sign * d["torsion_arm"], sign * d["torsion"]
    shape[0, 6], shape[3, 6] = d["bending"], sign * d["bending_slope"]
    shape[1, 7] = d["bending"]
    return shape


def _rigid_scale(d: Signals) -> dict[str, ca.SX]:
    """Displacement [m] or rotation [rad] of the body for a unit of each rigid coordinate."""
    factors = ("mass", "mass", "roll", "yaw", "pitch")
    return {mode: d[factor] for mode, factor in zip(RIGID, factors, strict=True)}


def _modal_forces(u: Signals, d: Signals) -> list[ca.SX]:
    """Forces on the modal coordinates, (1), or their rates, from inputs or from their rates."""
    return ca.vertsplit(
        sum(
            (mode_shapes(d, end).T @ ca.vertcat(*(u[f"{end}.{name}"] for name in FORCES)))
            for end in ENDS
        )
    )


def _coordinate_vectors(
    x: Signals, u: Signals, p: Signals, d: Signals
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Modal coordinates, rates and accelerations, (8, 1) each."""
    q, qd = (ca.vertcat(*(x[f"{n}[{i}]"] for i in range(1, 9))) for n in ("q", "qd"))
    w = d["frequency"]
    restoring = 2 * p["modal_damping"] * w * qd[5:] + w * w * q[5:]
    qdd = ca.vertcat(*_modal_forces(u, d)) - ca.vertcat(ca.SX(5, 1), restoring)
    return q, qd, qdd
