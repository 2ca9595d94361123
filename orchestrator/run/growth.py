"""Whose outputs made a system grow without bound: seldom the one whose number overflows first."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..plan.plan import Plan

GROWN = 1e6
"""Size of an output over its size in the first half of the rows, at which it has grown."""

LARGEST = 1e140
"""Largest numbers whose products are still finite."""


def source_of_growth(plan: Plan, rows: NDArray[np.float64]) -> str | None:
    """The instance that others followed, or that fed energy into the system; None: not known.

    rows: of the record, shape (n, columns), finite, of which the last are those before the end.
    An instance that grew, and that none that grew drives, is where it began. Where instances that
    grew drive each other, the work of each on the others over their power bonds tells: what is
    passive takes energy up.
    """
    grown = _grown(plan, rows)
    driven = {k.target for k in plan.links if {k.source, k.target} <= grown}
    first = [instance for instance in grown if instance not in driven]
    if len(first) == 1:
        return plan.names[first[0]]
    given = _energy_given(plan, rows)
    most = max(given, key=lambda instance: given[instance], default=None)
    if most is None or given[most] <= 0.0:
        return None
    return plan.names[most]


def _grown(plan: Plan, rows: NDArray[np.float64]) -> set[int]:
    """Instances with an output that has grown, about as far as any."""
    if len(rows) < 4:
        return set()
    size = np.abs(rows)
    half = len(rows) // 2
    begun = np.argmax(size > 0.0, axis=0)
    before = np.maximum(size[:half].max(axis=0), size[begun, np.arange(size.shape[1])])
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = np.nan_to_num(np.log10(size[-1]) - np.log10(before), nan=0.0, neginf=0.0)
    enough = max(math.log10(GROWN), decades.max() / 2.0)
    return {i for (i, _), own in zip(plan.columns, decades, strict=True) if own >= enough}


def _energy_given(plan: Plan, rows: NDArray[np.float64]) -> dict[int, float]:
    """What each instance gave to the others over its bonds, in steps times watts, to any scale."""
    given: dict[int, float] = {}
    rows = rows[(np.abs(rows) < LARGEST).all(axis=1)]
    for bond in plan.bonds:
        force = rows[:, plan.column_of[bond.force.source, bond.force.output.name]]
        speed = rows[:, plan.column_of[bond.velocity.source, bond.velocity.output.name]]
        work = float(np.sum(bond.force.gain * force * speed))
        given[bond.force.source] = given.get(bond.force.source, 0.0) + work
        given[bond.velocity.source] = given.get(bond.velocity.source, 0.0) - work
    return given
