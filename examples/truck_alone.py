"""A system of one's own: a truck and its two wheelsets, under a carbody that stands still.

python examples/truck_alone.py [archive.ssp]
"""

from __future__ import annotations

import sys

from fmus.catalogue import fmu_path
from orchestrator import Component, Connection, Experiment, System, simulate
from orchestrator.ssp import read_ssp, write_ssp

MOTION, LOADS = ("y", "yaw", "vy", "wz"), ("load_left", "load_right")


def truck_alone() -> System:
    wheelset = Component(fmu_path("wheelrail"), {"speed": "60 ft/s"})
    truck = Component(fmu_path("truck"), {"initial.yaw": "0.1 deg"})
    links = []
    for k in (1, 2):
        links += [Connection(f"truck.axle[{k}].{n}", f"wheelset_{k}.{n}") for n in MOTION + LOADS]
        links += [
            Connection(f"wheelset_{k}.{n}", f"truck.axle[{k}].{n}") for n in ("force_y", "moment_z")
        ]
    components = {"truck": truck, "wheelset_1": wheelset, "wheelset_2": wheelset}
    return System(components, tuple(links), experiment=Experiment(stop=4.0, step=1e-3))


def main(archive: str) -> None:
    system = truck_alone()
    lateral = simulate(system).dataset["truck.axle[1].y"]  # an xarray.DataArray over `time`
    for second in range(1, 5):
        late = lateral.sel(time=slice(second - 1, second))
        print(f"second {second}: {1e3 * float(abs(late).max()):.3f} mm")

    write_ssp(system, archive)
    again = simulate(read_ssp(archive)).dataset["truck.axle[1].y"]
    print(f"as an archive: {'the same' if again.equals(lateral) else 'different'} to the last bit")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "truck_alone.ssp")
