"""The modes of a free structure: six rigid ones exactly, elastic ones by Lanczos."""

from __future__ import annotations

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
    if issparse(stiffness) and structure.degrees > 400:
        squared, vectors = _lanczos(structure, shift, wanted)
    else:
        squared, vectors = _dense(stiffness, mass, structure)
    _check(structure, squared, vectors)
    elastic = vectors[:, 6 : count + 6]
    elastic = elastic - rigid @ (rigid.T @ (mass @ elastic))
    elastic = _orthonormal(elastic, mass)
    small = elastic.T @ (stiffness @ elastic)
    own, turn = np.linalg.eigh((small + small.T) / 2)
    shapes = elastic @ turn
    return FreeModes(np.sqrt(np.maximum(own, 0.0)) / (2 * pi), shapes, rigid)


def _lanczos(structure: Structure, shift: float, count: int) -> tuple[Array, Array]:
    stiffness, mass = structure.stiffness, structure.mass
    # without pivoting the factor's diagonal has the signs of the eigenvalues (Sylvester)
    whole = csc_matrix(stiffness + shift * mass)
    try:
        factor = splu(
            whole,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # exactly singular
        bare = [structure.label(int(d)) for d in np.flatnonzero(whole.diagonal() == 0)]
        raise StructureError(
            f"{structure.name} is a mechanism: motions meet neither stiffness nor mass"
            f"{', ' + listed(bare) if bare else ''}; connect them"
        ) from None
    pivots = factor.U.diagonal()
    if pivots.min() < 0:
        degree = int(np.flatnonzero(factor.perm_c == int(pivots.argmin()))[0])
        raise _negative(structure, structure.label(degree))
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve)
    start = np.random.default_rng(1980).standard_normal(stiffness.shape[0])
    squared, vectors = eigsh(stiffness, count, mass, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(squared)
    return squared[order], vectors[:, order]


def _dense(stiffness: Any, mass: Any, structure: Structure) -> tuple[Array, Array]:
    k, m = (a.toarray() if issparse(a) else np.asarray(a) for a in (stiffness, mass))
    bare = np.linalg.eigvalsh((m + m.T) / 2)
    if bare[0] <= 1e-14 * bare[-1]:
        k, m, back = _without_massless(k, m, structure)
        squared, vectors = eigh(k, m)
        return squared, back @ vectors
    return eigh(k, m)


def _without_massless(k: Array, m: Array, structure: Structure) -> tuple[Array, Array, Array]:
    """Degrees of freedom without mass condensed: they follow the others statically."""
    bare = np.flatnonzero(np.diag(m) <= 1e-14 * np.abs(np.diag(m)).max())
    kept = np.setdiff1d(np.arange(len(k)), bare)
    if not len(bare) or not len(kept):
        raise StructureError(
            f"{structure.name}: its mass matrix has motions without mass; give every part a density"
        )
    back = np.zeros((len(k), len(kept)))
    back[kept] = np.eye(len(kept))
    back[bare] = -np.linalg.solve(k[np.ix_(bare, bare)], k[np.ix_(bare, kept)])
    return back.T @ k @ back, back.T @ m @ back, back


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


def _negative(structure: Structure, where: str) -> StructureError:
    return StructureError(
        f"{structure.name}: the stiffness is negative in a motion of {where}; a structure cannot "
        "push itself"
    )


def _where(structure: Structure, shape: Array) -> str:
    order = np.argsort(-np.abs(shape))
    large = [int(d) for d in order[:3] if abs(shape[d]) > 0.3 * abs(shape[order[0]])]
    return listed([structure.label(d) for d in large])


def _orthonormal(vectors: Any, mass: Any) -> Array:
    """Combinations of the vectors of unit modal mass, each square to the others in M."""
    for _ in range(2):
        own = vectors.T @ (mass @ vectors)
        vectors = np.linalg.solve(np.linalg.cholesky((own + own.T) / 2), vectors.T).T
    return vectors
