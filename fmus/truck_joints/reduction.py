"""From the joints to the six deflection shapes of the analog. Report section 4.2.3."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from ..describe.block import Signals
from ..describe.variables import Values
from ..truck.mass import body_motions
from ..truck.ports import ELEMENTS as SHAPES
from .bodies import ELEMENTS, KEPT, kept_columns, strain_matrix

RIGID = ("adapter_longitudinal", "adapter_lateral", "bolster_end_longitudinal")
"""Joint directions that the six shapes do not strain: as these stiffen, the fourteen coordinates
become six."""

KINDS = ("stiffness", "stop_stiffness", "friction_stiffness", "friction_limit", "free_play")


def shapes(p: Signals) -> ca.SX:
    """Phi (14, 6): the coordinates over the six. # report (4-29), erratum 12"""
    motions = body_motions(p)
    rows = [[motions[coordinate][1].get(i, 0) for i in range(6)] for coordinate in KEPT]
    return ca.sparsify(ca.blockcat(rows))


def coordinates_by_strain(p: Signals) -> ca.SX:
    """The six coordinates (6, 6) over the strains of the analog's elements, the carbody at rest."""
    length = p["half_wheelbase"]
    return ca.vertcat(
        ca.horzcat(1, -length, 0, 0, -1, -length),
        *(ca.DM.eye(6)[i, :] for i in (1, 2, 5, 4, 3)),
    )


def shares(p: Signals) -> ca.SX:
    """Strains of the joints' elements (22, 6) over those of the analog's six.

    Its transpose turns the joints' forces to those of the analog's elements. # report (4-30) to
    (4-35)
    """
    rows = strain_matrix(p)[:, kept_columns()] @ shapes(p) @ coordinates_by_strain(p)
    for i, element in enumerate(ELEMENTS):
        if element.parameters in RIGID:
            rows[i, :] = ca.SX(1, 6)  # what cancels there: nothing, not a rounding error
    return ca.sparsify(rows)


def analog(values: Values) -> dict[str, dict[str, float]]:
    """K0, K1, Kf, f and Delta [SI] of the six elements that equal joints make, by their names.

    Those that a shape strains are strained alike, so that they reach stop and slip together.
    """
    numbers = {name: ca.SX(value) for name, value in values.items()}
    rows = np.array(ca.evalf(ca.densify(shares(numbers))))
    found = {}
    for i, shape in enumerate(SHAPES):
        strained = [
            (float(abs(row[i])), e.parameters) for row, e in zip(rows, ELEMENTS, strict=True)
        ]
        strained = [(share, name) for share, name in strained if share]

        def total(kind: str, power: int, parts: Sequence[tuple[float, str]] = strained) -> float:
            return sum(share**power * values[f"{name}.{kind}"] for share, name in parts)

        found[shape] = {
            **{kind: total(kind, 2) for kind in KINDS[:3]},
            "friction_limit": total("friction_limit", 1),
            "free_play": min(values[f"{name}.free_play"] / share for share, name in strained),
        }
    return found


def projection(p: Signals) -> ca.SX:
    """Six coordinates (6, 14) out of fourteen, whatever the joints let slip.

    Trailing axle lateral, mean yaw of the axles, bolster roll, mean yaw of the side frames less
    that, bolster lateral less the mean of the side frames, bolster vertical. Times Phi it is one.
    """
    rows = [
        {("trailing_axle", "y"): 1.0},
        {("trailing_axle", "yaw"): 0.5, ("leading_axle", "yaw"): 0.5},
        {("bolster", "roll"): 1.0},
        {
            **{(f"{side}_frame", "yaw"): 0.5 for side in ("left", "right")},
            **{(f"{end}_axle", "yaw"): -0.5 for end in ("leading", "trailing")},
        },
        {("bolster", "y"): 1.0, **{(f"{side}_frame", "y"): -0.5 for side in ("left", "right")}},
        {("bolster", "z"): 1.0},
    ]
    matrix = ca.SX(6, len(KEPT))
    for i, row in enumerate(rows):
        for coordinate, factor in row.items():
            matrix[i, KEPT.index(coordinate)] = factor
    return matrix
