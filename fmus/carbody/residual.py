"""Residual flexibility of the modes that were left out, as modes above all others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import ParameterError
from .modal_data import DIRECTIONS, ENDS, ModalData, Mode

ABOVE, LEAST = 2.5, 100.0
"""Of the residual modes, where nobody says: over the highest of the others, and at least [Hz]."""

NEGLIGIBLE = 1e-9
"""Part of the largest flexibility below which a direction is rigid."""

MOTION_OF_LOAD = [DIRECTIONS.index(name) for name in ("y", "z", "roll", "yaw")]


def with_residual_modes(data: ModalData, frequency: float | None = None) -> ModalData:
    """The residual flexibility G of the data as modes above all others. README (8)

    Modes of unit mass and frequency w_r with shapes R, where R R^T = w_r^2 G, give way by G under
    loads that are slow against w_r. They have mass, so that displacements follow the loads through
    their motion as those of any mode do, no algebraic loop closes at the centre plates, and energy
    is kept. Another split of G into such modes moves the plates alike, since all have w_r.

    frequency: of these modes [Hz], above what matters; their damping is that of the last mode. At
    further points the residual is not known, and these modes do not move them.
    """
    if data.residual_flexibility is None:
        return data
    highest = max((mode.frequency for mode in data.modes), default=0.0)
    chosen = max(ABOVE * highest, LEAST) if frequency is None else frequency
    if not chosen > highest:
        raise ParameterError(
            f"{data.name}: residual modes at {chosen:g} Hz would be among the others, which reach "
            f"{highest:g} Hz; give a frequency above"
        )
    factor = _root(data.residual_flexibility) * 2 * np.pi * chosen
    shapes = np.zeros((factor.shape[1], len(data.points), len(DIRECTIONS)))
    for number, end in enumerate(ENDS):
        rows = factor[4 * number : 4 * number + 4]
        shapes[:, data.index(end), MOTION_OF_LOAD] = rows.T
    ratio = data.modes[-1].damping
    source = f"residual flexibility at {chosen:g} Hz"
    residual = tuple(
        Mode(f"residual {i}", chosen, ratio, "derived", source) for i in range(1, len(shapes) + 1)
    )
    return replace(
        data,
        modes=(*data.modes, *residual),
        shapes=np.concatenate([data.shapes, shapes]),
        residual_flexibility=None,
        provenance=(*data.provenance, f"residual modes at {chosen:g} Hz: {len(residual)}"),
    )


def _root(flexibility: np.ndarray) -> np.ndarray:
    """R with R R^T = G, (8, rank); forces and moments are made comparable first."""
    size = np.sqrt(np.abs(np.diag(flexibility)))
    size[size == 0] = 1.0
    values, vectors = np.linalg.eigh((flexibility + flexibility.T) / 2 / np.outer(size, size))
    kept = values > NEGLIGIBLE * values[-1]
    return size[:, None] * vectors[:, kept] * np.sqrt(values[kept])
