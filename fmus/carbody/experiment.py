"""Reference results of the carbody: constant forces at both centre plates, in closed form."""

from __future__ import annotations

import numpy as np

from ..describe.experiment import TIMES, Experiment, Reference, Table, as_bytes, held
from ..describe.variables import Values
from .block import Carbody
from .modal_data import DIRECTIONS, ENDS, ModalData
from .modes import ClosedForm, default_modes, modes_of
from .ports import MOTIONS, motion_names

LOADS = {
    "front.force_y": 8e3,
    "front.moment_x": -6e3,
    "rear.force_z": 5e3,
    "front.force_z": -2e3,
    "rear.force_y": -3e3,
    "rear.moment_z": 4e3,
}
"""Forces [N] and moments [N.m] on the carbody."""

METHOD = (
    "Constant forces at both centre plates. Results: the matrix exponential of all modes at once, "
    "with mode shapes derived from rigid-body motion and {shapes}."
)
TOLERANCE, EXCHANGE_TOLERANCE = 1e-8, 1e-3


def _solve(values: Values) -> tuple[Table, Table]:
    inertias = ("body_mass", "body_mass", "roll_inertia", "yaw_inertia", "pitch_inertia")
    return _results(default_modes(values), [values[name] for name in inertias])


def reference(name: str, data: ModalData) -> Reference:
    """Known results of a carbody of modal data."""
    b = data.body
    inertias = [b.mass, b.mass, b.roll_inertia, b.yaw_inertia, b.pitch_inertia]
    tables = zip(("stimuli", "results"), _results(modes_of(data), inertias), strict=True)
    tolerances = {"co-simulation": TOLERANCE, "model exchange": EXCHANGE_TOLERANCE}
    return Reference(
        name,
        METHOD.format(shapes="the modal data"),
        tolerances,
        {},
        {name: as_bytes(table) for name, table in tables},
    )


def _results(modes: ClosedForm, inertias: list[float]) -> tuple[Table, Table]:
    """The exponential of the whole modal system, apart from the block's own equations.

    inertias: mass or inertia of each rigid mode.
    """
    start = np.zeros(2 * len(modes.w))
    motion = [modes.after(start, LOADS, {}, duration) for duration in TIMES]
    q, qd = np.hsplit(np.array(motion), 2)
    qdd = modes.on_modes(LOADS) - 2 * modes.zeta * modes.w * qd - modes.w**2 * q
    results: Table = {"time": TIMES}
    for point, shape in modes.shapes.items():
        rows = MOTIONS if point in ENDS else DIRECTIONS
        for names, coordinates in zip(motion_names(rows), (q, qd, qdd), strict=True):
            columns = (coordinates @ shape.T).T
            results |= {f"{point}.{n}": column for n, column in zip(names, columns, strict=True)}
    for i, name in enumerate(("y", "z", "roll", "yaw", "pitch")):
        results[f"cg.{name}"] = q[:, i] / inertias[i] ** 0.5
    for i, name in enumerate(("ay", "az")):
        results[f"cg.{name}"] = qdd[:, i] / inertias[i] ** 0.5
    for i in range(len(modes.w)):
        results |= {f"q[{i + 1}]": q[:, i], f"qd[{i + 1}]": qd[:, i]}
    return held(LOADS), results


EXPERIMENT = Experiment(
    Carbody,
    METHOD.format(shapes="the beam's shape"),
    TOLERANCE,
    _solve,
    exchange_tolerance=EXCHANGE_TOLERANCE,
)
