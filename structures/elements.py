"""Stiffness and mass of a model's elements, by pyfe3d.

Thin shells Quad4 and Tria3R, beams BeamC, bars Truss: each puts its matrices in global axes, six
degrees of freedom a node. All of them are added up.  # report (3-7), (3-8)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from pyfe3d import (
    BeamC,
    BeamCData,
    BeamCProbe,
    Quad4,
    Quad4Data,
    Quad4Probe,
    Tria3R,
    Tria3RData,
    Tria3RProbe,
    Truss,
    TrussData,
    TrussProbe,
)
from pyfe3d.beamprop import BeamProp
from pyfe3d.shellprop_utils import isotropic_plate
from scipy.linalg import block_diag
from scipy.sparse import coo_matrix, csc_matrix

from .assembled import Structure, rigid_motions
from .model import Array, Beam, Element, Ints, Model, Plate, rigid_arm

CLASSES = {
    "quad": (Quad4, Quad4Data, Quad4Probe),
    "triangle": (Tria3R, Tria3RData, Tria3RProbe),
    "beam": (BeamC, BeamCData, BeamCProbe),
    "bar": (Truss, TrussData, TrussProbe),
}
CONSISTENT = 0
SHEAR_FACTOR = 5 / 6
"""Of the transverse shear of a plate, over its thickness."""

SEGMENTS = 8
"""Uniform pieces that a tapered beam is made of."""

TURNING = 1e-6
"""Stiffness of a bar in turning its ends alike [N.m/rad], over E A times its length."""


def assembled(model: Model) -> Structure:
    """Stiffness and consistent mass of all elements, and the masses on nodes."""
    size = 6 * len(model.numbers)
    parts = {"K": _Triplets(size), "M": _Triplets(size)}
    for element in model.elements:
        section = model.sections[element.section]
        places = [model.index[node] for node in element.nodes]
        corners = model.corners(element)
        if isinstance(section, Beam) and section.end is not None:
            stiffness, mass = _tapered(element, section, corners)
        else:
            stiffness, mass = matrices(element, section, corners)
        if element.offsets:
            arms = block_diag(*map(rigid_arm, element.offsets))
            stiffness, mass = arms.T @ stiffness @ arms, arms.T @ mass @ arms
        degrees = np.add.outer(6 * np.array(places), np.arange(6)).ravel()
        parts["K"].add(degrees, stiffness)
        parts["M"].add(degrees, mass)
    for degrees, stiffness in _turning(model):
        parts["K"].add(degrees, stiffness)
    for one in model.masses:
        degrees = 6 * model.index[one.node] + np.arange(6)
        parts["M"].add(degrees, one.matrix)
    return Structure(
        model.name,
        parts["K"].matrix(),
        parts["M"].matrix(),
        model.numbers,
        model.positions,
        {name: model.index[node] for name, node in model.places.items()},
        [(e.part, tuple(model.index[n] for n in e.nodes)) for e in model.elements],
    )


def _turning(model: Model) -> Iterator[tuple[Any, Any]]:
    """Springs that turn a node that only bars hold with its neighbours: it would turn freely.

    They are weak, and meet no force in a rigid motion.
    """
    held = {n for e in model.elements if e.kind != "bar" for n in e.nodes}
    for element in model.elements:
        if element.kind == "bar" and not held.issuperset(element.nodes):
            section = model.sections[element.section]
            assert isinstance(section, Beam)
            length = float(np.linalg.norm(np.subtract(*model.corners(element))))
            spring = TURNING * section.material.young * section.area * length
            degrees = np.add.outer([6 * model.index[n] for n in element.nodes], np.arange(3, 6))
            yield degrees.ravel(), spring * np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(3))


def matrices(element: Element, section: Plate | Beam, corners: Array) -> tuple[Array, Array]:
    """Stiffness and consistent mass of an element of uniform section, in global axes."""
    kind, sizes, probe_type = CLASSES[element.kind]
    probe, size = probe_type(), sizes()
    own: Any = kind(probe)
    count = len(corners)
    for n in range(count):
        setattr(own, f"n{n + 1}", n)
        setattr(own, f"c{n + 1}", 6 * n)
    own.init_k_KC0 = own.init_k_M = 0
    flat = np.ascontiguousarray(corners, float).ravel()
    if element.kind == "beam":
        own.update_rotation_matrix(*_second_axis(element, corners), flat)
    else:
        own.update_rotation_matrix(flat)
    own.update_probe_xe(flat)
    prop = _shell(section) if isinstance(section, Plate) else _beam(section)
    found = []
    for name, length in (("KC0", size.KC0_SPARSE_SIZE), ("M", size.M_SPARSE_SIZE)):
        rows, columns = (np.zeros(length, np.dtype("long")) for _ in range(2))
        values = np.zeros(length)
        update = getattr(own, f"update_{name}")
        if name == "M":
            update(rows, columns, values, prop, mtype=CONSISTENT)
        else:
            update(rows, columns, values, prop)
        whole = coo_matrix((values, (rows, columns)), (6 * count, 6 * count)).toarray()
        found.append((whole + whole.T) / 2)
    stiffness, mass = found
    if isinstance(section, Plate) and count == 4:
        stiffness = _free(stiffness + _tied_shear(section, corners), corners)
    return stiffness, mass


def _tied_shear(section: Plate, corners: Array) -> Array:
    """Stiffness of what transverse shear has of linear parts in a quadrilateral, (24, 24).

    Quad4 takes the shear at the middle, which leaves two motions of a plate without stiffness. The
    linear parts follow from the shear along opposite sides, tied at their middles, and vanish in
    any constant curvature (Bathe and Dvorkin, A four-node plate bending element, International
    Journal for Numerical Methods in Engineering 21, 1985, 367-383).
    """
    across = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    area = float(np.linalg.norm(across)) / 2
    if section.thickness**2 >= area:  # Quad4 takes the shear in full
        return np.zeros((24, 24))
    normal = across / np.linalg.norm(across)
    total = np.zeros((24, 24))
    for one, other in (((0, 1), (3, 2)), ((0, 3), (1, 2))):
        lengths = [np.linalg.norm(corners[b] - corners[a]) for a, b in (one, other)]
        linear = _shear_along(corners, normal, *other) - _shear_along(corners, normal, *one)
        linear = linear / float(sum(lengths))
        total += np.outer(linear, linear)
    return SHEAR_FACTOR * section.material.shear * section.thickness * area / 3 * total


def _shear_along(corners: Array, normal: Array, first: int, second: int) -> Array:
    """Shear over a side, times its length, as a row over the degrees of freedom."""
    row, side = np.zeros((4, 6)), corners[second] - corners[first]
    row[second, :3], row[first, :3] = normal, -normal
    row[[first, second], 3:] = -np.cross(side, normal) / 2
    return row.ravel()


def _free(stiffness: Array, corners: Array) -> Array:
    """The stiffness without what rigid motions meet: a warped quadrilateral is taken as flat."""
    span = float(np.ptp(corners, axis=0).max())
    motions, _ = np.linalg.qr(rigid_motions((corners - corners.mean(axis=0)) / span))
    scale = np.tile(np.r_[np.ones(3), np.full(3, 1 / span)], len(corners))
    keep = np.eye(len(scale)) - motions @ motions.T
    back = scale[:, None] * keep / scale
    return back.T @ stiffness @ back


def _second_axis(element: Element, corners: Array) -> Array:
    """A vector in the plane of a beam's axes x and y: y is square to `up` and to the beam."""
    along = corners[1] - corners[0]
    second = np.cross(np.array(element.up, float), along)
    if np.linalg.norm(second) < 1e-6 * np.linalg.norm(along) * np.linalg.norm(element.up):
        second = np.cross([1.0, 0.0, 0.0], along)  # a post: its section's z points along X
    return second / np.linalg.norm(second)


def _tapered(element: Element, section: Beam, corners: Array) -> tuple[Array, Array]:
    """A beam of uniform pieces with the inner nodes condensed.  # report (4-5) to (4-9)"""
    assert section.end is not None
    steps = np.linspace(0.0, 1.0, SEGMENTS + 1)
    points = corners[0] + steps[:, None] * (corners[1] - corners[0])
    size = 6 * (SEGMENTS + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    for n, middle in enumerate((steps[:-1] + steps[1:]) / 2):
        k, m = matrices(element, between(section, float(middle)), points[n : n + 2])
        place = slice(6 * n, 6 * n + 12)
        stiffness[place, place] += k
        mass[place, place] += m
    ends = np.r_[0:6, size - 6 : size]
    inner = np.setdiff1d(np.arange(size), ends)
    shape = np.zeros((size, 12))
    shape[ends] = np.eye(12)
    shape[inner] = -np.linalg.solve(stiffness[np.ix_(inner, inner)], stiffness[np.ix_(inner, ends)])
    return shape.T @ stiffness @ shape, shape.T @ mass @ shape


def between(section: Beam, place: float) -> Beam:
    """The section of a tapered beam at a place from 0 to 1: all its numbers linear."""
    assert section.end is not None
    names = ("area", "second_y", "second_z", "torsion", "further")
    numbers = {
        name: (1 - place) * getattr(section, name) + place * getattr(section.end, name)
        for name in names
    }
    return replace(section, **numbers, end=None)


@cache
def _shell(section: Plate) -> Any:
    m = section.material
    density = m.density + section.further / section.thickness
    return isotropic_plate(section.thickness, m.young, m.poisson, rho=density)


@cache
def _beam(section: Beam) -> Any:
    prop, m = BeamProp(), section.material
    prop.A, prop.E, prop.G = section.area, m.young, m.shear
    prop.Iyy, prop.Izz, prop.J = section.second_y, section.second_z, section.torsion
    prop.G12 = m.shear * (section.shear_y or 1.0)
    prop.G13 = m.shear * (section.shear_z or 1.0)
    prop.GJ = m.shear * section.torsion
    density = m.density + section.further / section.area
    prop.intrho = density * section.area
    prop.intrhoy2, prop.intrhoz2 = density * section.second_z, density * section.second_y
    return prop


class _Triplets:
    """Rows, columns and values of a sum of small matrices."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._parts: list[tuple[Ints, Ints, Array]] = []

    def add(self, degrees: Ints, matrix: Array) -> None:
        rows, columns = np.meshgrid(degrees, degrees, indexing="ij")
        self._parts.append((rows.ravel(), columns.ravel(), matrix.ravel()))

    def matrix(self) -> csc_matrix:
        rows, columns, values = (np.concatenate(part) for part in zip(*self._parts, strict=True))
        total = coo_matrix((values, (rows, columns)), (self._size, self._size)).tocsc()
        total.eliminate_zeros()
        return total


def parts_of(model: Model) -> Iterator[tuple[str, float, Array]]:
    """Part, mass [kg] and centre [m] of each element and mass, from areas and lengths alone."""
    for element in model.elements:
        section, corners = model.sections[element.section], model.corners(element)
        if isinstance(section, Plate):
            weight = section.material.density * section.thickness + section.further
            for triangle in _triangles(corners):
                area = float(np.linalg.norm(np.cross(*(triangle[1:] - triangle[0])))) / 2
                yield element.part, weight * area, triangle.mean(axis=0)
        else:
            for n in range(SEGMENTS):
                place = (n + 0.5) / SEGMENTS
                own = between(section, place) if section.end is not None else section
                weight = own.material.density * own.area + own.further
                length = float(np.linalg.norm(corners[1] - corners[0])) / SEGMENTS
                centre = corners[0] + place * (corners[1] - corners[0])
                yield element.part, weight * length, centre
    for mass in model.masses:
        yield mass.part, mass.mass, model.positions[model.index[mass.node]] + mass.offset


def _triangles(corners: Array) -> list[Array]:
    return [corners] if len(corners) == 3 else [corners[[0, 1, 2]], corners[[0, 2, 3]]]
