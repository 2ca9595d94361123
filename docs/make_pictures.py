"""Draws the pictures of the README and the documentation from runs of the car.

python docs/make_pictures.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from orchestrator import simulate
from tracktrain.car.hopper import DURATION, hopper_car
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds
from tracktrain.car.spreads import uncertain
from tracktrain.options.chosen import Shape, chosen_car
from tracktrain.plots import BLUE, INK, RED, STYLE, plot_displacement
from tracktrain.scales import FOOT, MILE_PER_HOUR
from tracktrain.studies.hunting_causes import hunting_causes
from tracktrain.studies.hunting_causes.factors import field_speeds
from tracktrain.studies.structure import structure
from tracktrain.studies.uncertainty import uncertainty
from tracktrain.studies.uncertainty.design import DESIGNS
from tracktrain.studies.uncertainty.sample import SPEEDS

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


@mpl.rc_context(STYLE)
def field() -> Figure:
    """Critical speed of loaded and empty car, with its band, beside what the field reports."""
    figure = Figure(figsize=(9.0, 2.2), layout="constrained")
    axes = figure.subplots()
    for place, car in enumerate(("empty", "loaded")):
        low, high = (speed / MILE_PER_HOUR for speed in field_speeds(car))
        axes.barh(place, high - low, left=low, height=0.5, color=RED, alpha=0.35)
        numbers = uncertain(car)
        points = DESIGNS["latin"].points(len(numbers), 150, 1)
        speeds = []
        for row in points:
            changes: dict[str, float] = {}
            for number, share in zip(numbers, row, strict=True):
                changes |= number.changes(float(number.spread.quantile(share)))
            speeds += [c.speed for c in critical_speeds(LinearCar(car, changes), SPEEDS)[:1]]
        ends = np.quantile(speeds, (0.05, 0.95)) / MILE_PER_HOUR
        axes.plot(ends, [place, place], color=BLUE, lw=5, solid_capstyle="butt")
        now = critical_speeds(LinearCar(car), SPEEDS)[0].speed / MILE_PER_HOUR
        axes.plot(now, place, "o", color=INK)
    axes.set_yticks((0, 1), ("empty", "loaded"))
    axes.set(xlabel="speed [mph]", xlim=(0, 110), ylim=(-0.5, 1.5))
    axes.set_title(
        "hunting: field (red); linear critical speed of the model (point), 5 to 95 % (blue)"
    )
    return figure


CURVE = """kind,length [m],degree,direction,cant [in]
straight,80,,,
transition,60,,,
curve,200,3,left,2
transition,60,,,
straight,100,,,
"""


@mpl.rc_context(STYLE)
def curve() -> Figure:
    """The loaded car through a curve of 3 degrees at 35 mph, on perfect track."""
    with tempfile.TemporaryDirectory() as folder:
        layout = Path(folder) / "curve.csv"
        layout.write_text(CURVE)
        shape = Shape(speed=35 * MILE_PER_HOUR, track="perfect", layout=layout, duration=31.0)
        data = simulate(chosen_car(shape), duration=31.0).dataset
    way = data["track.distance"].values
    figure = Figure(figsize=(8, 7), layout="constrained")
    line, rails, push, wear = figure.subplots(4, sharex=True)
    line.plot(way, 1e3 * data["track.curvature"], color=INK)
    line.set_ylabel("curvature [1/km]")
    for name, color in (("wheelset_11", RED), ("wheelset_12", BLUE)):
        rails.plot(way, 1e3 * data[f"{name}.y_rel"], color=color, label=name)
        outer = data[f"{name}.right.wear_number"]
        wear.plot(way, outer, color=color)
    for side, color in (("left", BLUE), ("right", RED)):
        load = data[f"truck_front.axle[1].load_{side}"]
        force = data[f"wheelset_11.{side}.l_over_v"] * load
        push.plot(way, force / 1e3, color=color, label=f"wheelset_11 {side}")
    rails.set_ylabel("to the rails [mm]")
    push.set_ylabel("guiding force [kN]")
    wear.set_ylabel("T gamma, right [N]")
    wear.set_xlabel("distance of the leading axle [m]")
    for axes in (rails, push):
        axes.legend(loc="center right")
    return figure


def _axle(dataset) -> np.ndarray:
    return dataset["truck_front.axle[1].y"].values


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    coupling().savefig(PICTURES / "coupling.png", dpi=120)
    run = simulate(hopper_car(), duration=DURATION)
    plot_displacement(run.dataset).savefig(PICTURES / "displacement.png")
    for name, picture in structure().pictures.items():
        if name != "transfer_functions":
            picture.savefig(PICTURES / f"structure_{name}.png", dpi=110)
    causes = hunting_causes().pictures["critical_speeds"]
    causes.savefig(PICTURES / "hunting_causes.png", dpi=120)
    field().savefig(PICTURES / "hunting_field.png", dpi=120)
    curve().savefig(PICTURES / "curve.png", dpi=120)
    uncertainty().pictures["bands"].savefig(PICTURES / "uncertainty.png", dpi=120)
