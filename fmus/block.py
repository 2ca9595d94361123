"""What a building block of the car is: ports, parameters and equations, each stated once.

A block's equations are CasADi expressions. From them come the native FMU (generated C), the
Python twin, the exact directional derivatives and the declared dependencies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from .terminals import Terminal
from .variables import Input, Output, Parameter, Variable

Signals = Mapping[str, ca.SX]
"""Symbols or expressions by name: scalars, or for derived constants matrices of any shape."""

STEADY = 1e30
"""Largest micro step [s] of a block whose step is exact or which has no dynamics."""


@dataclass(frozen=True)
class State(Variable):
    """A continuous or memory state of the block."""


@dataclass(frozen=True)
class Tangent:
    """The input `partial` is the derivative of `input` with respect to the block's own `output`."""

    input: str
    output: str
    partial: str


@dataclass(frozen=True)
class Table:
    """Functions of one coordinate on a regular grid, made page by page when first needed.

    spacing: distance between nodes, in the coordinate's unit.
    page: CasADi function (page index, derived constants) -> nodes, shape
        (values, nodes_per_page); node n of page m stands at (m*nodes_per_page + n)*spacing.
    station_count: number of places that the outputs look up at a time.

    The outputs receive, for each station, a column of 1 + 2*values numbers: the fraction of the
    way between the two nodes around the station, the left node's values, the right node's.
    """

    spacing: float
    nodes_per_page: int
    values: int
    station_count: int
    page: ca.Function

    @property
    def rows(self) -> int:
        return 1 + 2 * self.values


class Block:
    """A building block. Subclasses state ports, parameters, and equations as expressions."""

    name: str
    description: str
    parameters: Sequence[Parameter]
    inputs: Sequence[Input]
    outputs: Sequence[Output]
    states: Sequence[State] = ()
    tangents: Sequence[Tangent] = ()
    terminals: Sequence[Terminal] = ()
    table: Table | None = None
    switch: str | None = None

    def derived_function(self) -> ca.Function:
        """CasADi function of the parameter vector giving the derived constants, one vector each.

        Override for constants that need loops (MX); otherwise state `derived`.
        """
        p = _symbols(self.parameters)
        values = self.derived(p)
        return ca.Function("derived", [_vector(p)], [_flat(values)])

    def derived_shapes(self) -> dict[str, tuple[int, int]]:
        """Name and shape of each derived constant, in order."""
        values = self.derived(_symbols(self.parameters))
        return {name: ca.SX(value).shape for name, value in values.items()}

    def derived(self, p: Signals) -> Signals:
        """Constants that follow from the parameters, computed when these change."""
        return {}

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """States at the start of the run."""
        return {}

    def largest_step(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """Largest micro step [s] that keeps the integration stable and accurate."""
        return ca.SX(STEADY)

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """States, and inputs that differ from u + rate*h, after one micro step h [s].

        u are the inputs at the start of the micro step, `rate` their time derivatives. The second
        mapping may be empty; it holds inputs that follow the block's own motion (tangents).
        """
        return {}, {}

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        """Outputs at a communication point. lookup: (rows, stations) of the table, if any.

        Every block states this, or overrides `output_function`.
        """
        raise NotImplementedError

    def output_function(self) -> ca.Function | None:
        """CasADi function (x, u, p, d, lookup) -> y of vectors, for outputs with branches (MX).

        None: the outputs are what `output` states.
        """
        return None

    def output_branches(self) -> Sequence[ca.Function]:
        """The functions (x, u, p, d, lookup) -> y among which the parameter `switch` chooses.

        What an output depends on is read off them, since a choice hides its own sparsity.
        """
        return [self.functions.outputs]

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """Time derivatives of the states, friction stuck or slipping as the state says."""
        return {}

    def stations(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """Coordinates at which the table is looked up, shape (stations,)."""
        return ca.SX(0, 1)

    @cached_property
    def functions(self) -> Functions:
        """The block's numerical functions, built once."""
        return Functions(self)

    def parameter_vector(self, values: Mapping[str, float]) -> np.ndarray:
        """Parameter values in the block's order [SI]; raises KeyError for a missing one."""
        return np.array([float(values[v.name]) for v in self.parameters])


class Functions:
    """A block's expressions as flat CasADi functions of vectors, in the order of its variables.

    derived(p) -> d
    initial(p, d, u) -> x
    largest_step(x, u, p, d) -> h [s]
    step(x, u, rate, p, d, h) -> x, u at the end of the micro step
    stations(x, u, p, d) -> s
    outputs(x, u, p, d, lookup) -> y
    outputs_forward(x, u, p, d, lookup, u_seed) -> y_seed
    derivative(x, u, p, d) -> dx/dt
    """

    def __init__(self, block: Block) -> None:
        p, u, x = (_symbols(v) for v in (block.parameters, block.inputs, block.states))
        rate = {v.name: ca.SX.sym(f"rate_{v.name}") for v in block.inputs}
        shapes = block.derived_shapes()
        d = {name: ca.SX.sym(name, *shape) for name, shape in shapes.items()}
        h = ca.SX.sym("h")
        rows, columns = (block.table.rows, block.table.station_count) if block.table else (0, 0)
        lookup = ca.SX.sym("lookup", rows, columns)
        pv, uv, xv = _vector(p), _vector(u), _vector(x)
        dv = _flat(d)

        self.derived = block.derived_function()
        self.initial = ca.Function(
            "initial", [pv, dv, uv], [_ordered(block.states, block.initial(p, d, u))]
        )
        self.largest_step = ca.Function(
            "largest_step", [xv, uv, pv, dv], [ca.SX(block.largest_step(x, u, p, d))]
        )
        x_end, u_end = block.step(x, u, rate, p, d, h)
        held = {name: u[name] + rate[name] * h for name in u}
        self.step = ca.Function(
            "step",
            [xv, uv, _vector(rate), pv, dv, h],
            [_ordered(block.states, x_end), _ordered(block.inputs, {**held, **u_end})],
        )
        self.stations = ca.Function(
            "stations", [xv, uv, pv, dv], [ca.densify(block.stations(x, u, p, d))]
        )
        self.outputs, self.outputs_forward = _outputs(block, x, u, p, d, lookup)
        self.derivative = ca.Function(
            "derivative",
            [xv, uv, pv, dv],
            [_ordered(block.states, block.derivative(x, u, p, d))],
        )


def _outputs(
    block: Block,
    x: dict[str, ca.SX],
    u: dict[str, ca.SX],
    p: dict[str, ca.SX],
    d: dict[str, ca.SX],
    lookup: ca.SX,
) -> tuple[ca.Function, ca.Function]:
    """The outputs, and their derivative in a direction of the inputs."""
    function = block.output_function()
    if function is None:
        arguments = [_vector(x), _vector(u), _vector(p), _flat(d), lookup]
        y = _ordered(block.outputs, block.output(x, u, p, d, lookup if block.table else None))
        function = ca.Function("outputs", arguments, [y])
    plain = function.is_a("SXFunction")
    at: list[Any] = function.sx_in() if plain else function.mx_in()
    seed: Any = (ca.SX if plain else ca.MX).sym("seed", len(u))
    forward = ca.densify(ca.jtimes(function(*at), at[1], seed))
    return function, ca.Function("outputs_forward", [*at, seed], [forward])


def _flat(constants: Signals) -> ca.SX:
    """All constants in one column."""
    return ca.vertcat(*[ca.vec(ca.SX(v)) for v in constants.values()]) if constants else ca.SX(0, 1)


def _symbols(variables: Sequence[Variable]) -> dict[str, ca.SX]:
    return {v.name: ca.SX.sym(v.name) for v in variables}


def _vector(signals: Signals) -> ca.SX:
    return ca.vertcat(*signals.values()) if signals else ca.SX(0, 1)


def _ordered(variables: Sequence[Variable], values: Signals) -> ca.SX:
    """The expressions in the variables' order; every variable must have one, and no other."""
    names = [v.name for v in variables]
    if set(names) != set(values):
        missing = sorted(set(names) - set(values))
        unknown = sorted(set(values) - set(names))
        raise ValueError(f"expressions missing for {missing}, not declared: {unknown}")
    return ca.densify(ca.vertcat(*[ca.SX(values[n]) for n in names])) if names else ca.SX(0, 1)
