"""What a fit is made of: numbers with one noise level, and models that are held to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Group:
    """Residuals of one noise level: a channel, or measured numbers of one kind.

    lengths: of its pieces, within which neighbours may be correlated; numbers of their own are
    pieces of one. deviation: of the noise, in the unit of the residuals. given: whether it is
    known; else the fit begins with it, and estimates it. what: what the residuals are.
    """

    name: str
    lengths: tuple[int, ...]
    deviation: float
    given: bool
    what: str

    @property
    def count(self) -> int:
        return sum(self.lengths)

    @property
    def ordered(self) -> bool:
        """Whether neighbours may be correlated."""
        return max(self.lengths) > 1


class Evidence(Protocol):
    """A model beside what was measured of it. `at`: values of the parameters, in their order."""

    @property
    def groups(self) -> Sequence[Group]: ...

    def residuals(self, at: Array) -> Sequence[Array]:
        """Model less measured, by group (count,); not finite where the model cannot be had."""

    def slopes(self, at: Array) -> Sequence[Array]:
        """Their derivatives by the parameters, by group (count, parameters)."""
