"""A truck from another house in the car: assembled in Exudyn, packaged by pythonfmu.

python examples/truck_of_another_house.py [picture.png]     needs exudyn and pythonfmu

The same car on the same track with our truck of six coordinates, with our truck of joints, and with
Exudyn's (exudyn_truck/exudyn_truck.py, its port names in exudyn_truck/ports.toml) as front truck.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from pythonfmu.builder import FmuBuilder

from fmus.catalogue import fmu_path
from orchestrator import Run, read_port_map, simulate
from tracktrain import hopper_car
from tracktrain.car.changes import swapped

HERE = Path(__file__).parent / "exudyn_truck"
DURATION, STEP = 1.5, 5e-4  # s
LATERAL = "truck_front.axle[1].y"


def run(fmu: Path | None, map_file: Path | None = None) -> tuple[Run, float]:
    """A run with this front truck, and the time that it took [s]."""
    car = hopper_car("loaded", "60 ft/s", "report")
    if fmu is not None:
        car, _ = swapped(car, "truck_front", fmu, map_file and read_port_map(map_file))
    simulate(car, duration=0.01, step=STEP, self_test=True)  # tests the FMU and compiles the loop
    started = time.perf_counter()
    return simulate(
        car, duration=DURATION, step=STEP, self_test=True
    ), time.perf_counter() - started


def difference(one: Run, other: Run) -> float:
    """Rms of the difference of the leading axle's motion over the rms of `other`'s [%]."""
    a, b = (each.dataset[LATERAL].values for each in (one, other))
    return 100 * float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


def main(picture: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        theirs = FmuBuilder.build_FMU(HERE / "exudyn_truck.py", dest=folder)
        exudyn, took = run(theirs, HERE / "ports.toml")
    six, _ = run(None)
    joints, _ = run(fmu_path("truck_joints"))
    print(f"{exudyn.verdict}")
    print(f"Exudyn's truck against our truck of joints: {difference(exudyn, joints):.2f} %")
    print(f"Exudyn's truck against our six coordinates: {difference(exudyn, six):.2f} %")
    print(f"a second of the car takes {took / DURATION:.1f} s")

    figure, (motion, gap) = plt.subplots(2, figsize=(8, 6), sharex=True, layout="constrained")
    for name, each in (("six coordinates", six), ("joints", joints), ("Exudyn", exudyn)):
        lateral = 1e3 * each.dataset[LATERAL]
        motion.plot(each.dataset.time, lateral, label=name)
        gap.plot(each.dataset.time, lateral - 1e3 * joints.dataset[LATERAL])
    motion.set(ylabel="leading axle, lateral [mm]")
    gap.set(xlabel="time [s]", ylabel="less that of the joints [mm]")
    motion.legend(frameon=False)
    figure.savefig(picture, dpi=150)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "truck_of_another_house.png")
