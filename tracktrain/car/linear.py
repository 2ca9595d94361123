"""The coupled car for small motion, out of the blocks' own equations, with exact derivatives.

car = LinearCar("loaded")
roots, shapes = car.modes(speed=24.4)
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache, lru_cache, partial
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from platformdirs import user_cache_path

from fmus import BLOCKS
from fmus.carbody.modal import ModalCarbody
from fmus.carbody.modal_data import ModalData
from fmus.catalogue import source_hash
from fmus.describe.block import Block
from orchestrator import UnwrittenError, choices, whole_file

from ..errors import HopperError
from .friction import LARGE, damping, kinds, to_rates, tuned
from .hopper import parameters_of, vehicle
from .layout import Layout
from .linear_motion import Array, LinearMotion, Parameter
from .spreads import Uncertain

Blocks = tuple[tuple[str, Block], ...]
Friction = tuple[tuple[str, str], ...]
FUNCTIONS = ("matrix", "slopes")
"""What is built of a car, each in a file of its own."""


class LinearCar(LinearMotion):
    """dx/dt = A x of the hopper car on perfect track, flange open.

    car: one of `CARS`; changes: values [SI] instead of the set's, by "block.parameter" or
    "parameter" for all blocks that have it. friction: a name of `FRICTION`, or kinds by element.
    omega [rad/s]: frequency that the dampers of (7-7) are made for. carbody: modal data instead of
    the default's shapes and numbers.

    Raises HopperError for a parameter, an element or a kind of friction that is not known.
    """

    def __init__(
        self,
        car: str = "loaded",
        changes: Mapping[str, float] | None = None,
        friction: str | Mapping[str, str] = "stuck",
        omega: float = 2 * np.pi,
        carbody: ModalData | None = None,
    ) -> None:
        self.car, self.friction, self.omega = car, kinds(friction), omega
        self.carbody = carbody
        self.layout = vehicle(car).layout
        self._blocks, given = _blocks(), parameters_of(car)
        if carbody is not None:
            block = ModalCarbody(carbody)
            self._blocks = {**self._blocks, "carbody": block}
            given["carbody"] = block.given.values(block)
        self._values = {name: given[name] for name in self._blocks}
        for name, value in (changes or {}).items():
            self._change(name, value)
        law = int(self._values["wheelrail"]["creep_law"])
        self._form = self.layout, tuple(self._blocks.items()), law, tuple(self.friction.items())
        self.states = _states(self.layout, self._blocks)

    def _change(self, name: str, value: float) -> None:
        block, _, parameter = name.partition(".")
        if block not in self._blocks or parameter not in self._values[block]:
            block, parameter = "", name
        found = [b for b, v in self._values.items() if (not block or b == block) and parameter in v]
        if not found:
            known = sorted({n for values in self._values.values() for n in values})
            raise HopperError(f"the car has no parameter '{name}'; {choices(name, known)}")
        for b in found:
            self._values[b][parameter] = value

    @property
    def parameters(self) -> list[Parameter]:
        """The numbers of the car: all but options and initial values."""
        found: dict[str, Parameter] = {}
        for name, block in self._blocks.items():
            for p in block.parameters:
                if p.kind != "real" or p.name.startswith("initial.") or p.name == "micro_step":
                    continue
                before = found[p.name].blocks if p.name in found else ()
                value = self._values[name][p.name]
                found[p.name] = Parameter(p.name, (*before, name), value, p.unit, p.description)
        return list(found.values())

    def values(self, block: str) -> dict[str, float]:
        """Parameter values [SI] of a block as this car has them."""
        return dict(self._values[block])

    def _arguments(self, speed: float, changes: Mapping[str, float]) -> list[Any]:
        values = (
            {name: changes.get(name, value) for name, value in self._values[block].items()}
            for block in self._blocks
        )
        vectors = map(Block.parameter_vector, self._blocks.values(), values)
        return [*vectors, self.omega, speed]

    def matrix(self, speed: float, changes: Mapping[str, float] | None = None) -> Array:
        """A at a speed [m/s], (states, states); changes: further values [SI] by parameter."""
        return np.array(self._function("matrix")(*self._arguments(speed, changes or {})))

    def _function(self, name: str) -> ca.Function:
        return _stored(*self._form)[FUNCTIONS.index(name)]

    def slopes(self, speed: float, root: complex) -> tuple[dict[str, complex], complex]:
        """Derivative of an eigenvalue with respect to each parameter, and to the speed.

        Exact [1/s per SI unit].
        """
        weights = self.weights(speed, root)
        arguments = self._arguments(speed, {})
        pulled = [
            np.array(self._function("slopes")(*arguments, part)).ravel()
            for part in (weights.real, weights.imag)
        ]
        along = pulled[0] + 1j * pulled[1]
        names = [(n, p.name) for n, block in self._blocks.items() for p in block.parameters]
        by_name = dict(zip(names, along, strict=False))
        found = {
            p.name: complex(sum(by_name[block, p.name] for block in p.blocks))
            for p in self.parameters
        }
        return found, complex(along[-1])

    def relative_slopes(self, speed: float, root: complex) -> tuple[dict[str, complex], complex]:
        by_parameter, by_speed = self.slopes(speed, root)
        return {p.name: by_parameter[p.name] * p.value for p in self.parameters}, by_speed

    def moved(self, speed: float, share: float) -> Iterator[tuple[Parameter, Array, Array]]:
        for p in self.parameters:
            more, less = (
                self.matrix(speed, {p.name: (1 + sign * share) * p.value}) for sign in (1, -1)
            )
            yield p, more, less

    def slopes_along(
        self, speed: float, root: complex, numbers: Sequence[Uncertain]
    ) -> tuple[dict[str, complex], complex]:
        by_parameter, by_speed = self.slopes(speed, root)
        found = {
            n.name: sum(f * by_parameter[name] for name, f in n.changes(1.0).items())
            for n in numbers
        }
        return found, by_speed


def linear_car(
    car: str, friction: str = "stuck", changes: Mapping[str, float] | None = None
) -> LinearCar:
    """The car; its dampers are made for the frequency that it hunts at. # report (7-7)"""
    return tuned(partial(LinearCar, car, changes), friction)


@cache
def _blocks() -> dict[str, Block]:
    """The blocks of a car, built once: that takes longer than all that is done with them."""
    return {name: BLOCKS[name]() for name in ("carbody", "truck", "wheelrail")}


def _states(layout: Layout, blocks: Mapping[str, Block]) -> tuple[str, ...]:
    return tuple(
        f"{i}.{state.name}" for i in layout.bodies for state in blocks[layout.blocks[i]].continuous
    )


@lru_cache(maxsize=16)
def _stored(
    layout: Layout, listed: Blocks, law: int, friction: Friction
) -> tuple[ca.Function, ...]:
    """`_functions`; those of a car of the blocks themselves are kept in files."""
    if listed != tuple(_blocks().items()):
        return _functions(layout, listed, law, friction)
    ours = [Path(__file__).with_name(name).read_text() for name in ("linear.py", "friction.py")]
    made_of = (source_hash(), *ours, version("casadi"), layout, law, friction)
    key = sha256(repr(made_of).encode()).hexdigest()
    folder = user_cache_path("tracktrain") / "linear"
    places = [folder / f"{key}_{name}.casadi" for name in FUNCTIONS]
    with suppress(OSError, RuntimeError):  # not there, or not whole
        texts = [place.read_bytes().decode("latin-1") for place in places]
        return tuple(map(ca.Function.deserialize, texts))
    built = _functions(layout, listed, law, friction)
    with suppress(UnwrittenError):  # without a cache they are built each time
        for place, function in zip(places, built, strict=True):
            with whole_file(place) as new:
                new.write_bytes(function.serialize().encode("latin-1"))
    return built


def _functions(
    layout: Layout, listed: Blocks, law: int, friction: Friction
) -> tuple[ca.Function, ...]:
    """(parameters of each block, omega, speed) -> A, for a creep law and kinds of friction; and
    with weights of its elements, the derivative of their sum along each parameter and the speed."""
    blocks = dict(listed)
    p = {name: ca.SX.sym(f"p_{name}", len(b.parameters)) for name, b in blocks.items()}
    omega, speed = ca.SX.sym("omega"), ca.SX.sym("speed")
    stuck = _jacobian(layout, blocks, p, speed, law)
    states = _states(layout, blocks)
    matrix = ca.densify(_with_friction(states, stuck, p["truck"], dict(friction), omega))
    along = ca.vertcat(*p.values(), speed)
    weights = ca.SX.sym("weights", *matrix.shape)
    slopes = ca.jtimes(ca.vec(matrix), along, ca.vec(weights), True)
    arguments = [*p.values(), omega, speed]
    return (
        ca.Function("matrix", arguments, [matrix]),
        ca.Function("slopes", [*arguments, weights], [ca.densify(slopes)]),
    )


def _jacobian(
    layout: Layout,
    blocks: Mapping[str, Block],
    p: Mapping[str, ca.SX],
    speed: ca.SX,
    law: int,
) -> ca.SX:
    """A with friction stuck, by closing the connections symbolically."""
    own = {instance: blocks[kind] for instance, kind in layout.blocks.items() if kind in blocks}
    source = {c.target: c.source for c in layout.connections()}
    derived = {name: block.functions.derived(p[name]) for name, block in blocks.items()}
    x = {name: ca.SX.sym(f"x_{name}", len(own[name].continuous)) for name in layout.bodies}
    known: dict[tuple[str, frozenset[int]], ca.SX] = {}

    def arguments(instance: str, needed: frozenset[int]) -> list[ca.SX]:
        block, kind = own[instance], layout.blocks[instance]
        memory = ca.SX.zeros(len(block.memory))
        state = ca.vertcat(x.get(instance, ca.SX(0, 1)), memory)
        inputs = ca.SX([port.start for port in block.inputs])
        for place in needed:
            target = f"{instance}.{block.inputs[place].name}"
            if target in source:
                inputs[place] = output(source[target])
        return [state, inputs, p[kind], derived[kind]]

    def output(name: str) -> ca.SX:
        instance, _, variable = name.partition(".")
        if instance == layout.track:
            return speed if name == layout.speed else ca.SX(0)
        block = own[instance]
        # Of a block with a choice of laws the one that is chosen: only that has plain expressions.
        laws = block.output_branches() if block.switch else []
        function = laws[law - 1] if laws else block.functions.outputs
        place = [port.name for port in block.outputs].index(variable)
        row = function.jac_sparsity(0, 1).T
        needed = frozenset(row.row()[row.colind()[place] : row.colind()[place + 1]])
        if (instance, needed) not in known:
            found = function.expand().call([*arguments(instance, needed), ca.SX(0, 0)])
            known[instance, needed] = found[0]
        return known[instance, needed][place]

    rates = []
    for instance in layout.bodies:
        every = frozenset(range(len(own[instance].inputs)))
        rates.append(own[instance].functions.derivative(*arguments(instance, every)))
    all_x = ca.vertcat(*x.values())
    slope = ca.jacobian(ca.vertcat(*rates), all_x)
    return ca.substitute(slope, all_x, ca.SX.zeros(*all_x.shape))


def _with_friction(
    states: Sequence[str], stuck: ca.SX, p: ca.SX, friction: Mapping[str, str], omega: ca.SX
) -> ca.SX:
    """A with the elements' friction as it is to stand for.

    A is affine in each friction stiffness: its derivative is what a unit spring in the element's
    place does. The same moved from the columns of the positions to those of the rates is what a
    unit damper does.
    """
    names = [parameter.name for parameter in _blocks()["truck"].parameters]

    def of(element: str, which: str) -> ca.SX:
        return p[names.index(f"{element}.{which}")]

    moved, total = ca.sparsify(to_rates(states)), stuck
    for element, kind in friction.items():
        if kind == "stuck":
            continue
        stiffness, limit = of(element, "friction_stiffness"), of(element, "friction_limit")
        spring = ca.reshape(ca.jtimes(ca.vec(stuck), stiffness, ca.SX(1)), *stuck.shape)
        total = total - stiffness * spring
        if kind == "damper":
            has_stop = of(element, "stop_stiffness") > 0
            amplitude = ca.if_else(has_stop, of(element, "free_play"), LARGE * limit / stiffness)
            total = total + damping(limit, amplitude, omega) * (spring @ moved)
    return total
