"""A yawed truck on perfect track hunts: from 0.005 degree to a limit cycle, at 80 ft/s.

python examples/hunting.py [picture.png]
"""

from __future__ import annotations

import sys

from matplotlib.figure import Figure

from orchestrator import simulate
from tracktrain import hopper_car

FOOT = 0.3048


def main(picture: str) -> None:
    car = hopper_car("loaded", speed=80 * FOOT, track="perfect")
    car = car.with_value("truck_front.initial.yaw", "0.005 deg")
    run = simulate(car, duration=16.0)

    lateral = run.dataset["truck_front.axle[1].y"]
    late = lateral.sel(time=slice(12.0, None))
    print(f"limit cycle of the leading axle: {1e3 * float(abs(late).max()):.2f} mm")

    figure = Figure(figsize=(8, 3), layout="constrained")
    axes = figure.subplots()
    axes.plot(lateral.time, 1e3 * lateral)
    axes.set(xlabel="time [s]", ylabel="leading axle, lateral [mm]")
    figure.savefig(picture)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "hunting.png")
