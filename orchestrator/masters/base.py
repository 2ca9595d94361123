"""What a master is: options as frozen data, a macro loop with its tables, what it says of itself.

A master is found by its file: every module of this folder may define subclasses of `Master`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, field, fields
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import CouplingError, choices
from ..fmu.given import take_fields
from ..options import option
from ..plan.connections import Link
from ..plan.plan import Plan
from .coupling import interpolated

if TYPE_CHECKING:
    from ..slaves.base import Slave
    from .loop.unknowns import Solved

STABLE = (2.0, 1.0, 6.0 / 11.0)
"""Largest stable r by order of extrapolation: the real axis of Adams and Bashforth's methods."""


@dataclass
class Prepared:
    """A macro loop, its tables in the order of its arguments, and what to tell the user.

    led: links whose value at the end of each step `advance` stores in its `end_values`, by column.
    memory: arrays of whole numbers that it carries from step to step; that it may do so with the
    tables' arrays of floating-point numbers goes without saying.
    behind: how many rows before the newest it looks at.
    start_order: macro steps at the start that go in small ones, for a history to extrapolate from.
    solved: what it solves for. states: saved states of the FMUs, by slave, or 0.
    """

    advance: Any
    tables: tuple[Any, ...]
    led: dict[Link, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    memory: tuple[NDArray[Any], ...] = ()
    behind: int = 4
    start_order: int = 0
    solved: Solved | None = None
    states: NDArray[np.int64] | None = None


@dataclass(frozen=True)
class Master(ABC):
    """An algorithm that couples slaves over a macro step; its fields are its options.

    name: what a user calls it; place: where lists have it; follows: where it follows the loops of
    a system, so that they set no largest step, in words. Raises CouplingError for an option that
    cannot be.
    """

    name: ClassVar[str]
    place: ClassVar[int] = 100
    follows: ClassVar[str] = ""

    def __post_init__(self) -> None:
        take_fields(self)

    @abstractmethod
    def prepare(self, plan: Plan, slaves: Sequence[Slave]) -> Prepared:
        """The macro loop and its tables; raises CouplingError for what it cannot couple."""

    def stable_ratios(
        self, plan: Plan, links: Sequence[Link], rigid: Collection[int]
    ) -> Mapping[Link, float] | None:
        """Largest stable r = c H / m of each link on its own; inf for none, None: not known.

        c is a damper between a mass m and the rest, H the macro step. rigid: slaves whose state
        cannot be put back.
        """
        return None

    def notes(self, distrusted: Collection[str]) -> list[str]:
        """What a run is told because the saved states of some instances do not hold everything."""
        return []


@dataclass(frozen=True)
class Extrapolating(Master):
    """A master that moves inputs along the polynomial through their last values."""

    order: int = option(
        0,
        "Order to which jacobi and gauss-seidel extrapolate inputs over a macro step.",
        least=0,
        most=2,
    )

    def stable_ratios(
        self, plan: Plan, links: Sequence[Link], rigid: Collection[int]
    ) -> Mapping[Link, float]:
        """Those of the order; what takes no input derivatives is given a line's mean at most."""
        return {
            link: STABLE[self.order if interpolated(plan, link) else min(self.order, 1)]
            for link in links
        }


@cache
def all_masters() -> Mapping[str, type[Master]]:
    """All masters by name, the default one first."""
    package = __name__.rpartition(".")[0]
    folder = import_module(package).__path__
    found = {
        kind.name: kind
        for module in sorted(m.name for m in iter_modules(folder))
        for kind in _defined(f"{package}.{module}")
    }
    return dict(sorted(found.items(), key=lambda item: item[1].place))


def _defined(module: str) -> Iterator[type[Master]]:
    for value in vars(import_module(module)).values():
        own = isinstance(value, type) and value.__module__ == module
        if own and issubclass(value, Master) and "name" in vars(value):
            yield value


def master_named(name: str, **options: Any) -> Master:
    """The master of a name with its options; raises CouplingError.

    Options that another master has are taken where they are as usual.
    """
    if name not in all_masters():
        raise CouplingError(f"there is no master '{name}'; {choices(name, all_masters())}")
    known = options_of_masters()
    own = {f.name for f in fields(all_masters()[name])}
    for option_name, value in options.items():
        if option_name not in known:
            raise CouplingError(
                f"no master has an option '{option_name}'; {choices(option_name, known)}"
            )
        stated, having = known[option_name]
        if option_name not in own and value != stated.default:
            raise CouplingError(
                f"the master '{name}' has no option '{option_name}'; choose {', '.join(having)}, "
                "or leave it out"
            )
    return all_masters()[name](**{n: v for n, v in options.items() if n in own})


def options_of_masters() -> Mapping[str, tuple[Field[Any], list[str]]]:
    """Each option's field, and the masters that have it."""
    kinds = all_masters()
    stated = {f.name: f for name in sorted(kinds) for f in fields(kinds[name])}
    having = {n: [name for name, kind in kinds.items() if hasattr(kind, n)] for n in stated}
    return {n: (f, having[n]) for n, f in stated.items()}
