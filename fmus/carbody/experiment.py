"""Reference results of the carbody: constant forces at both centre plates, in closed form."""

from __future__ import annotations

import numpy as np

from ..describe.experiment import TIMES, Experiment, Table, held
from ..describe.variables import Values
from .block import ENDS, FORCES, MOTIONS, Carbody
from .modes import frequencies, mode_shapes, motion_after

LOADS = {
    "front.force_y": 8e3,
    "front.moment_x": -6e3,
    "rear.force_z": 5e3,
    "front.force_z": -2e3,
    "rear.force_y": -3e3,
    "rear.moment_z": 4e3,
}
"""Forces [N] and moments [N.m] on the carbody."""


def _solve(values: Values) -> tuple[Table, Table]:
    """The exponential of the whole modal system, apart from the block's own equations."""
    motion = [motion_after(values, np.zeros(16), LOADS, {}, duration) for duration in TIMES]
    q, qd = np.hsplit(np.array(motion), 2)
    w = frequencies(values)
    shapes = {end: mode_shapes(values, sign) for end, sign in ENDS.items()}
    loads = {end: np.array([LOADS.get(f"{end}.{name}", 0.0) for name in FORCES]) for end in ENDS}
    modal = sum(shapes[end].T @ loads[end] for end in ENDS)
    qdd = modal - 2 * values["modal_damping"] * w * qd - w**2 * q
    results: Table = {"time": TIMES}
    for end, shape in shapes.items():
        for names, coordinates in (
            (MOTIONS, q),
            (("vy", "vz", "wx", "wz"), qd),
            (("ay", "az", "wx_dot", "wz_dot"), qdd),
        ):
            columns = (coordinates @ shape.T).T
            results |= {f"{end}.{n}": column for n, column in zip(names, columns, strict=True)}
    inertias = ("body_mass", "body_mass", "roll_inertia", "yaw_inertia", "pitch_inertia")
    for i, name in enumerate(("y", "z", "roll", "yaw", "pitch")):
        results[f"cg.{name}"] = q[:, i] / values[inertias[i]] ** 0.5
    for i, name in enumerate(("ay", "az")):
        results[f"cg.{name}"] = qdd[:, i] / values["body_mass"] ** 0.5
    for i in range(8):
        results |= {f"q[{i + 1}]": q[:, i], f"qd[{i + 1}]": qd[:, i]}
    return held(LOADS), results


EXPERIMENT = Experiment(
    Carbody,
    "Constant forces at both centre plates. Results: the matrix exponential of all modes at once, "
    "with mode shapes derived from rigid-body motion and the beam's shape.",
    1e-8,
    _solve,
    exchange_tolerance=1e-3,
)
