"""Constant gains behind FMI's directional derivative, of which Python need not be asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..compiled.entries import c_function
from ..compiled.primitives import array
from ..errors import SlaveError, choices
from .abi import FUNCTIONS
from .memory import F8, U4

GAINS = np.dtype([("count", "i8"), ("values", "i8")])
"""count: of variables. values: address of the gains, a row for each output's reference."""


class Gains:
    """Gains by output and input, in memory; all others are 0."""

    def __init__(
        self, owner: str, names: Sequence[str], gains: Mapping[str, Mapping[str, float]]
    ) -> None:
        """names: of the owner's variables, by their references; raises SlaveError for others."""
        place = {name: reference for reference, name in enumerate(names)}
        self._values = np.zeros((len(names), len(names)))
        for output, row in gains.items():
            if unknown := {output, *row} - place.keys():
                name = min(unknown)
                raise SlaveError(f"{owner}: gains are given of '{name}'; {choices(name, names)}")
            for own, value in row.items():
                self._values[place[output], place[own]] = value
        self._head = np.array([(len(names), self._values.ctypes.data)], GAINS)
        self.instance = self._head.ctypes.data
        self.directional = directional.address


@c_function(FUNCTIONS["directional"].signature)
def directional(instance, unknowns, unknown_count, knowns, known_count, seed, result):
    """fmi2GetDirectionalDerivative of gains."""
    head = array(instance, 1, GAINS)[0]
    gain = array(head.values, 1, F8)
    row_of, column_of = array(unknowns, unknown_count, U4), array(knowns, known_count, U4)
    given, found = array(seed, known_count, F8), array(result, unknown_count, F8)
    for i in range(unknown_count):
        total, row = 0.0, head.count * row_of[i]
        for k in range(known_count):
            total += gain[row + column_of[k]] * given[k]
        found[i] = total
    return 0
