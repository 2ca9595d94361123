"""The Python twin of a block's FMU: the same functions, called in the same order, in Python."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from .block import Block
from .variables import Values


class Twin:
    """One instance of a block, run by CasADi's virtual machine.

    values: parameter values [SI] by name, all of them.
    inputs: those that do not begin at their start values [SI].
    """

    def __init__(self, block: Block, values: Values, inputs: Values | None = None) -> None:
        self.block = block
        self.time = 0.0
        self.p = block.parameter_vector(values)
        self.u = np.array([v.start for v in block.inputs])
        self.rate = np.zeros(len(block.inputs))
        self.d = ca.DM()  # stays CasADi's, since it may be long
        self.x = np.zeros(0)
        self.mode = np.zeros(len(block.modes))
        self._state = {v.name: i for i, v in enumerate(block.continuous)}
        self._input = {v.name: i for i, v in enumerate(block.inputs)}
        self._output = {v.name: i for i, v in enumerate(block.outputs)}
        self._pages: dict[int, np.ndarray] = {}
        for name, value in (inputs or {}).items():
            self.set(name, value)

    def set_parameters(self, values: Values) -> None:
        """Change the parameters [SI], of which all are given, and keep the state."""
        p = self.block.parameter_vector(values)
        if self.d.is_empty() or not np.array_equal(p, self.p):
            self.p = p
            self.d = self.block.functions.derived(p)
            self._pages = {}

    def set(self, name: str, value: float) -> None:
        """Set an input [SI]."""
        self.u[self._input[name]] = value

    def set_rate(self, name: str, value: float) -> None:
        """Let an input vary linearly over the next step, at this rate [unit/s]."""
        self.rate[self._input[name]] = value

    def initialize(self) -> None:
        """Compute derived constants and the initial state from parameters and inputs."""
        f = self.block.functions
        self.d = f.derived(self.p)
        self.x = _array(f.initial(self.p, self.d, self.u))
        self.mode[:] = 0.0
        self._pages = {}

    def step(self, size: float) -> None:
        """Advance by a communication step [s], in equal micro steps."""
        f = self.block.functions
        largest = float(f.largest_step(self.x, self.u, self.p, self.d))
        count = max(1, math.ceil(size / largest - 1e-9))
        kept = f.transition(self.d, size / count)
        for _ in range(count):
            over_step = (self.x, self.u, self.rate, self.p, self.d, size / count, kept)
            x, u, *margin = f.step(*over_step)
            if margin and float(margin[0]) < 0:
                x, u = f.step_beyond(*over_step)
            self.x, self.u = _array(x), _array(u)
        self.rate[:] = 0.0
        self.time += size

    def get(self, name: str) -> float:
        """An output [SI] with the present state and inputs."""
        return float(self.outputs()[self._output[name]])

    def outputs(self) -> np.ndarray:
        """All outputs in block order."""
        f, at = self.block.functions, (self.x, self.u, self.p, self.d, self._lookup())
        found = f.outputs(*at)
        if f.has_margin:
            found, margin = found
            if float(margin) < 0:
                found = f.outputs_beyond(*at)
        return _array(found)

    def derivatives(self) -> np.ndarray:
        """Time derivatives of the continuous states, which are the first ones in `x`."""
        return _array(self.block.functions.derivative(self.x, self.u, self.p, self.d))

    def event_indicators(self) -> np.ndarray:
        """All event indicators with the present states, inputs and modes."""
        f = self.block.functions.event_indicators
        return _array(f(self.x, self.u, self.p, self.d, self.mode))

    def update_memory(self) -> None:
        """Let memory and modes follow, at an event or after a completed integrator step."""
        f = self.block.functions.memory_after
        memory, mode = f(self.x, self.u, self.p, self.d, self.mode)
        self.x[len(self._state) :] = _array(memory)
        self.mode = _array(mode)

    def directional(self, seed: Values) -> np.ndarray:
        """Derivatives along the seed of all outputs, then of the states' time derivatives.

        seed: direction by name, of inputs and continuous states.
        """
        f, table = self.block.functions, self.block.table
        x_seed, u_seed = np.zeros(len(self._state)), np.zeros(len(self.u))
        for name, value in seed.items():
            if name in self._input:
                u_seed[self._input[name]] = value
            else:
                x_seed[self._state[name]] = value
        at = (self.x, self.u, self.p, self.d)
        fractions = np.zeros(0)
        if table is not None:
            fractions = _array(f.stations_forward(*at, x_seed, u_seed)) / table.spacing
        seeds = f.forward(*at, self._lookup(), x_seed, u_seed, fractions)
        return np.concatenate([_array(seed) for seed in seeds])

    def _lookup(self) -> np.ndarray:
        table = self.block.table
        if table is None:
            return np.zeros((0, 0))
        stations = _array(self.block.functions.stations(self.x, self.u, self.p, self.d))
        columns = []
        for place in stations / table.spacing:
            node = math.floor(place)
            columns.append([place - node, *self._node(node), *self._node(node + 1)])
        return np.array(columns).T

    def _node(self, node: int) -> np.ndarray:
        assert self.block.table is not None
        number, place = divmod(node, self.block.table.nodes_per_page)
        if number not in self._pages:
            self._pages[number] = np.array(self.block.table.page(number, self.d))
        return self._pages[number][:, place]


def _array(value: ca.DM) -> np.ndarray:
    return np.array(value, dtype=float).reshape(-1)
