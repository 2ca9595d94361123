"""A wheelset on two rails: linear creep and gravity, to be changed into your own contact model.

X points forward, Y left, Z up; yaw is about Z. All numbers are SI. A force is named for the body
that it acts on: `force_y` pushes the wheelset. Speed, loads and motion come in; forces go out.
"""

from fmus.model import Input, Model, Output, Parameter

SIDES = {"left": 1, "right": -1}
RAILS = ("rail_y_left", "rail_y_right")
ACROSS = ("yaw", "vy", "speed", "path_yaw")
ALONG = ("wz", "speed", "path_curvature")


class MyModel(Model):
    """It has no memory: its forces follow from the motion of the same instant."""

    description = "Wheelset on two rails: linear creep and gravity"

    # The car gives its own values to parameters of these names; the defaults are the loaded car's.
    parameters = (
        Parameter(
            "half_contact_spacing",
            "m",
            "Half distance of the contact points",
            minimum=1e-3,
            default=0.75565,
        ),
        Parameter("rolling_radius", "m", "Nominal rolling radius", minimum=1e-3, default=0.4191),
        Parameter("conicity", "1", "Wheel taper", minimum=0.0, tunable=True, default=0.05),
        Parameter(
            "axle_load",
            "N",
            "Static weight on the rails of one axle",
            minimum=1e-3,
            default=244652.2,
        ),
        Parameter(
            "longitudinal_creep_coefficient",
            "N",
            "Longitudinal creep coefficient",
            minimum=0.0,
            tunable=True,
            default=7.33957e6,
        ),
        Parameter(
            "lateral_creep_coefficient",
            "N",
            "Lateral creep coefficient",
            minimum=0.0,
            tunable=True,
            default=7.33957e6,
        ),
        Parameter(
            "speed_floor", "m/s", "Smallest speed of the creepages", minimum=1e-3, default=0.5
        ),
    )

    inputs = (
        Input("y", "m", "Lateral displacement of the wheelset"),
        Input("yaw", "rad", "Yaw of the wheelset"),
        Input("vy", "m/s", "Lateral velocity of the wheelset"),
        Input("wz", "rad/s", "Yaw rate of the wheelset"),
        Input("speed", "m/s", "Forward speed", start=18.288),
        *(Input(f"load_{s}", "N", f"Vertical load on the {s} wheel", start=1.2e5) for s in SIDES),
        *(Input(f"rail_y_{s}", "m", f"Lateral displacement of the {s} rail") for s in SIDES),
        # Motion is told in a frame that follows the curve; both are zero on straight track.
        Input("path_yaw", "rad", "Yaw of the frame's way over the ground here", optional=True),
        Input("path_curvature", "1/m", "Curvature of that way, to the left", optional=True),
    )

    outputs = (
        Output("force_y", "N", "Lateral force on the wheelset", nominal=1e4),
        Output("moment_z", "N.m", "Yaw moment on the wheelset", nominal=1e4),
        *(
            output
            for s in SIDES
            for output in (
                Output(f"{s}.force_x", "N", f"Longitudinal creep force on the {s} wheel"),
                Output(f"{s}.force_y", "N", f"Lateral creep force on the {s} wheel"),
                Output(f"{s}.creep_x", "1", f"Longitudinal creepage of the {s} wheel"),
                Output(f"{s}.creep_y", "1", f"Lateral creepage of the {s} wheel"),
                Output(f"{s}.l_over_v", "1", f"Outward force of the {s} wheel over its load"),
            )
        ),
        Output("y_rel", "m", "Wheelset relative to the mean of the two rails", nominal=1e-2),
    )

    # Which inputs change an output within the same instant. `tracktrain fmu pack` tries it out.
    feedthrough = {
        "force_y": ("y", *ACROSS, *RAILS),
        "moment_z": ("y", *ALONG, *RAILS),
        "y_rel": ("y", *RAILS),
        **{
            f"{s}.{name}": inputs
            for s in SIDES
            for name, inputs in (
                ("force_x", ("y", *ALONG, *RAILS)),
                ("force_y", ACROSS),
                ("creep_x", ("y", *ALONG, *RAILS)),
                ("creep_y", ACROSS),
                ("l_over_v", ("y", *ACROSS, f"load_{s}", *RAILS)),
            )
        },
    }

    def output(self, p, u):
        speed = max(u["speed"], p["speed_floor"])
        half_spacing = p["half_contact_spacing"]
        y_rel = u["y"] - (u["rail_y_left"] + u["rail_y_right"]) / 2

        # A wheelset off the middle of a coned track is pushed back by its own weight.
        gravity = -p["axle_load"] * p["conicity"] / half_spacing * y_rel
        force_y, moment_z = gravity, 0.0
        y = {"y_rel": y_rel}
        for side, sign in SIDES.items():
            # Creepage: how much a wheel slides, over how fast it rolls.
            taper = p["conicity"] * y_rel / p["rolling_radius"]
            turning = u["wz"] / speed + u["path_curvature"]
            creep_x = -sign * (taper + half_spacing * turning)
            creep_y = u["vy"] / speed - u["yaw"] + u["path_yaw"]

            # The law of the contact: change it here.
            creep_force_x = -p["longitudinal_creep_coefficient"] * creep_x
            creep_force_y = -p["lateral_creep_coefficient"] * creep_y

            force_y += creep_force_y
            moment_z -= sign * half_spacing * creep_force_x
            outward = -sign * (creep_force_y + gravity / 2)
            load = max(u[f"load_{side}"], 0.005 * p["axle_load"])
            y[f"{side}.force_x"] = creep_force_x
            y[f"{side}.force_y"] = creep_force_y
            y[f"{side}.creep_x"] = creep_x
            y[f"{side}.creep_y"] = creep_y
            y[f"{side}.l_over_v"] = outward / load
        return {"force_y": force_y, "moment_z": moment_z, **y}
