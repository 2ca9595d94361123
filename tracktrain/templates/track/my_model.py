"""A track whose rails wind as a sinusoid, to be changed into your own irregularities.

X points forward, Y left, Z up. All numbers are SI. Axles 1 and 2 are the front truck's, 3 and 4 the
rear truck's. The leading axle starts at station 0, the others behind it on perfect track.
"""

from math import pi, sin

from fmus.model import Input, Model, Output, Parameter

AXLES = (1, 2, 3, 4)
SIDES = ("left", "right")


class MyModel(Model):
    """Its state is the distance that the car has travelled."""

    description = "Track of sinusoidal alignment under the four axles of a car"

    # The car gives its own values to parameters of these names, where it has such.
    parameters = (
        Parameter("amplitude", "m", "Amplitude of the alignment", minimum=0.0, default=3e-3),
        Parameter("wavelength", "m", "Wavelength of the alignment", minimum=0.5, default=11.9),
        Parameter("fade_length", "m", "Length over which it grows", minimum=0.0, default=10.0),
        Parameter(
            "half_truck_spacing",
            "m",
            "Half distance of the truck centres",
            minimum=0.0,
            default=5.1562,
        ),
        Parameter("half_wheelbase", "m", "Half wheelbase of a truck", minimum=0.0, default=0.8636),
    )

    inputs = (Input("speed", "m/s", "Speed of the car", start=18.288),)

    outputs = (
        Output("distance", "m", "Distance travelled", nominal=100.0),
        Output("speed_out", "m/s", "Speed, passed through", derivative_of="distance"),
        *(
            Output(
                f"axle[{k}].rail_{axis}_{side}",
                "m",
                f"{direction} displacement of the {side} rail under axle {k}",
                nominal=1e-3,
            )
            for k in AXLES
            for axis, direction in (("y", "Lateral"), ("z", "Vertical"))
            for side in SIDES
        ),
    )

    # Which inputs change an output within the same instant. `tracktrain fmu pack` tries it out.
    feedthrough = {"speed_out": ("speed",)}

    def start(self, p, u):
        self.distance = 0.0

    def step(self, p, u, time, size):
        self.distance += u["speed"] * size

    def output(self, p, u):
        truck, axle = 2 * p["half_truck_spacing"], 2 * p["half_wheelbase"]
        behind = (0.0, axle, truck, truck + axle)
        y = {"distance": self.distance, "speed_out": u["speed"]}
        for k in AXLES:
            left, right = self.rails(max(self.distance - behind[k - 1], 0.0), p)
            y[f"axle[{k}].rail_y_left"], y[f"axle[{k}].rail_z_left"] = left
            y[f"axle[{k}].rail_y_right"], y[f"axle[{k}].rail_z_right"] = right
        return y

    def rails(self, station, p):
        """(lateral, vertical) of the left and of the right rail [m]: change it here."""
        grown = min(station / max(p["fade_length"], 1e-6), 1.0)
        fade = grown**3 * (10 - 15 * grown + 6 * grown**2)
        y = fade * p["amplitude"] * sin(2 * pi * station / p["wavelength"])
        return (y, 0.0), (y, 0.0)
