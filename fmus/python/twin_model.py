"""The twin of a block as a model, which becomes a Python FMU."""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from functools import cache
from typing import Any

import numpy as np

from ..describe.block import Block
from ..describe.twin import Twin
from ..model import Model, Values


class TwinModel(Model):
    """A block's twin behind the surface of a plain model. values: of all parameters [SI]."""

    def __init__(self, kind: Callable[[], Block], values: Values) -> None:
        block = _built(kind)
        self.description = block.description
        self.parameters, self.inputs, self.outputs = block.parameters, block.inputs, block.outputs
        self.tangents = block.tangents
        self._twin = Twin(block, values)

    @property
    def name(self) -> str:
        return self._twin.block.name

    def start(self, p: Values, u: Values) -> None:
        self._give(p, u)
        self._twin.initialize()

    def step(self, p: Values, u: MutableMapping[str, float], time: float, size: float) -> None:
        """Advance; inputs that have a tangent follow the block's own motion."""
        self._give(p, u)
        self._twin.step(size)
        u.update(zip(u, self._twin.u.tolist(), strict=True))

    def output(self, p: Values, u: Values) -> Values:
        self._give(p, u)
        names = (output.name for output in self.outputs)
        return dict(zip(names, self._twin.outputs().tolist(), strict=True))

    def save(self) -> dict[str, Any]:
        return {"x": self._twin.x.copy()}

    def restore(self, state: Mapping[str, Any]) -> None:
        self._twin.x = state["x"].copy()

    def _give(self, p: Values, u: Values) -> None:
        self._twin.set_parameters(p)
        self._twin.u = np.array(list(u.values()))


@cache
def _built(kind: Callable[[], Block]) -> Block:
    """The block, whose functions all its instances in a process share."""
    return kind()
