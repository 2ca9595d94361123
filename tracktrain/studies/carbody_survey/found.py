"""From transfer functions to modes: which were to be seen, and what the survey found of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from fmus.carbody.modal_data import ModalData
from structures.single_mode import fit
from structures.springs import RIGID, Array, OnSprings, free_modes, on_springs

from ..common.ringdown import oscillation
from .rig import AIR_DAMPING, DWELL, INSIDE, STEP, VECTORS, AirSprings, Shakers

SEARCHED = 0.2
"""A mode is sought within this share of the frequency that is expected."""


@dataclass(frozen=True)
class Sought:
    """A mode that the survey is to find: its number and frequency [Hz] on the air springs, as the
    free body's mode that it is made of most calls it, and the shakers that move it most purely."""

    name: str
    coordinate: str
    frequency: float
    shakers: Shakers


@dataclass(frozen=True)
class Found:
    """What the survey found of a mode: frequency [Hz], damping ratio in the decay, rows at the
    plates (8,) for unit modal mass, and the decay that was recorded."""

    mode: Sought
    frequency: float
    damping: float
    rows: Array
    decay: xr.DataArray


def sought(data: ModalData, springs: AirSprings) -> list[Sought]:
    """The modes of a body on its springs that lie in the sweep."""
    air = on_springs(data, springs.matrix)
    return [
        Sought(
            f"{name} on air" if name in RIGID else name.replace("_", " "),
            name,
            float(air.frequencies[i]),
            _purest(air, i),
        )
        for i in range(len(air.frequencies))
        if INSIDE[0] < air.frequencies[i] < INSIDE[1]
        for name in (air.coordinate(i),)
    ]


def _purest(air: OnSprings, mode: int) -> Shakers:
    """The force vector whose quadrature at the mode's frequency is the mode's own most of all."""
    f = air.frequencies
    w = f[mode]
    dynamic = w**2 / np.abs(f**2 - w**2 + 2j * AIR_DAMPING * f * w)

    def purity(shakers: Shakers) -> float:
        answers = (air.rows @ shakers.vector) ** 2 * dynamic
        return float(answers[mode] / max(answers.sum(), 1e-300))

    return max(VECTORS, key=purity)


def mode_of(transfer: xr.Dataset, mode: Sought) -> tuple[float, Array]:
    """Frequency [Hz] and rows at the plates (8,) for unit modal mass, from transfer functions.

    The mode stands where the imaginary part of what the shakers work on peaks. There it moves by
    phi_a (phi^T f); the shakers' own motion f^T phi (phi^T f) tells the size of phi.
    """
    vector = mode.shakers.vector
    functions = np.stack([transfer[name].values for name in transfer], axis=1)
    frequency = transfer.frequency.values
    height = np.abs((functions @ vector).imag)
    near = np.abs(frequency - mode.frequency) < SEARCHED * mode.frequency
    peak = int(np.where(near, height, 0.0).argmax())
    fitted = fit(frequency, functions, peak)
    own = float(vector @ fitted.residues)
    return fitted.frequency, fitted.residues / np.sqrt(abs(own))


def damping_of(trace: xr.DataArray, frequency: float) -> float:
    """Damping ratio from the decay after the dwell."""
    silent = trace.sel(time=slice(DWELL + 2 * STEP, None))
    return oscillation(silent.time.values, silent.values, frequency).damping


def free_of_springs(found: Sequence[Found], springs: AirSprings) -> Mapping[str, float]:
    """Frequency without the air springs [Hz] of each elastic mode, from all that were found."""
    rows = np.array([f.rows for f in found])
    frequencies, shapes = free_modes(np.array([f.frequency for f in found]), rows, springs.matrix)
    return {
        f.mode.name: float(frequencies[np.abs(shapes[:, i]).argmax()])
        for i, f in enumerate(found)
        if f.mode.coordinate not in RIGID
    }
