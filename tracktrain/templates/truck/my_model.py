"""A three-piece truck under a carbody, to be changed into your own truck.

X points forward, Y left, Z up; roll about X, yaw about Z. All numbers are SI, motion is small and
from static equilibrium; axle 1 leads. `car.force_y` acts on the carbody, `axle[1].force_y` on the
wheelset.

Six coordinates: q = (trailing axle lateral, yaw, bolster roll, warp of the side frames, bolster
lateral relative to the side frames, bolster vertical). Six joints carry a spring with a stop and a
friction element each (a spring in series with a slider, which remembers where it slipped to).
"""

import math

import numpy as np

from fmus.model import Input, Model, Output, Parameter

AXLES = (1, 2)
SIDES = ("left", "right")
RAILS = tuple(f"axle[{k}].rail_z_{s}" for k in AXLES for s in SIDES)
COORDINATES = {
    "lateral": "m",
    "yaw": "rad",
    "roll": "rad",
    "warp": "rad",
    "bolster_lateral": "m",
    "bolster_vertical": "m",
}
FORCE = {"m": "N", "rad": "N.m"}
STIFFNESS = {"m": "N/m", "rad": "N.m/rad"}
NEVER = 1000.0  # free play of a joint without a stop

# Each joint's unit of strain, spring, stop, stiffness and limit of the friction, free play.
JOINTS = {
    "centre_plate_lateral": ("m", 0.0, 1.751268e8, 7.005073e7, 1.112055e5, 3.175e-3),
    "centre_plate_yaw": ("rad", 0.0, 0.0, 4.519393e5, 5.649241e3, NEVER),
    "bolster_roll": ("rad", 7.366610e6, 0.0, 4.519393e7, 3.084486e4, NEVER),
    "bolster_vertical": ("m", 7.880707e6, 0.0, 7.005073e8, 3.113755e4, NEVER),
    "bolster_lateral": ("m", 4.851013e6, 1.751268e8, 7.355327e7, 2.668933e4, 1.27e-2),
    "warp": ("rad", 3.875379e6, 7.908938e6, 2.908229e7, 1.581787e4, 2.18e-3),
}


def number(name, unit, description, default):
    return Parameter(name, unit, description, minimum=0.0, default=default)


def joint_parameters(name, unit, spring, stop, friction, limit, free_play):
    title = name.replace("_", " ")
    return (
        number(f"{name}.stiffness", STIFFNESS[unit], f"Spring stiffness, {title}", spring),
        number(f"{name}.stop_stiffness", STIFFNESS[unit], f"More of it at the stop, {title}", stop),
        number(f"{name}.friction_stiffness", STIFFNESS[unit], f"Stuck friction, {title}", friction),
        number(f"{name}.friction_limit", FORCE[unit], f"Largest friction, {title}", limit),
        number(f"{name}.free_play", unit, f"Free play to the stop, {title}", free_play),
    )


def axle_outputs(k):
    return (
        Output(f"axle[{k}].y", "m", f"Lateral displacement of axle {k}", nominal=1e-2),
        Output(f"axle[{k}].yaw", "rad", f"Yaw of axle {k}", nominal=1e-3),
        Output(f"axle[{k}].vy", "m/s", f"Its lateral velocity, {k}", derivative_of=f"axle[{k}].y"),
        Output(f"axle[{k}].wz", "rad/s", f"Its yaw rate, {k}", derivative_of=f"axle[{k}].yaw"),
        *(
            Output(f"axle[{k}].load_{s}", "N", f"Load on the {s} wheel of axle {k}", nominal=1e5)
            for s in SIDES
        ),
    )


class MyModel(Model):
    """Its state: six coordinates, their rates, and how far each friction element has slipped."""

    description = "Three-piece truck: six coordinates, springs with stops, dry friction"

    # The car gives its own values to parameters of these names; the defaults are the loaded car's.
    parameters = (
        number("half_wheelbase", "m", "Half wheelbase", 0.8636),
        number("half_contact_spacing", "m", "Half distance of the contact points", 0.75565),
        number("half_side_frame_spacing", "m", "Half distance of the side frames", 0.9906),
        number("centre_plate_height", "m", "Centre plate above the rails", 0.65405),
        number("axle_load", "N", "Static weight on the rails of one axle", 244652.2),
        number("wheelset_mass", "kg", "Mass of one wheelset", 1202.02),
        number("wheelset_yaw_inertia", "kg.m2", "Yaw inertia of one wheelset", 762.648),
        number("side_frame_mass", "kg", "Mass of one side frame", 430.913),
        number("side_frame_yaw_inertia", "kg.m2", "Yaw inertia of one side frame", 135.582),
        number("bolster_mass", "kg", "Mass of the bolster", 566.990),
        number("bolster_yaw_inertia", "kg.m2", "Yaw inertia of the bolster", 210.717),
        number("bolster_roll_inertia", "kg.m2", "Roll inertia of the bolster", 210.717),
        number("contact_vertical.stiffness", "N/m", "Centre plate, vertical", 8.756341e8),
        number("contact_vertical.damping_ratio", "1", "On the bolster's mass", 0.1),
        number("contact_roll.stiffness", "N.m/rad", "Centre plate, roll", 5.649241e7),
        number("contact_roll.damping_ratio", "1", "On the bolster's roll inertia", 0.1),
        *(p for name, numbers in JOINTS.items() for p in joint_parameters(name, *numbers)),
        Parameter("micro_step", "s", "Largest step inside", minimum=1e-6, default=2.5e-4),
        *(
            Parameter(
                f"initial.{name}", unit, f"{name.replace('_', ' ')} at the start", default=0.0
            )
            for name, unit in COORDINATES.items()
        ),
    )

    inputs = (
        Input("car.y", "m", "Lateral displacement of the carbody at the centre plate"),
        Input("car.z", "m", "Vertical displacement of the carbody at the centre plate"),
        Input("car.roll", "rad", "Roll of the carbody"),
        Input("car.yaw", "rad", "Yaw of the carbody"),
        Input("car.vy", "m/s", "Lateral velocity of the carbody at the centre plate"),
        Input("car.vz", "m/s", "Vertical velocity of the carbody at the centre plate"),
        Input("car.wx", "rad/s", "Roll rate of the carbody"),
        Input("car.wz", "rad/s", "Yaw rate of the carbody"),
        *(
            port
            for k in AXLES
            for port in (
                Input(f"axle[{k}].force_y", "N", f"Lateral force of the rails on wheelset {k}"),
                Input(f"axle[{k}].moment_z", "N.m", f"Yaw moment of the rails on wheelset {k}"),
                *(
                    Input(f"axle[{k}].rail_z_{s}", "m", f"Height of the {s} rail under axle {k}")
                    for s in SIDES
                ),
            )
        ),
    )

    outputs = (
        *(output for k in AXLES for output in axle_outputs(k)),
        Output("car.force_y", "N", "Lateral force on the carbody", nominal=1e4),
        Output("car.force_z", "N", "Vertical force on the carbody, beyond the static", nominal=1e4),
        Output("car.moment_x", "N.m", "Roll moment on the carbody", nominal=1e4),
        Output("car.moment_z", "N.m", "Yaw moment on the carbody", nominal=1e4),
        *(
            Output(f"q[{i}]", unit, f"Coordinate {i}, {name}")
            for i, (name, unit) in enumerate(COORDINATES.items(), 1)
        ),
        *(
            Output(f"qd[{i}]", f"{unit}/s", f"Rate of coordinate {i}", derivative_of=f"q[{i}]")
            for i, unit in enumerate(COORDINATES.values(), 1)
        ),
        *(
            Output(f"{part}[{i}]", FORCE[numbers[0]], f"Force of the {part}, {name}")
            for part in ("spring", "friction")
            for i, (name, numbers) in enumerate(JOINTS.items(), 1)
        ),
    )

    # Which inputs change an output within the same instant. `tracktrain fmu pack` tries it out.
    feedthrough = {
        **{f"axle[{k}].load_{s}": ("car.y", *RAILS) for k in AXLES for s in SIDES},
        "car.force_y": ("car.y",),
        "car.force_z": ("car.z", "car.vz"),
        "car.moment_x": ("car.roll", "car.wx"),
        "car.moment_z": ("car.yaw",),
        **{f"{part}[1]": ("car.y",) for part in ("spring", "friction")},
        **{f"{part}[2]": ("car.yaw",) for part in ("spring", "friction")},
        **{f"{part}[{i}]": RAILS for part in ("spring", "friction") for i in (3, 4)},
    }

    def start(self, p, u):
        length, d = p["half_wheelbase"], p["half_side_frame_spacing"]
        self.q = np.array([p[f"initial.{name}"] for name in COORDINATES])
        self.qd = np.zeros(6)

        # How the bodies move with the coordinates, one row each.
        trailing, yaw, roll, warp, bolster, vertical = np.eye(6)
        middle = trailing + length * (yaw + warp)
        self.axles = np.array([trailing + 2 * length * (yaw + warp), trailing])
        self.yaw = yaw
        bodies = (
            (p["wheelset_mass"], self.axles[0]),
            (p["wheelset_mass"], self.axles[1]),
            (2 * p["wheelset_yaw_inertia"], yaw),
            (2 * p["side_frame_mass"], middle),
            (2 * p["side_frame_mass"], d * yaw),
            (2 * p["side_frame_yaw_inertia"], yaw + warp),
            (p["bolster_mass"], middle + bolster),
            (p["bolster_mass"], vertical),
            (p["bolster_yaw_inertia"], yaw),
            (p["bolster_roll_inertia"], roll),
        )
        self.mobility = np.linalg.inv(sum(m * np.outer(row, row) for m, row in bodies))

        # How the joints are strained by the coordinates, one row each.
        self.strained = np.array([middle + bolster, yaw, roll, vertical, bolster, warp])
        self.spring, self.stop, self.stuck, self.limit, self.play = (
            np.array([p[f"{name}.{which}"] for name in JOINTS])
            for which in (
                "stiffness",
                "stop_stiffness",
                "friction_stiffness",
                "friction_limit",
                "free_play",
            )
        )
        self.slip = self.strain(self.q, p, u)  # no friction at the start

    def step(self, p, u, time, size):
        """Classical Runge-Kutta steps; the sliders follow after each."""
        count = max(1, math.ceil(size / p["micro_step"] - 1e-9))
        h = size / count
        for _ in range(count):
            q, v = self.q, self.qd
            a1 = self.acceleration(q, v, p, u)
            a2 = self.acceleration(q + h / 2 * v, v + h / 2 * a1, p, u)
            a3 = self.acceleration(q + h / 2 * v + h * h / 4 * a1, v + h / 2 * a2, p, u)
            a4 = self.acceleration(q + h * v + h * h / 2 * a2, v + h * a3, p, u)
            self.q = q + h * v + h * h / 6 * (a1 + a2 + a3)
            self.qd = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            strain, reach = self.strain(self.q, p, u), self.limit / np.maximum(self.stuck, 1e-30)
            self.slip = np.clip(self.slip, strain - reach, strain + reach)

    def output(self, p, u):
        spring, friction = self.joints(self.q, p, u)
        total = spring + friction
        contact_z, contact_roll = self.contact(self.q, self.qd, p, u)
        y = {
            "car.force_y": total[0],
            "car.force_z": contact_z,
            "car.moment_x": contact_roll,
            "car.moment_z": total[1],
        }
        both = p["axle_load"] - total[3] / 2
        tilting = total[2] + p["centre_plate_height"] * total[0]
        left_less_right = -tilting / (2 * p["half_contact_spacing"])
        for k, row in zip(AXLES, self.axles, strict=True):
            y[f"axle[{k}].y"], y[f"axle[{k}].yaw"] = row @ self.q, self.q[1]
            y[f"axle[{k}].vy"], y[f"axle[{k}].wz"] = row @ self.qd, self.qd[1]
            y[f"axle[{k}].load_left"] = max((both + left_less_right) / 2, 0.0)
            y[f"axle[{k}].load_right"] = max((both - left_less_right) / 2, 0.0)
        for name, values in (
            ("q", self.q),
            ("qd", self.qd),
            ("spring", spring),
            ("friction", friction),
        ):
            y |= {f"{name}[{i}]": value for i, value in enumerate(values, 1)}
        return y

    def strain(self, q, p, u):
        """Of the six joints, between truck, carbody and rails."""
        left, right = (sum(u[f"axle[{k}].rail_z_{s}"] for k in AXLES) / 2 for s in SIDES)
        rail_roll = (left - right) / (2 * p["half_contact_spacing"])
        return self.strained @ q - [u["car.y"], u["car.yaw"], rail_roll, (left + right) / 2, 0, 0]

    def joints(self, q, p, u):
        """Forces of spring and friction that pull each strain back: change them here."""
        strain = self.strain(q, p, u)
        beyond = strain - np.clip(strain, -self.play, self.play)
        spring = self.spring * strain + self.stop * beyond
        friction = np.clip(self.stuck * (strain - self.slip), -self.limit, self.limit)
        return spring, friction

    def contact(self, q, qd, p, u):
        """Vertical force and roll moment of the bolster on the carbody."""
        k_z, k_roll = p["contact_vertical.stiffness"], p["contact_roll.stiffness"]
        c_z = 2 * p["contact_vertical.damping_ratio"] * math.sqrt(k_z * p["bolster_mass"])
        c_roll = 2 * p["contact_roll.damping_ratio"] * math.sqrt(k_roll * p["bolster_roll_inertia"])
        return (
            k_z * (q[5] - u["car.z"]) + c_z * (qd[5] - u["car.vz"]),
            k_roll * (q[2] - u["car.roll"]) + c_roll * (qd[2] - u["car.wx"]),
        )

    def acceleration(self, q, qd, p, u):
        spring, friction = self.joints(q, p, u)
        contact_z, contact_roll = self.contact(q, qd, p, u)
        force = -self.strained.T @ (spring + friction)
        force[5] -= contact_z
        force[2] -= contact_roll
        for k, row in zip(AXLES, self.axles, strict=True):
            force += u[f"axle[{k}].force_y"] * row + u[f"axle[{k}].moment_z"] * self.yaw
        return self.mobility @ force
