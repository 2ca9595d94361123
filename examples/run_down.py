"""A run-down through the critical speed: the speed follows a table, and the hunting dies out.

python examples/run_down.py [run_down.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from orchestrator import read_profile, simulate
from tracktrain import hopper_car

FOOT = 0.3048
TABLE = Path(__file__).with_name("run_down.csv")


def main(picture: str) -> None:
    profile = read_profile(TABLE)
    car = hopper_car(track="perfect").driven("track.speed", profile)
    car = car.with_value("truck_front.initial.yaw", "0.005 deg")
    names = ["truck_front.axle[1].y", "track.speed_out"]
    results = simulate(car, duration=profile.times[-1], step=1e-3, record=names).dataset
    lateral, speed = (results[name] for name in names)
    slowing = lateral.time >= profile.times[1]
    for fast in range(80, 20, -10):
        inside = slowing & (speed <= fast * FOOT) & (speed > (fast - 10) * FOOT)
        amplitude = 1e3 * float(np.abs(lateral[inside]).max())
        print(f"{fast} to {fast - 10} ft/s: {amplitude:.3f} mm")

    figure = Figure(figsize=(8, 4), layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    above.plot(lateral.time, 1e3 * lateral)
    above.set_ylabel("leading axle [mm]")
    below.plot(speed.time, speed / FOOT)
    below.set(xlabel="time [s]", ylabel="speed [ft/s]")
    figure.savefig(picture)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "run_down.png")
