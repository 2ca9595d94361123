"""Reference results of the truck: the same equations in much shorter micro steps."""

from __future__ import annotations

import numpy as np

from ..describe.experiment import TIMES, Experiment, Table, held
from ..describe.twin import Twin
from ..describe.variables import Values
from .block import Truck
from .ports import AXLES
from .three_piece import ThreePieceTruck

INPUTS = {
    "car.y": 0.004,
    "car.yaw": 0.002,
    "axle[1].force_y": 2e3,
    "axle[2].force_y": -2e3,
    **{f"axle[{k}].rail_z_{s}": z for k in AXLES for s, z in (("left", 6e-3), ("right", 4e-3))},
}
"""Motion of the carbody [m, rad], lateral wheel forces [N], heights of the rails [m]."""


def in_finer_steps(truck: type[ThreePieceTruck]) -> Experiment:
    """The Python twin with micro steps five times shorter: springs, stops, slipping friction."""

    def solve(values: Values) -> tuple[Table, Table]:
        twin = Twin(truck(), {**values, "micro_step": values["micro_step"] / 5}, INPUTS)
        twin.initialize()
        rows = [twin.outputs()]
        for size in np.diff(TIMES):
            twin.step(float(size))
            rows.append(twin.outputs())
        names = [output.name for output in truck.outputs]
        return held(INPUTS), {"time": TIMES, **dict(zip(names, np.array(rows).T, strict=True))}

    return Experiment(
        truck,
        "A carbody that stands displaced, rails that are uneven, constant wheel forces; the "
        "elements slip and strike their stops. Results: the same equations in Python with micro "
        "steps of 5 us in place of 25 us; the tolerance is the error of the latter.",
        1e-3,
        solve,
        {"micro_step": 2.5e-5},
        exchange_tolerance=3e-3,
    )


EXPERIMENT = in_finer_steps(Truck)
