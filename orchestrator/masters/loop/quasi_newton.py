"""Groups of unknowns that are to come out of an evaluation as they went in: x = g(x).

With the residual r = g(x) - x each method goes on to x - B r:
- fixed-point: B = -1;
- aitken: B a multiple of -1, from the last two residuals;
- iqn-ils: B the inverse Jacobian by least squares from all pairs of a step (Degroote 2009);
- broyden: the same, kept from step to step (Bogaers 2014, as the interface Jacobian).
The least squares are done by updates of rank one along directions made orthogonal to the former,
in the metric of the unknowns' scales. A scale is the nominal value of its unknowns, or the
largest that was found of them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...compiled.marks import in_c
from .arrays import Floats, starts
from .unknowns import AITKEN, FIXED_POINT, IQN_ILS, METHODS, MOST_UNKNOWNS, Unknowns

PATIENCE = 30
"""Evaluations after which what is known of the Jacobian is forgotten: it leads nowhere."""

DEPENDENT = 1e-7
"""What is left of a direction, relative, when it has nothing that the former have not."""


def unknowns(
    sizes: Sequence[int],
    method: str,
    scale_of: Sequence[int] | None = None,
    nominal: Sequence[float] = (),
) -> Unknowns:
    """Groups of unknowns; one too large for a matrix is gone through by the fixed point.

    scale_of: by unknown, unknowns of one number share a scale. nominal: by unknown, the least that
    its scale can be.
    """
    first = starts(sizes)
    chosen = METHODS.index(method)
    methods = [
        FIXED_POINT if chosen < AITKEN and size > MOST_UNKNOWNS else chosen for size in sizes
    ]
    squares = [
        size * size if kind < AITKEN else 0 for size, kind in zip(sizes, methods, strict=True)
    ]
    square = starts(squares)
    total = int(first[-1])
    shared = np.arange(total) if scale_of is None else np.asarray(scale_of)
    made = Unknowns(
        first=first,
        square=square,
        method=np.array(methods, np.int64),
        scale_of=shared.astype(np.int64),
        scale=np.zeros(int(shared.max(initial=-1)) + 1),
        value=np.zeros(total),
        residual=np.zeros(total),
        previous_value=np.zeros(total),
        previous_residual=np.zeros(total),
        change=np.zeros(total),
        largest=np.zeros(total),
        inverse=np.zeros(int(square[-1])),
        basis=np.zeros(int(square[-1])),
        state=np.zeros((len(sizes), 4), np.int64),
    )
    np.maximum.at(made.scale, made.scale_of[: len(nominal)], np.asarray(nominal, float))
    for group in range(len(sizes)):
        _forget(made, group)
    return made


@in_c
def _forget(table: Unknowns, group: int) -> None:
    """Begin with the Jacobian of unknowns that do not act on themselves."""
    size = table.first[group + 1] - table.first[group]
    begin, end = table.square[group], table.square[group + 1]
    if begin == end:
        return
    for n in range(begin, end):
        table.inverse[n] = 0.0
    for n in range(size):
        table.inverse[begin + n * (size + 1)] = -1.0


@in_c
def begin_step(table: Unknowns, group: int) -> None:
    """Begin a step whose first values are in `value`."""
    table.state[group, 0] = table.state[group, 1] = 0
    for n in range(table.first[group], table.first[group + 1]):
        table.largest[n] = abs(table.value[n])
    if table.method[group] == IQN_ILS:
        _forget(table, group)


@in_c
def settled(table: Unknowns, group: int, tolerance: float) -> bool:
    """Count an evaluation; whether no residual is above the tolerance, relative to its scale."""
    state = table.state[group]
    state[0] += 1
    state[2] += 1
    state[3] = max(state[3], state[0])
    first, last = table.first[group], table.first[group + 1]
    if state[0] == 1:
        for n in range(first, last):  # of what was zero until now
            if state[2] == 1:
                _enlarge(table, n, table.value[n], True)
            _enlarge(table, n, table.value[n] + table.residual[n], state[2] == 1)
    for n in range(first, last):
        # Negated, so that what is not a number stops here: the row is looked at afterwards.
        if abs(table.residual[n]) > tolerance * _size(table, n):
            return False
    for n in range(first, last):
        _enlarge(table, n, table.value[n], True)
    return True


@in_c
def _enlarge(table: Unknowns, n: int, value: float, known: bool) -> None:
    """Let a scale be at least a value, where it is a first one or from a step that settled."""
    scale = table.scale[table.scale_of[n]]
    if known or scale == 0.0:
        table.scale[table.scale_of[n]] = max(scale, abs(value))


@in_c
def _size(table: Unknowns, n: int) -> float:
    """What a residual is compared with: its scale, or the value where it is larger."""
    return max(table.scale[table.scale_of[n]], abs(table.value[n]))


@in_c
def worst(table: Unknowns, group: int) -> int:
    """The unknown of a group with the largest residual, relative to its scale."""
    first, last = table.first[group], table.first[group + 1]
    found, most = 0, -1.0
    for n in range(first, last):
        size = _size(table, n)
        relative = abs(table.residual[n]) / size if size > 0.0 else 0.0
        if relative > most:
            found, most = n - first, relative
    return found


@in_c
def _product(table: Unknowns, group: int, a: Floats, at: int, b: Floats, bt: int) -> float:
    """Inner product of two vectors of a group, in the metric of its scales."""
    first, last = table.first[group], table.first[group + 1]
    total = 0.0
    for n in range(last - first):
        scale = table.scale[table.scale_of[first + n]]
        if scale > 0.0:
            total += a[at + n] / scale * (b[bt + n] / scale)
    return total


@in_c
def improve(table: Unknowns, group: int) -> None:
    """From `value` and its `residual` to the next value."""
    first, last = table.first[group], table.first[group + 1]
    method, evaluations = table.method[group], table.state[group, 0]
    if method <= IQN_ILS:
        if evaluations % PATIENCE == 0:
            _forget(table, group)
            table.state[group, 1] = 0
        elif evaluations > 1 and _learn(table, group):
            _go_back_if_worse(table, group)
        size, begin = last - first, table.square[group]
        for n in range(size):
            total = 0.0
            for m in range(size):
                total += table.inverse[begin + n * size + m] * table.residual[first + m]
            table.change[first + n] = -total
    else:
        for n in range(first, last):
            table.largest[n] = max(table.largest[n], abs(table.value[n] + table.residual[n]))
        factor = 1.0
        if method == AITKEN and evaluations > 1:
            factor = _aitken(table, group)
        for n in range(first, last):
            table.change[n] = factor * table.residual[n]
    for n in range(first, last):
        table.previous_value[n] = table.value[n]
        table.previous_residual[n] = table.residual[n]
        table.value[n] += table.change[n]


@in_c
def _aitken(table: Unknowns, group: int) -> float:
    """Relaxation from the last two residuals (Irons and Tuck 1969).

    Each is measured by the largest value of its unknown in this step: were one of them measured by
    far too small a number, the others would hardly count.
    """
    before = moved = along = across = 0.0
    for n in range(table.first[group], table.first[group + 1]):
        size = table.largest[n]
        if size > 0.0:
            previous, step = table.previous_residual[n] / size, table.change[n] / size
            difference = table.residual[n] / size - previous
            before += previous * previous
            moved += step * previous
            along += difference * difference
            across += previous * difference
    return -moved / before * across / along if before > 0.0 and along > 0.0 else 1.0


@in_c
def _go_back_if_worse(table: Unknowns, group: int) -> None:
    """Go on from the better of the last two points: what is far away costs digits."""
    first, last = table.first[group], table.first[group + 1]
    before = _product(table, group, table.previous_residual, first, table.previous_residual, first)
    if _product(table, group, table.residual, first, table.residual, first) > before:
        for n in range(first, last):
            table.value[n], table.residual[n] = table.previous_value[n], table.previous_residual[n]


@in_c
def _learn(table: Unknowns, group: int) -> bool:
    """Bring the inverse Jacobian to agree with the last pair, and still with this step's others.

    False if the pair has nothing new.
    """
    first, last = table.first[group], table.first[group + 1]
    size, begin = last - first, table.square[group]
    count = table.state[group, 1]
    if count == size:
        count = 0
    direction = begin + count * size
    for n in range(size):
        table.basis[direction + n] = table.residual[first + n] - table.previous_residual[first + n]
    whole = _product(table, group, table.basis, direction, table.basis, direction)
    for _ in range(2):  # twice is enough
        for former in range(count):
            other = begin + former * size
            along = _product(table, group, table.basis, other, table.basis, direction)
            for n in range(size):
                table.basis[direction + n] -= along * table.basis[other + n]
    left = _product(table, group, table.basis, direction, table.basis, direction)
    if not left > DEPENDENT * DEPENDENT * whole:
        return False
    length = np.sqrt(left)
    for n in range(size):
        table.basis[direction + n] /= length
    # B += (w - B v) q' with the scaled q = basis; v still has its parts along the former, for
    # which B is right already.
    for n in range(size):
        total = table.value[first + n] - table.previous_value[first + n]
        for m in range(size):
            v = table.residual[first + m] - table.previous_residual[first + m]
            total -= table.inverse[begin + n * size + m] * v
        table.change[first + n] = total / length
    for n in range(size):
        for m in range(size):
            scale = table.scale[table.scale_of[first + m]]
            if scale > 0.0:
                table.inverse[begin + n * size + m] += (
                    table.change[first + n] * table.basis[direction + m] / (scale * scale)
                )
    table.state[group, 1] = count + 1
    return True
