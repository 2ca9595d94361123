"""Analysis brought to the survey: stiffness scaled (4-24, 4-25), frequencies replaced."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fmus.carbody.modal_data import ModalData, Mode

from .errors import StructureError


@dataclass(frozen=True)
class ScaleFactors:
    """What the stiffness is multiplied by, in both readings of the report after (4-25).

    squared_mean: square of the mean ratio of test to analysis; Table 4-3 was made with it.
    mean_square: mean of the squared ratios; the formula that is printed.  # erratum 10
    """

    squared_mean: float
    mean_square: float


def scale_factors(test: Sequence[float], analysis: Sequence[float]) -> ScaleFactors:
    """From frequencies of the same modes, in the same order.  # report (4-25)"""
    if len(test) != len(analysis) or not len(test):
        raise StructureError(
            f"{len(test)} frequencies of the test and {len(analysis)} of the analysis make no "
            "ratios; give one of each for every mode"
        )
    ratios = np.asarray(test, float) / np.asarray(analysis, float)
    return ScaleFactors(float(ratios.mean() ** 2), float((ratios**2).mean()))


def scaled(data: ModalData, factor: float) -> ModalData:
    """The structure with its stiffness times a factor: shapes stay, frequencies go with the root.

    (4-24): omega^2 = phi^T K phi.
    """
    if not (np.isfinite(factor) and factor > 0):
        raise StructureError(f"stiffness cannot be scaled by {factor:g}; give a factor above zero")
    flexibility = data.residual_flexibility
    return replace(
        data,
        modes=tuple(replace(m, frequency=m.frequency * factor**0.5) for m in data.modes),
        residual_flexibility=None if flexibility is None else flexibility / factor,
        provenance=(*data.provenance, f"stiffness scaled by {factor:.4g} (report 4-25)"),
    )


def with_measured(data: ModalData, measured: Mapping[str, Mode]) -> ModalData:
    """The data with frequency and damping of the modes named replaced, all shapes kept.

    measured: the mode of the survey, by the name of that of the data. What was done to the loaded
    car (report, below Table 4-3).
    """
    names = [mode.name for mode in data.modes]
    unknown = [name for name in measured if name not in names]
    if unknown:
        raise StructureError(
            f"{data.name} has no mode {', '.join(unknown)} to replace; there are {', '.join(names)}"
        )
    said = [
        f"mode {name}: {data.modes[names.index(name)].frequency:.4g} Hz of the analysis replaced "
        f"by {mode.frequency:.4g} Hz, {mode.source}; shape kept"
        for name, mode in measured.items()
    ]
    modes = tuple(
        replace(measured[mode.name], name=mode.name) if mode.name in measured else mode
        for mode in data.modes
    )
    return replace(data, modes=modes, provenance=(*data.provenance, *said))
