"""The modes of a free structure: six rigid ones exactly, elastic ones by Lanczos."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix, issparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from .assembled import Structure, rigid_motions
from .errors import StructureError
from .model import Array
from .rigid import check_free, listed, mass_properties

SHIFT = 1.0
"""Frequency [Hz] whose negative square K is shifted by, so that it can be factored."""

SINGULAR = 1e-14
"""Stiffness over that of one degree of freedom alone, below which there is none."""

MASSLESS = 1e-13
"""Inverse square of a frequency over the largest one, below which a motion has no mass."""

NONE = 0.01
"""Frequency [Hz] below which a motion counts as one without stiffness."""


@dataclass(frozen=True, eq=False)
class FreeModes:
    """frequencies (modes,) [Hz], growing; shapes (degrees, modes) for unit modal mass."""

    frequencies: Array
    shapes: Array
    rigid: Array


def rigid_modes(structure: Structure) -> Array:
    """Six rigid motions, orthogonal and of unit modal mass, (degrees, 6).  # report (3-25)"""
    motions = rigid_motions(structure.positions, structure.positions.mean(axis=0))
    return _orthonormal(motions, structure.mass)


def free_modes(structure: Structure, count: int = 10) -> FreeModes:
    """The lowest elastic modes.  # report (3-20) to (3-26)

    K plus a part of M is factored once; Lanczos on its inverse. Elastic modes are made orthogonal
    to the rigid ones, and to each other. Raises StructureError for a mechanism, for a structure
    without mass, and for a negative stiffness.
    """
    mass_properties(structure)
    check_free(structure)
    rigid = rigid_modes(structure)
    stiffness, mass = structure.stiffness, structure.mass
    shift = (2 * pi * SHIFT) ** 2
    wanted = min(count + 6, structure.degrees - 2)
    if issparse(stiffness) and structure.degrees > max(400, 3 * wanted):
        squared, vectors = _lanczos(structure, shift, wanted)
    else:
        squared, vectors = _dense(stiffness, mass, structure, shift)
    _check(structure, squared, vectors)
    elastic = vectors[:, 6 : count + 6]
    elastic = elastic - rigid @ (rigid.T @ (mass @ elastic))
    elastic = _orthonormal(elastic, mass)
    small = elastic.T @ (stiffness @ elastic)
    own, turn = np.linalg.eigh((small + small.T) / 2)
    shapes = elastic @ turn
    return FreeModes(np.sqrt(np.maximum(own, 0.0)) / (2 * pi), shapes, rigid)


def factored(matrix: csc_matrix) -> Any:
    """A symmetric positive matrix factored in an order that keeps it sparse."""
    return splu(
        csc_matrix(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def _lanczos(structure: Structure, shift: float, count: int) -> tuple[Array, Array]:
    stiffness, mass = structure.stiffness, structure.mass
    total = csc_matrix(stiffness + shift * mass)
    own = total.diagonal()
    bare = np.flatnonzero(own == 0.0)
    if len(bare):
        raise _loose(structure, bare)
    try:
        # without pivoting the factor's diagonal has the signs of the eigenvalues (Sylvester)
        factor = factored(total)
    except RuntimeError:  # exactly singular, at no degree of freedom in particular
        raise _loose(structure, ()) from None
    pivots = factor.U.diagonal()[factor.perm_c] / np.abs(own)
    lost = np.flatnonzero(np.abs(pivots) < SINGULAR)
    if len(lost):
        raise _loose(structure, lost)
    if pivots.min() < 0:
        raise _negative(structure, structure.label(int(pivots.argmin())))
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve)
    start = np.random.default_rng(1980).standard_normal(stiffness.shape[0])
    squared, vectors = eigsh(stiffness, count, mass, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(squared)
    return squared[order], vectors[:, order]


def _dense(stiffness: Any, mass: Any, structure: Structure, shift: float) -> tuple[Array, Array]:
    """Of M over K + s M, which may have motions without mass: they are no modes."""
    k, m = (a.toarray() if issparse(a) else np.asarray(a) for a in (stiffness, mass))
    m = (m + m.T) / 2
    total = (k + k.T) / 2 + shift * m
    # in units of its diagonal, so that stiff and soft motions are told apart alike
    own = np.abs(np.diag(total))
    size = 1 / np.sqrt(np.maximum(own, 1e-14 * own.max()))
    scaled = total * np.outer(size, size)
    least, vectors = eigh(scaled, subset_by_index=[0, 0])
    if least[0] < -SINGULAR:
        raise _negative(structure, _where(structure, size * vectors[:, 0]))
    if least[0] < SINGULAR:
        raise _loose(structure, _largest(size * vectors[:, 0]))
    share, vectors = eigh(m * np.outer(size, size), scaled)
    moved = share > MASSLESS * share[-1]
    share, vectors = share[moved][::-1], vectors[:, moved][:, ::-1]
    return 1 / share - shift, size[:, None] * vectors / np.sqrt(share)


def _check(structure: Structure, squared: Array, vectors: Array) -> None:
    none = max((2 * pi * NONE) ** 2, 1e-10 * float(np.abs(squared).max()))
    negative = squared < -none
    if negative.any():
        which = int(np.argmin(squared))
        raise _negative(structure, _where(structure, vectors[:, which]))
    zero = int(np.count_nonzero(np.abs(squared) <= none))
    if zero > 6:
        rigid = rigid_modes(structure)
        loose = vectors[:, :zero]
        loose = loose - rigid @ (rigid.T @ (structure.mass @ loose))
        worst = loose[:, int(np.argmax(np.linalg.norm(loose, axis=0)))]
        raise StructureError(
            f"{structure.name} is a mechanism: {zero - 6} motions beside the six rigid ones meet "
            f"no stiffness, among them one of {_where(structure, worst)}; connect it"
        )
    if zero < 6:
        raise StructureError(
            f"{structure.name} has {zero} rigid motions; a free carbody has six: take off what "
            "holds it to the ground"
        )


def _loose(structure: Structure, degrees: Iterable[int]) -> StructureError:
    names = [structure.label(int(degree)) for degree in degrees]
    return StructureError(
        f"{structure.name} is a mechanism: motions meet neither stiffness nor mass"
        f"{', ' + listed(names) if names else ''}; connect them to more than bars"
    )


def _negative(structure: Structure, where: str) -> StructureError:
    return StructureError(
        f"{structure.name}: the stiffness is negative in a motion of {where}; a structure cannot "
        "push itself"
    )


def _where(structure: Structure, shape: Array) -> str:
    return listed([structure.label(degree) for degree in _largest(shape)])


def _largest(shape: Array) -> list[int]:
    order = np.argsort(-np.abs(shape))
    return [int(d) for d in order[:3] if abs(shape[d]) > 0.3 * abs(shape[order[0]])]


def _orthonormal(vectors: Any, mass: Any) -> Array:
    """Combinations of the vectors of unit modal mass, each square to the others in M."""
    for _ in range(2):
        own = vectors.T @ (mass @ vectors)
        vectors = np.linalg.solve(np.linalg.cholesky((own + own.T) / 2), vectors.T).T
    return vectors
