"""A rigid carbody on two centre plates, to be changed into your own body.

X points forward, Y left, Z up; roll about X, pitch about Y, yaw about Z. All numbers are SI, motion
is small and from static equilibrium. `front.force_y` acts on the carbody at the front centre plate.
"""

from math import sqrt

from fmus.model import Input, Model, Output, Parameter

ENDS = {"front": 1, "rear": -1}
FORCES = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
MODES = {"lateral": "m", "vertical": "m", "roll": "rad", "yaw": "rad", "pitch": "rad"}
MODAL = "kg^(1/2).m"  # unit of a modal coordinate: displacement times root of the mass

LATERAL = tuple(f"{end}.{force}" for end in ENDS for force in ("force_y", "moment_x", "moment_z"))
VERTICAL = tuple(f"{end}.force_z" for end in ENDS)
FRAME = {
    "ay": ("m/s2", "Lateral acceleration, less gravity's,"),
    "az": ("m/s2", "Vertical acceleration, less gravity's beyond g,"),
    "wx_dot": ("rad/s2", "Roll acceleration"),
    "wz_dot": ("rad/s2", "Yaw acceleration"),
}
SWAYS = ("frame.ay", "frame.wx_dot")
TURNS = (*SWAYS, "frame.wz_dot")


def plate_outputs(end):
    """Motion of a centre plate: positions, velocities and accelerations."""
    plate = f"of the {end} centre plate"
    return (
        Output(f"{end}.y", "m", f"Lateral displacement {plate}", nominal=1e-2),
        Output(f"{end}.z", "m", f"Vertical displacement {plate}", nominal=1e-2),
        Output(f"{end}.roll", "rad", f"Roll {plate}", nominal=1e-2),
        Output(f"{end}.yaw", "rad", f"Yaw {plate}", nominal=1e-2),
        Output(f"{end}.vy", "m/s", f"Lateral velocity {plate}", derivative_of=f"{end}.y"),
        Output(f"{end}.vz", "m/s", f"Vertical velocity {plate}", derivative_of=f"{end}.z"),
        Output(f"{end}.wx", "rad/s", f"Roll rate {plate}", derivative_of=f"{end}.roll"),
        Output(f"{end}.wz", "rad/s", f"Yaw rate {plate}", derivative_of=f"{end}.yaw"),
        Output(f"{end}.ay", "m/s2", f"Lateral acceleration {plate}", derivative_of=f"{end}.vy"),
        Output(f"{end}.az", "m/s2", f"Vertical acceleration {plate}", derivative_of=f"{end}.vz"),
    )


class MyModel(Model):
    """Its state is the motion of the centre of gravity: five coordinates and their rates."""

    description = "Rigid carbody on two centre plates"

    # The car gives its own values to parameters of these names; the defaults are the loaded car's.
    parameters = (
        Parameter("body_mass", "kg", "Mass with lading", minimum=1.0, default=91172.1),
        Parameter("roll_inertia", "kg.m2", "Roll inertia", minimum=1.0, default=101686.0),
        Parameter("pitch_inertia", "kg.m2", "Pitch inertia", minimum=1.0, default=1039460.0),
        Parameter("yaw_inertia", "kg.m2", "Yaw inertia", minimum=1.0, default=1062060.0),
        Parameter(
            "gravity_centre_height",
            "m",
            "Height of the centre of gravity above the centre plates",
            default=1.47955,
        ),
        Parameter(
            "centre_plate_height",
            "m",
            "Height of the centre plates above the rails",
            default=0.65405,
        ),
        Parameter(
            "half_truck_spacing",
            "m",
            "Half distance of the truck centres",
            minimum=0.1,
            default=5.1562,
        ),
        *(
            Parameter(f"initial.{mode}", unit, f"{mode.capitalize()} at the start", default=0.0)
            for mode, unit in MODES.items()
        ),
    )

    inputs = (
        *(
            Input(f"{end}.{force}", unit, f"{force} on the carbody at the {end} centre plate")
            for end in ENDS
            for force, unit in FORCES.items()
        ),
        # Motion is told in a frame that follows the curve; all are zero on straight track.
        *(
            Input(f"frame.{name}", unit, f"{text} of the frame in a curve", optional=True)
            for name, (unit, text) in FRAME.items()
        ),
    )

    outputs = (
        *(output for end in ENDS for output in plate_outputs(end)),
        Output("cg.y", "m", "Lateral displacement of the centre of gravity", nominal=1e-2),
        Output("cg.z", "m", "Vertical displacement of the centre of gravity", nominal=1e-2),
        Output("cg.roll", "rad", "Roll of the body", nominal=1e-2),
        Output("cg.pitch", "rad", "Pitch of the body", nominal=1e-2),
        Output("cg.yaw", "rad", "Yaw of the body", nominal=1e-2),
        Output("cg.ay", "m/s2", "Lateral acceleration of the centre of gravity"),
        Output("cg.az", "m/s2", "Vertical acceleration of the centre of gravity"),
        *(Output(f"q[{i}]", MODAL, f"Modal coordinate, {m}") for i, m in enumerate(MODES, 1)),
        *(
            Output(f"qd[{i}]", f"{MODAL}/s", f"Rate of it, {m}", derivative_of=f"q[{i}]")
            for i, m in enumerate(MODES, 1)
        ),
    )

    # Which inputs change an output within the same instant. `tracktrain fmu pack` tries it out.
    feedthrough = {
        **{f"{end}.ay": (*LATERAL, *TURNS) for end in ENDS},
        **{f"{end}.az": (*VERTICAL, "frame.az") for end in ENDS},
        "cg.ay": (*(f"{end}.force_y" for end in ENDS), *SWAYS),
        "cg.az": (*VERTICAL, "frame.az"),
    }

    def start(self, p, u):
        self.position = {mode: p[f"initial.{mode}"] for mode in MODES}
        self.velocity = dict.fromkeys(MODES, 0.0)

    def step(self, p, u, time, size):
        """Exact for forces that are held: change it here for springs or flexible modes."""
        for mode, acceleration in self.accelerations(p, u).items():
            self.position[mode] += self.velocity[mode] * size + acceleration * size**2 / 2
            self.velocity[mode] += acceleration * size

    def output(self, p, u):
        acceleration = self.accelerations(p, u)
        inertia = self.inertias(p)
        y = {f"cg.{axis}": self.position[mode] for axis, mode in zip("yz", MODES, strict=False)}
        y |= {f"cg.{mode}": self.position[mode] for mode in ("roll", "pitch", "yaw")}
        y |= {"cg.ay": acceleration["lateral"], "cg.az": acceleration["vertical"]}
        for end, sign in ENDS.items():
            x, h = sign * p["half_truck_spacing"], p["gravity_centre_height"]
            for names, motion in (
                (("y", "z", "roll", "yaw"), self.position),
                (("vy", "vz", "wx", "wz"), self.velocity),
                (("ay", "az"), acceleration),
            ):
                plate = (
                    motion["lateral"] + h * motion["roll"] + x * motion["yaw"],
                    motion["vertical"] - x * motion["pitch"],
                    motion["roll"],
                    motion["yaw"],
                )
                y |= {f"{end}.{name}": value for name, value in zip(names, plate, strict=False)}
        for i, mode in enumerate(MODES, 1):
            y[f"q[{i}]"] = sqrt(inertia[mode]) * self.position[mode]
            y[f"qd[{i}]"] = sqrt(inertia[mode]) * self.velocity[mode]
        return y

    def inertias(self, p):
        """Mass or moment of inertia of each mode."""
        return {
            "lateral": p["body_mass"],
            "vertical": p["body_mass"],
            "roll": p["roll_inertia"],
            "yaw": p["yaw_inertia"],
            "pitch": p["pitch_inertia"],
        }

    def accelerations(self, p, u):
        """Of each mode in the frame, from the forces and moments at both centre plates."""
        total = dict.fromkeys(MODES, 0.0)
        for end, sign in ENDS.items():
            x, h = sign * p["half_truck_spacing"], p["gravity_centre_height"]
            force_y, force_z, moment_x, moment_z = (u[f"{end}.{force}"] for force in FORCES)
            total["lateral"] += force_y
            total["vertical"] += force_z
            total["roll"] += moment_x + h * force_y
            total["yaw"] += moment_z + x * force_y
            total["pitch"] -= x * force_z
        height = p["centre_plate_height"] + p["gravity_centre_height"]
        frame = {
            "lateral": u["frame.ay"] - height * u["frame.wx_dot"],
            "vertical": u["frame.az"],
            "roll": u["frame.wx_dot"],
            "yaw": u["frame.wz_dot"],
            "pitch": 0.0,
        }
        return {mode: total[mode] / of - frame[mode] for mode, of in self.inertias(p).items()}
