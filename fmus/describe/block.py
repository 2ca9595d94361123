"""What a building block of the car is: ports, parameters and equations, each stated once.

A block's equations are CasADi expressions. From them come the native FMU (generated C), the
Python twin, the exact directional derivatives and the declared dependencies.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from .states import State, derivative_of, with_nominals
from .terminals import Terminal
from .variables import Array, Constant, Input, Limit, Output, Parameter, Tangent, Values, Variable
from .vectors import flat, ordered, symbols, vector

Signals = Mapping[str, ca.SX]
"""Symbols or expressions by name. They are scalars; derived constants may be matrices."""

STEADY = 1e30
"""Largest micro step [s] of a block whose step is exact or which has no dynamics."""


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
    """A building block. Subclasses state ports, parameters, and equations as expressions.

    limits: what its laws hold for, where this does not stand in the folder's `range.toml`.
    stands_for: the block whose ports this one has too, and whose numbers it shares.
    switch: the enumeration that chooses among laws, each of which is a function of its own.
    led: of such a block the outputs, the first ones, whose slopes masters ask for in every step.
    usual: stop time and step [s] of the default experiment, if not those of all.
    """

    name: str
    description: str
    parameters: Sequence[Parameter]
    inputs: Sequence[Input]
    outputs: Sequence[Output]
    states: Sequence[State] = ()
    modes: Sequence[Variable] = ()
    constants: Sequence[Constant] = ()
    arrays: Sequence[Array] = ()
    tangents: Sequence[Tangent] = ()
    terminals: Sequence[Terminal] = ()
    table: Table | None = None
    switch: str | None = None
    limits: Sequence[Limit] | None = None
    led: Sequence[str] = ()
    stands_for: str | None = None
    usual: tuple[float, float] | None = None

    home: str = ""
    """Folder of `fmus` with its README, pictures and reference results; "" is that of its name."""

    def __init_subclass__(cls) -> None:
        cls.outputs, cls.states = with_nominals(getattr(cls, "outputs", ()), cls.states)

    @property
    def folder(self) -> str:
        """Name of its folder in `fmus`."""
        return self.home or self.name

    def derived_function(self) -> ca.Function:
        """CasADi function from the vector of parameters to the vector of derived constants.

        Override for constants that need loops (MX); otherwise state `derived`.
        """
        p = symbols(self.parameters)
        values = self.derived(p)
        return ca.Function("derived", [vector(p)], [flat(values)])

    @cached_property
    def derived_shapes(self) -> dict[str, tuple[int, int]]:
        """Name and shape of each derived constant, in order."""
        values = self.derived(symbols(self.parameters))
        return {name: ca.SX(value).shape for name, value in values.items()}

    def derived(self, p: Signals) -> Signals:
        """Constants that follow from the parameters, computed when these change."""
        return {}

    def constant(self, p: Signals, d: Signals) -> Signals:
        """The constants that a user can read."""
        return {}

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """States at the start of the run."""
        return {}

    def largest_step(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """Largest micro step [s] that keeps the integration stable and accurate."""
        return ca.SX(STEADY)

    def transition(self, d: Signals, h: ca.SX) -> Signals:
        """What micro steps of size h [s] need besides, kept while h and the constants stand."""
        return {}

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """States, and inputs that differ from u + rate*h, after one micro step h [s].

        u are the inputs at the start of the micro step, `rate` their time derivatives; d holds what
        `transition` states as well. The second mapping may be empty; it holds inputs that follow
        the block's own motion (tangents).
        """
        return {}, {}

    def margin(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX | None:
        """At least zero where `step`, at both its ends, and `output` hold; None: everywhere.

        Elsewhere `step_beyond` and `output_beyond` stand in, which may cost more.
        """
        return None

    def step_beyond(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """The micro step that holds everywhere."""
        return self.step(x, u, rate, p, d, h)

    def output_beyond(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """The outputs that hold everywhere, of a block with a margin."""
        raise NotImplementedError

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

    def output_slope(self) -> ca.Function | None:
        """The same with exact derivatives, where `output_function` has none for its haste."""
        return None

    def output_branches(self) -> Sequence[ca.Function]:
        """The functions (x, u, p, d, lookup) -> y among which the parameter `switch` chooses.

        The dependencies of the outputs are read from these, since a choice hides their sparsity.
        """
        return [self.functions.outputs_beyond]

    def output_laws(self) -> Sequence[ca.Function]:
        """The functions (x, u, p, d, lookup) -> y of the items of `switch`, in their order."""
        return []

    def led_laws(self) -> Sequence[ca.Function]:
        """Those to the outputs `led` alone, with exact derivatives; of the first items."""
        return []

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        """Time derivatives of the continuous states, the memory as it is."""
        return {}

    def event_indicators(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> Signals:
        """Expressions by name; each changes its sign where an integrator has to stop.

        `modes` are whole numbers, 0 at the start, that choose what the indicators watch.
        """
        return {}

    def memory_after(
        self, x: Signals, u: Signals, p: Signals, d: Signals, mode: Signals
    ) -> tuple[Signals, Signals]:
        """Memory states and modes at an event or after a completed step, from those before it."""
        return {}, {}

    def stations(self, x: Signals, u: Signals, p: Signals, d: Signals) -> ca.SX:
        """Coordinates at which the table is looked up, shape (stations,)."""
        return ca.SX(0, 1)

    @property
    def continuous(self) -> Sequence[State]:
        """The states that an integrator of Model Exchange integrates."""
        return [state for state in self.states if not state.memory]

    @property
    def memory(self) -> Sequence[State]:
        return [state for state in self.states if state.memory]

    @property
    def derivatives(self) -> Sequence[Output]:
        """The time derivative of each continuous state: an output, or a variable of its own."""
        rates = {output.derivative_of: output for output in self.outputs}
        return [rates.get(state.name) or derivative_of(state) for state in self.continuous]

    @property
    def locals(self) -> Sequence[Variable]:
        """Variables that are no ports: derivatives that are no outputs, then the memory."""
        own = [v for v in self.derivatives if v not in self.outputs]
        return [*own, *self.memory]

    @property
    def all_arrays(self) -> list[Array]:
        """The block's arrays, and those of the derivatives of an array of states."""
        states, derivatives = ([v.name for v in g] for g in (self.continuous, self.derivatives))
        rates = dict(zip(states, derivatives, strict=True))
        of_rates = (
            replace(
                array,
                name=f"der({array.name})",
                description=f"{array.description}; time derivatives",
                members=tuple(rates[m] for m in array.members),
            )
            for array in self.arrays
            if all(rates.get(member) == f"der({member})" for member in array.members)
        )
        return [*self.arrays, *of_rates]

    @property
    def indicators(self) -> list[str]:
        """Names of the event indicators, in their order."""
        groups = (self.states, self.inputs, self.parameters, self.modes)
        x, u, p, mode = (symbols(variables) for variables in groups)
        d = {name: ca.SX(*shape) for name, shape in self.derived_shapes.items()}
        return list(self.event_indicators(x, u, p, d, mode))

    @property
    def references(self) -> dict[str, int]:
        """FMI's value reference of each variable by name, in their order; 0 is the time."""
        groups = (self.parameters, self.inputs, self.outputs, self.locals, self.constants)
        return {v.name: n for n, v in enumerate((v for g in groups for v in g), start=1)}

    @cached_property
    def functions(self) -> Functions:
        """The block's numerical functions, built once."""
        return Functions(self)

    def parameter_vector(self, values: Values) -> np.ndarray:
        """Parameter values in the block's order [SI]; raises KeyError for a missing one."""
        return np.array([float(values[v.name]) for v in self.parameters])


class Functions:
    """A block's expressions as flat CasADi functions of vectors, in the order of its variables.

    derived(p) -> d
    constants(p, d) -> c
    initial(p, d, u) -> x
    largest_step(x, u, p, d) -> h [s]
    transition(d, h) -> t
    step(x, u, rate, p, d, h, t) -> x, u at the end of the micro step, and the margin if any
    step_beyond(x, u, rate, p, d, h, t) -> x, u
    stations(x, u, p, d) -> s
    outputs(x, u, p, d, lookup) -> y, and the margin
    outputs_beyond(x, u, p, d, lookup) -> y
    derivative(x, u, p, d) -> dx/dt of the continuous states
    event_indicators(x, u, p, d, mode) -> z
    memory_after(x, u, p, d, mode) -> memory states, mode
    stations_forward(x, u, p, d, x_seed, u_seed) -> s_seed
    forward(x, u, p, d, lookup, x_seed, u_seed, fraction_seed) -> y_seed, seed of dx/dt

    A seed is a direction, and the result is the derivative along it. x_seed is of the continuous
    states, fraction_seed of the first row of the lookup.
    """

    def __init__(self, block: Block) -> None:
        p, u, x = (symbols(v) for v in (block.parameters, block.inputs, block.states))
        rate = {v.name: ca.SX.sym(f"rate_{v.name}") for v in block.inputs}
        shapes = block.derived_shapes
        d = {name: ca.SX.sym(name, *shape) for name, shape in shapes.items()}
        h = ca.SX.sym("h")
        rows, columns = (block.table.rows, block.table.station_count) if block.table else (0, 0)
        lookup = ca.SX.sym("lookup", rows, columns)
        pv, uv, xv = vector(p), vector(u), vector(x)
        dv = flat(d)

        self.derived = block.derived_function()
        self.constants = ca.Function(
            "constants", [pv, dv], [ordered(block.constants, block.constant(p, d))]
        )
        self.initial = ca.Function(
            "initial", [pv, dv, uv], [ordered(block.states, block.initial(p, d, u))]
        )
        self.largest_step = ca.Function(
            "largest_step", [xv, uv, pv, dv], [ca.SX(block.largest_step(x, u, p, d))]
        )
        held = {name: u[name] + rate[name] * h for name in u}
        kept = block.transition(d, h)
        self.transition = ca.Function("transition", [dv, h], [ca.densify(flat(kept))])
        t = {name: ca.SX.sym(name, *ca.SX(value).shape) for name, value in kept.items()}
        over_step = [xv, uv, vector(rate), pv, dv, h, flat(t)]

        def ends(step: Callable[..., tuple[Signals, Signals]]) -> tuple[Signals, Signals]:
            x_end, moved = step(x, u, rate, p, {**d, **t}, h)
            return x_end, {**held, **moved}

        def vectors(x_end: Signals, u_end: Signals) -> list[ca.SX]:
            return [ordered(block.states, x_end), ordered(block.inputs, u_end)]

        x_end, u_end = ends(block.step)
        at_start, at_end = block.margin(x, u, p, d), block.margin(x_end, u_end, p, d)
        margins = [] if at_start is None or at_end is None else [ca.fmin(at_start, at_end)]
        self.step = ca.Function("step", over_step, ca.cse([*vectors(x_end, u_end), *margins]))
        self.step_beyond = ca.Function(
            "step_beyond", over_step, ca.cse(vectors(*ends(block.step_beyond)))
        )
        self.stations = ca.Function(
            "stations", [xv, uv, pv, dv], [ca.densify(block.stations(x, u, p, d))]
        )
        self.derivative = ca.Function(
            "derivative",
            [xv, uv, pv, dv],
            [ordered(block.continuous, block.derivative(x, u, p, d))],
        )
        mode = symbols(block.modes)
        at_event = [xv, uv, pv, dv, vector(mode)]
        indicators = block.event_indicators(x, u, p, d, mode)
        self.event_indicators = ca.Function(
            "event_indicators", at_event, [ca.densify(vector(indicators))]
        )
        memory, mode_after = block.memory_after(x, u, p, d, mode)
        self.memory_after = ca.Function(
            "memory_after",
            at_event,
            [ordered(block.memory, memory), ordered(block.modes, mode_after)],
        )
        at_point = [xv, uv, pv, dv, lookup]

        def outputs(name: str, y: Signals, *more: ca.SX) -> ca.Function:
            return ca.Function(name, at_point, ca.cse([ordered(block.outputs, y), *more]))

        self.outputs = block.output_function() or outputs(
            "outputs",
            block.output(x, u, p, d, lookup if block.table else None),
            *([] if at_start is None else [at_start]),
        )
        self.outputs_beyond = (
            self.outputs
            if at_start is None
            else outputs("outputs_beyond", block.output_beyond(x, u, p, d))
        )
        self._continuous, self._slope = len(block.continuous), block.output_slope()
        self.output_laws, self._led_laws = block.output_laws(), block.led_laws()

    @property
    def has_margin(self) -> bool:
        """Whether `step` and `outputs` have a margin, and functions that hold beyond it."""
        return self.outputs_beyond is not self.outputs

    @cached_property
    def slope_laws(self) -> Sequence[ca.Function]:
        """(x, u, p, d, lookup) -> slopes of the outputs `led`, shape (inputs, outputs), by law."""

        def slopes(law: ca.Function) -> ca.Function:
            plain = law.is_a("SXFunction")
            at: Any = law.sx_in() if plain else law.mx_in()
            found = ca.densify(ca.jacobian(law(*at), at[1]).T)
            name = law.name().replace("led", "slopes")
            return ca.Function(name, at, ca.cse([found]) if plain else [found])

        return [slopes(law) for law in self._led_laws]

    @property
    def stations_forward(self) -> ca.Function:
        return self._along_seeds[0]

    @property
    def forward(self) -> ca.Function:
        return self._along_seeds[1]

    @cached_property
    def _along_seeds(self) -> tuple[ca.Function, ca.Function]:
        """Derivatives of stations, outputs and rates in a direction of states and inputs.

        Made when first asked for: it takes most of the time, and a simulation does without.
        """
        continuous = self._continuous
        outputs = self._slope or self.outputs_beyond
        plain = outputs.is_a("SXFunction")
        kind: Any = ca.SX if plain else ca.MX
        arguments: list[Any] = outputs.sx_in() if plain else outputs.mx_in()
        x, u, p, d, lookup = arguments
        x_seed = kind.sym("x_seed", continuous)
        u_seed = kind.sym("u_seed", u.numel())
        fraction_seed = kind.sym("fraction_seed", lookup.size2())

        def along(expression: Any, *pairs: tuple[Any, Any]) -> Any:
            moving = [(at, seed) for at, seed in pairs if at.numel()]
            return ca.densify(sum(ca.jtimes(expression, at, seed) for at, seed in moving))

        shared: Any = ca.cse if plain else list
        by_ports = ((x[:continuous], x_seed), (u, u_seed))
        fractions = lookup[0, :].T if lookup.numel() else lookup
        seeds = [x_seed, u_seed]
        return ca.Function(
            "stations_forward",
            [x, u, p, d, *seeds],
            [along(self.stations(x, u, p, d), *by_ports)],
        ), ca.Function(
            "forward",
            [x, u, p, d, lookup, *seeds, fraction_seed],
            shared(
                [
                    along(outputs(x, u, p, d, lookup), *by_ports, (fractions, fraction_seed)),
                    along(self.derivative(x, u, p, d), *by_ports),
                ]
            ),
        )
