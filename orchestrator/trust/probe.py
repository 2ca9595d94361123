"""An instance apart from any run, that can be tried out and put back to its start."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SlaveError
from ..fmu.description import Variable
from ..plan.plan import Plan, make_plan
from ..slaves.abi import DIRECTIONAL, DO_STEP, GET_STATE, SET_STATE
from ..slaves.base import Slave
from ..slaves.session import Session
from ..slaves.status import fine
from ..system.system import Component, System

Array = NDArray[np.float64]

SPAN = 60.0
"""Time for which an instance is said to be needed [s]."""

TIMEOUT = 60.0
"""Wall time of a call of an instance in a process of its own [s]."""


class Probe:
    """A fresh instance with the component's values, and what nothing connects at its start.

    inputs, outputs: those that masters exchange, but inputs for partial derivatives. given: values
    of inputs at the start, where they are not the FMU's own. Raises SlaveError.
    """

    def __init__(
        self,
        name: str,
        component: Component,
        session: Session,
        stack: ExitStack,
        *,
        start: float = 0.0,
        given: Mapping[str, float] | None = None,
        isolate: bool = False,
    ) -> None:
        self._system, self._session = System({name: component}), session
        self._plan = make_plan(self._system)
        self._start, self._given = start, given or {}
        self._isolate = [name] if isolate else []
        self.description = self._plan.descriptions[0]
        self.inputs = [
            v
            for v in self.description.inputs
            if v.coupled and v.name not in self.description.partials
        ]
        self.outputs = [v for v in self.description.outputs if v.coupled]
        self._handle = np.zeros(1, np.int64)
        self._slave: Slave | None = None
        self._open = ExitStack()
        stack.callback(self._close)
        self.open()

    @property
    def slave(self) -> Slave:
        assert self._slave is not None
        return self._slave

    @property
    def rolls_back(self) -> bool:
        return self.slave.rolls_back

    def open(self) -> None:
        """Be a new instance, at the start."""
        self._close()
        slave = self._session.slaves(
            self._system, self._plan, self._open, None, self._isolate, TIMEOUT
        )[0]
        self._slave = slave
        with slave.watched():
            self._begin(slave)
        self.time = self._start
        start = {v.name: (v, value) for v, value in self._plan.values[0]}
        start |= {v.name: (v, self._given[v.name]) for v in self.inputs if v.name in self._given}
        self.at_start = self.now = slave.inputs(self.inputs, [*start.values()])

    def _begin(self, slave: Slave) -> None:
        for variable, value in self._plan.values[0]:
            slave.set_value(variable, value)
        slave.start(self._start, self._start + SPAN)
        found = [v for v in self.inputs if v.name in self._given]
        slave.set_reals(found, np.array([self._given[v.name] for v in found]))
        slave.begin_stepping()

    def set(self, values: Array) -> None:
        """Set all inputs; `now` are those that were set last."""
        self.now = np.array(values)
        self.slave.set_reals(self.inputs, self.now)

    def get(self) -> Array:
        """Read all outputs."""
        return self.slave.get_reals(self.outputs)

    def step(self, size: float) -> None:
        """One step [s]."""
        self._check(DO_STEP, self.slave.call(DO_STEP, self.time, size, 1))
        self.time += size

    def save(self) -> None:
        """Keep the state, in the place of the one that was kept before."""
        self._check(GET_STATE, self.slave.call(GET_STATE, self._handle.ctypes.data))
        self._saved_time = self.time

    def restore(self) -> None:
        """Go back to the state that was kept."""
        self._check(SET_STATE, self.slave.call(SET_STATE, int(self._handle[0])))
        self.time = self._saved_time

    def directional(self, unknowns: Sequence[Variable], known: Variable) -> Array:
        """Derivatives of outputs with respect to an input, as the FMU gives them."""
        status, result = self.slave.directional(unknowns, known)
        self._check(DIRECTIONAL, status)
        return result

    def _check(self, function: int, status: int) -> None:
        if self.slave.ended_at() is not None:
            raise SlaveError(f"it asks to end the run{self.slave.said()}")
        if not fine(status):
            raise SlaveError(f"{self.slave.fault(function, status)}{self.slave.said()}")

    def _close(self) -> None:
        if self._slave is not None:
            slave, self._slave = self._slave, None
            slave.free_state(int(self._handle[0]))
            self._handle[0] = 0
            self._open.close()


@dataclass(frozen=True)
class Start:
    """A system at its start, of whose instances there can be probes.

    row: outputs by column of the plan. time [s]. isolate: instances in processes of their own.
    """

    system: System
    plan: Plan
    row: Array
    time: float = 0.0
    isolate: Collection[str] = ()

    def probe(self, i: int, session: Session, stack: ExitStack) -> Probe:
        """A fresh instance with the inputs that the run has at its start."""
        name, plan = self.plan.names[i], self.plan
        given = {
            k.input.name: float(
                k.gain * self.row[plan.column_of[k.source, k.output.name]] + k.offset
            )
            for k in plan.links_of(i)
        }
        return Probe(
            name, self.system.components[name], session, stack, start=self.time, given=given,
            isolate=name in self.isolate,
        )  # fmt: skip
