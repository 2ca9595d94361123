"""From a structure and its free modes to a carbody's modal data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import pi

import numpy as np

from fmus.carbody.default_data import shapes_at
from fmus.carbody.modal_data import ENDS, PLATE_LOADS, Body, ModalData, Mode, Point

from .assembled import Structure
from .correlation import modal_assurance
from .errors import StructureError
from .free_modes import SHIFT, FreeModes, factored
from .model import Array
from .rigid import mass_properties

FAMILIES = ("torsion", "lateral bending", "vertical bending")
"""Names of the modes that look most like a beam's first ones."""

LIKE = 0.3
"""Assurance that a mode needs to be called by a family's name."""

DAMPING = 0.015
"""Damping ratio of modes that were computed: that of the default carbody, an estimate."""

LOADS = (1, 2, 3, 5)
"""Degrees of freedom of a plate that `PLATE_LOADS` work on."""


def modal_data(
    structure: Structure,
    modes: FreeModes,
    source: str,
    damping: float = DAMPING,
    provenance: Sequence[str] = (),
) -> ModalData:
    """Modal data of a structure whose places `front` and `rear` are the centre plates.

    All nodes are points, called n and their number; further places keep their names, and are
    outputs. The flexibility of all further modes is the residual. Raises StructureError without
    centre plates.
    """
    missing = [end for end in ENDS if end not in structure.places]
    if missing:
        raise StructureError(
            f"{structure.name}: no node is the centre plate {' or '.join(missing)}; name its node "
            f"(places: {', '.join(structure.places) or 'none'})"
        )
    properties = mass_properties(structure)
    positions = structure.positions - properties.centre
    named = {index: name for name, index in structure.places.items()}
    points = tuple(
        Point(named.get(i, f"n{number}"), *map(float, position))
        for i, (number, position) in enumerate(zip(structure.numbers, positions, strict=True))
    )
    shapes = modes.shapes.T.reshape(len(modes.frequencies), len(points), 6)
    roll, pitch, yaw = (float(inertia) for inertia in np.diag(properties.inertia))
    body = Body(properties.mass, roll, pitch, yaw, "derived", source)
    data = ModalData(
        structure.name,
        body,
        tuple(
            Mode(f"mode {number}", float(frequency), damping, "derived", source)
            for number, frequency in enumerate(modes.frequencies, start=1)
        ),
        points,
        shapes,
        tuple(name for name in structure.places if name not in ENDS),
        edges=_edges(structure, [point.name for point in points]),
        residual_flexibility=residual_flexibility(structure, modes),
        provenance=tuple(provenance),
    )
    return _named(data)


def residual_flexibility(structure: Structure, modes: FreeModes) -> Array:
    """Static flexibility at the plates of all modes above those given, (8, 8), `PLATE_LOADS`.

    (K + s M)^-1 is the sum of phi phi^T/(w^2 + s) over all modes; what rigid and given ones have
    of it is taken off. s is far below the modes that are left, so that it does not count there.
    """
    shift = (2 * pi * SHIFT) ** 2
    degrees = [6 * structure.places[end] + d for end in ENDS for d in LOADS]
    loads = np.zeros((structure.degrees, len(PLATE_LOADS)))
    loads[degrees, range(len(degrees))] = 1.0
    factor = factored(structure.stiffness + shift * structure.mass)
    whole = factor.solve(loads)[degrees]
    rigid, elastic = modes.rigid[degrees], modes.shapes[degrees]
    w = 2 * pi * modes.frequencies
    left = whole - rigid @ rigid.T / shift - elastic / (w**2 + shift) @ elastic.T
    return _not_negative((left + left.T) / 2)


def _not_negative(matrix: Array) -> Array:
    """The matrix without what rounding makes negative."""
    size = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    return (vectors * np.maximum(values, 0.0)) @ vectors.T * np.outer(size, size)


def _named(data: ModalData) -> ModalData:
    """Modes that are most like a beam's torsion and bending are called so."""
    x = np.array([point.x for point in data.points])
    values = {
        "body_mass": data.body.mass, "roll_inertia": data.body.roll_inertia,
        "half_truck_spacing": data.half_truck_spacing, "body_length": float(np.ptp(x)),
        "torsion_shape": 1.0,
    }  # fmt: skip
    beam = np.stack([shapes_at(values, point) for point in data.points], axis=1)[:, :, :3]
    own = data.shapes[:, :, :3].reshape(len(data.modes), -1)
    assurance = modal_assurance(own, beam.reshape(len(FAMILIES), -1))
    modes = list(data.modes)
    for family, column in zip(FAMILIES, assurance.T, strict=True):
        most = int(column.argmax())
        if column[most] >= LIKE:
            modes[most] = replace(modes[most], name=family)
    return replace(data, modes=tuple(modes))


def _edges(structure: Structure, names: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """The sides of all elements, each once."""
    sides: dict[tuple[int, int], None] = {}
    for _, nodes in structure.faces:
        ring = (*nodes, nodes[0]) if len(nodes) > 2 else nodes
        for a, b in pairwise(ring):
            sides[min(a, b), max(a, b)] = None
    return tuple((names[a], names[b]) for a, b in sides)
