"""A model in plain Python that becomes an FMU; import from here what such a model needs.

`fmus.export.python.pack` makes the FMU, and takes along what the model imports from `fmus`.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from typing import Any

from .describe.variables import (
    Array,
    Constant,
    Input,
    Limit,
    Output,
    Parameter,
    Tangent,
    Values,
    Variable,
)

__all__ = ["Input", "Limit", "Model", "Output", "Parameter", "Tangent", "Values"]

KINDS: Mapping[str, Callable[[float], float]] = {
    "real": float,
    "integer": int,
    "boolean": bool,
    "enumeration": int,
}
"""Types of the values of a parameter."""


class Model:
    """What an FMU in Python computes. Subclasses state variables and `output`, most also `step`.

    All that a model keeps in `self` is its state, which a master may save, restore and store as
    bytes: numbers, booleans, text, numpy arrays, and lists, tuples or dicts of these.

    author, license: as the model description shall say, if at all.
    limits: what the model's laws hold for; None: it does not say.
    feedthrough: for each output that an input changes within the same instant, those inputs.
    """

    description: str
    author: str = ""
    license: str = ""
    parameters: Sequence[Parameter] = ()
    inputs: Sequence[Input] = ()
    outputs: Sequence[Output]
    tangents: Sequence[Tangent] = ()
    limits: Sequence[Limit] | None = None
    feedthrough: Mapping[str, Sequence[str]] = {}

    locals: Sequence[Variable] = ()
    derivatives: Sequence[Output] = ()
    """These are for Model Exchange, which a model in Python does not offer."""

    constants: Sequence[Constant] = ()
    arrays: Sequence[Array] = ()
    """These are shown by the native FMUs of the blocks only."""

    usual: tuple[float, float] | None = None
    """Stop time and step [s] of the default experiment; None: those of the blocks."""

    def start(self, p: Values, u: Values) -> None:
        """Set the state at the start of a run, from parameters and inputs.

        It is called whenever one of these changes before the run begins.
        """

    def step(self, p: Values, u: MutableMapping[str, float], time: float, size: float) -> None:
        """Advance the state from `time` [s] by `size` [s], the inputs held."""

    def output(self, p: Values, u: Values) -> Values:
        """Value of each output, from the state, the parameters and the inputs as they are."""
        raise NotImplementedError

    def start_values(self) -> tuple[dict[str, float], dict[str, float]]:
        """Parameters and inputs as they are when nobody sets them [SI]."""
        p = {v.name: KINDS[v.kind](v.default or 0.0) for v in self.parameters}
        return p, {v.name: v.start for v in self.inputs}

    @property
    def name(self) -> str:
        """What the FMU calls itself: the name of the model's file."""
        return type(self).__module__.rpartition(".")[2]

    @property
    def references(self) -> dict[str, int]:
        """FMI's value reference of each variable by name, in their order."""
        variables = (*self.parameters, *self.inputs, *self.outputs)
        return {v.name: n for n, v in enumerate(variables, start=1)}

    def save(self) -> dict[str, Any]:
        """A copy of the state."""
        return copy.deepcopy(vars(self))

    def restore(self, state: Mapping[str, Any]) -> None:
        """Put back a state that was saved."""
        vars(self).clear()
        vars(self).update(copy.deepcopy(dict(state)))
