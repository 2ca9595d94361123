"""States of a block, and what follows from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from .variables import NOMINAL, Output, Variable

V = TypeVar("V", bound=Variable)


@dataclass(frozen=True)
class State(Variable):
    """A state of the block; `memory` changes at events and after completed steps only.

    A continuous state is an output of the same name as well. Continuous states come first.
    """

    memory: bool = False


def with_nominals(
    outputs: Sequence[Output], states: Sequence[State]
) -> tuple[tuple[Output, ...], tuple[State, ...]]:
    """The same, states and the outputs of their names with the usual size in their unit."""
    names = {state.name for state in states}
    found = (_with_nominal(output) if output.name in names else output for output in outputs)
    return tuple(found), tuple(map(_with_nominal, states))


def derivative_of(state: State) -> Output:
    """A variable for a state's time derivative."""
    whole, per_second = state.unit.removesuffix("/s"), state.unit.endswith("/s")
    return _with_nominal(
        Output(
            f"der({state.name})",
            f"{whole}/s2" if per_second else f"{whole}/s",
            f"{state.description}, time derivative",
            derivative_of=state.name,
        )
    )


def _with_nominal(variable: V) -> V:
    """The variable with the usual size in its unit, if it states none."""
    return replace(variable, nominal=variable.nominal or NOMINAL.get(variable.unit))
