"""An instance apart from any run, that can be tried out and put back to its start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack

import numpy as np
from numpy.typing import NDArray

from ..errors import SlaveError
from ..fmu.description import Variable
from ..plan.plan import make_plan
from ..slaves import calls as ffi
from ..slaves.base import (
    Slave,
    Status,
)
from ..slaves.session import Session
from ..system.system import (
    Component,
    System,
)

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
        for variable, value in self._plan.values[0]:
            slave.set_value(variable, value)
        slave.start(self._start, self._start + SPAN)
        found = [v for v in self.inputs if v.name in self._given]
        slave.set_reals(found, np.array([self._given[v.name] for v in found]))
        slave.begin_stepping()
        self.time = self._start
        self.at_start = slave.get_reals(self.inputs)

    def set(self, values: Array) -> None:
        """Set all inputs."""
        self.slave.set_reals(self.inputs, np.ascontiguousarray(values))

    def get(self) -> Array:
        """Read all outputs."""
        return self.slave.get_reals(self.outputs)

    def step(self, size: float) -> None:
        """One step [s]."""
        addresses = self.slave.addresses
        self._check(
            "fmi2DoStep", ffi.do_step(addresses.do_step, addresses.instance, self.time, size)
        )
        self.time += size

    def save(self) -> None:
        """Keep the state, in the place of the one that was kept before."""
        function = self.slave.addresses.get_state
        self._check("fmi2GetFMUstate", self._state(function, self._handle.ctypes.data))
        self._saved_time = self.time

    def restore(self) -> None:
        """Go back to the state that was kept."""
        function = self.slave.addresses.set_state
        self._check("fmi2SetFMUstate", self._state(function, int(self._handle[0])))
        self.time = self._saved_time

    def directional(self, unknowns: Sequence[Variable], known: Variable) -> Array:
        """Derivatives of outputs with respect to an input, as the FMU gives them."""
        addresses, result = self.slave.addresses, np.zeros(len(unknowns))
        references = np.array([v.reference for v in (*unknowns, known)], np.uint32)
        seed = np.ones(1)
        status = ffi.directional(
            addresses.directional,
            addresses.instance,
            references.ctypes.data,
            len(unknowns),
            references[-1:].ctypes.data,
            1,
            seed.ctypes.data,
            result.ctypes.data,
        )
        self._check("fmi2GetDirectionalDerivative", status)
        return result

    def _state(self, function: int, argument: int) -> int:
        return ffi.state(function, self.slave.addresses.instance, argument)

    def _check(self, function: str, status: int) -> None:
        if status > Status.WARNING:
            raise SlaveError(f"{self.slave.fault(function, status)}{self.slave.said()}")

    def _close(self) -> None:
        if self._slave is not None:
            slave, self._slave = self._slave, None
            slave.free_state(int(self._handle[0]))
            self._handle[0] = 0
            self._open.close()
