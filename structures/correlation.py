"""Test against analysis: modal assurance criterion, pairs by shape, frequencies side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from fmus.carbody.modal_data import ModalData, Point

from .errors import StructureError
from .survey import Survey

Array = NDArray[np.float64]

ARM = 1.5
"""A rotation counts as the translation that it makes at this distance [m], half a car's width."""

NEAR = 0.25
"""A sensor is taken to sit on the point of the model that is no further off than this [m]."""

LEAST = 3
"""Sensors' directions that a shape needs: any two shapes of one number are alike."""


@dataclass(frozen=True, eq=False)
class Correlation:
    """assurance: (modes of the test, modes of the analysis), 0 to 1.

    pairs: (test, analysis), numbers of modes from 0, in the test's order.
    """

    survey: Survey
    data: ModalData
    assurance: Array
    pairs: tuple[tuple[int, int], ...]


def modal_assurance(test: Array, analysis: Array) -> Array:
    """Modal assurance criterion of shapes (modes, directions), which may be complex.

    |a^H b|^2/((a^H a)(b^H b)): 1 for the same shape, 0 for shapes without any likeness. Allemang
    and Brown, A correlation coefficient for modal vector analysis, 1st International Modal Analysis
    Conference, 1982; Allemang, The modal assurance criterion, Sound and Vibration, August 2003.
    """
    products = np.abs(test.conj() @ analysis.T) ** 2
    sizes = [np.sum(np.abs(shapes) ** 2, axis=1) for shapes in (test, analysis)]
    return products / np.maximum(np.outer(*sizes), np.finfo(float).tiny)


def pairs_by_shape(assurance: Array) -> tuple[tuple[int, int], ...]:
    """Modes of test and analysis that belong together: the pairs of the largest sum of assurance.

    A mode has one partner at most, whatever the order of the frequencies.
    """
    rows, columns = linear_sum_assignment(-assurance)
    return tuple((int(row), int(column)) for row, column in zip(rows, columns, strict=True))


def correlate(survey: Survey, data: ModalData) -> Correlation:
    """The survey's modes against those of the analysis, where there were sensors.

    Raises StructureError for sensors that sit on no point of the analysis, or are too few.
    """
    places = [_place(survey, point, data) for point in survey.points]
    scale = np.array([1.0, 1.0, 1.0, ARM, ARM, ARM])
    measured = survey.shapes * scale
    analysis = (data.shapes[:, places] * scale).reshape(len(data.modes), -1)
    rows = []
    for mode, shape in zip(survey.modes, measured.reshape(len(survey.modes), -1), strict=True):
        known = np.isfinite(shape)
        if known.sum() < LEAST:
            raise StructureError(
                f"{survey.name}: mode {mode.name} was measured in {known.sum()} direction(s); a "
                f"comparison of shapes needs {LEAST} at least"
            )
        rows.append(modal_assurance(shape[None, known], analysis[:, known])[0])
    assurance = np.array(rows).reshape(len(survey.modes), len(data.modes))
    return Correlation(survey, data, assurance, pairs_by_shape(assurance))


def _place(survey: Survey, point: Point, data: ModalData) -> int:
    """The number of the analysis' point of the same name, else of the nearest one."""
    names = [other.name for other in data.points]
    if point.name in names:
        return names.index(point.name)
    place = point.position
    if not np.isfinite(place).all():
        raise StructureError(
            f"{survey.name}: the sensor {point.name} has no place, and {data.name} has no point of "
            f"that name; give at_x, at_y, at_z [m] from the centre of gravity (in a Universal file "
            "datasets 15 or 2411), or a name that the analysis has, such as "
            f"{', '.join(names[:6])}"
        )
    distances = np.linalg.norm([other.position - place for other in data.points], axis=1)
    nearest = int(distances.argmin())
    if distances[nearest] > NEAR:
        raise StructureError(
            f"{survey.name}: the sensor {point.name} at {_at(place)} sits on no point of "
            f"{data.name}; the nearest, {names[nearest]} at {_at(data.points[nearest].position)}, "
            f"is {distances[nearest]:.2g} m off ({NEAR:g} m may be); places are measured from the "
            "centre of gravity, X forward, Y left, Z up"
        )
    return nearest


def _at(place: Array) -> str:
    return f"({', '.join(f'{value:.2f}' for value in place)}) m"
