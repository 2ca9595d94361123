"""Draws the pictures of the README and the documentation from runs of the car.

python docs/make_pictures.py
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from orchestrator import simulate
from tracktrain.car.hopper import DURATION, hopper_car
from tracktrain.plots import BLUE, INK, RED, STYLE, plot_displacement
from tracktrain.scales import FOOT
from tracktrain.studies.hunting_causes import hunting_causes
from tracktrain.studies.structure import structure

PICTURES = Path(__file__).parent / "pictures"


@mpl.rc_context(STYLE)
def coupling() -> Figure:
    """Leading axle at 100 ft/s on the smooth track: held coupling against one-pass at 1 ms."""
    car = hopper_car(speed=100 * FOOT, track="report-grid")
    curves = {
        "converged: one-pass at 0.1 ms": (simulate(car, duration=4.0, step=1e-4), INK, 3.0, 0.35),
        "held inputs (jacobi) at 1 ms": (simulate(car, duration=4.0, master="jacobi"), RED, 1.2, 1),
        "one-pass at 1 ms": (simulate(car, duration=4.0), BLUE, 1.2, 1),
    }
    exact = _axle(curves["converged: one-pass at 0.1 ms"][0].dataset)[::10]
    figure = Figure(figsize=(9.0, 3.4), layout="constrained")
    axes = figure.subplots()
    for label, (run, colour, width, alpha) in curves.items():
        y = _axle(run.dataset)
        if len(y) == len(exact):
            error = np.sqrt(np.mean((y - exact) ** 2) / np.mean(exact**2))
            label += f": error {error:.2g} of the rms"
        axes.plot(run.dataset.time, 1e3 * y, color=colour, lw=width, alpha=alpha, label=label)
    axes.set(xlabel="time [s]", ylabel="leading axle, lateral [mm]", xlim=(0.0, 4.0))
    axes.set_title("Loaded hopper car at 100 ft/s (68 mph), smooth track, macro step 1 ms")
    axes.legend(frameon=False, loc="lower left")
    return figure


def _axle(dataset) -> np.ndarray:
    return dataset["truck_front.axle[1].y"].values


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    coupling().savefig(PICTURES / "coupling.png", dpi=120)
    run = simulate(hopper_car(), duration=DURATION)
    plot_displacement(run.dataset).savefig(PICTURES / "displacement.png", dpi=120)
    for name, picture in structure().pictures.items():
        if name != "transfer_functions":
            picture.savefig(PICTURES / f"structure_{name}.png", dpi=110)
    causes = hunting_causes().pictures["critical_speeds"]
    causes.savefig(PICTURES / "hunting_causes.png", dpi=120)
