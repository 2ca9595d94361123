"""An instance of an FMI 3.0 FMU, called through adaptors."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from typing import TYPE_CHECKING

from fmpy import fmi3

from ..errors import SlaveError
from ..fmu.description import Description, Variable
from ..system.system import Value
from .fmu import FmuSlave, own_value
from .listener import Listener
from .status import fine, returned

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


class Fmi3Slave(FmuSlave):
    """An instance of an FMI 3.0 co-simulation FMU that was unzipped into `folder`."""

    wrapper = "FMU3Slave"
    """fmpy's class for it."""

    def __init__(
        self,
        name: str,
        description: Description,
        folder: Path,
        listener: Listener | None,
        lanes: Lanes,
    ) -> None:
        super().__init__(name, description, listener)
        self._given: dict[tuple[str, int], dict[int, Value]] = {}
        self.lanes: Lanes = lanes
        working_folder = Path.cwd()
        try:
            self._fmu = getattr(fmi3, self.wrapper)(
                guid=description.guid,
                unzipDirectory=str(folder),
                modelIdentifier=description.model_identifier,
                instanceName=name,
            )
        except Exception as error:  # fmpy raises plain exceptions
            raise SlaveError(f"{name}: {description.label} cannot be loaded: {error}") from None
        finally:
            os.chdir(working_folder)
        self._log = fmi3.fmi3LogMessageCallback(self._heard)
        self._instantiate(f"{folder / 'resources'}{os.sep}")
        if not self._fmu.component:
            raise SlaveError(f"{name}: {description.label} cannot be instantiated{self.said()}")
        self._check_statuses()
        self.addresses = self._bind(lanes)

    def _instantiate(self, resources: str) -> None:
        description = self.description
        self._update = fmi3.fmi3IntermediateUpdateCallback(
            self.lanes.intermediate_update if description.interpolates_inputs else 0
        )
        moving = [
            v.value_reference
            for v in description.inputs
            if v.coupled and description.interpolates(v)
        ]
        moving = list(dict.fromkeys(moving))
        required = (fmi3.fmi3ValueReference * len(moving))(*moving)
        self._fmu.component = self._fmu.fmi3InstantiateCoSimulation(
            self.name.encode(),
            description.guid.encode(),
            resources.encode(),
            False,
            False,
            description.has_events,
            description.returns_early,
            required,
            len(moving),
            self.lanes.address,
            self._log,
            self._update,
        )

    def set_value(self, variable: Variable, value: Value) -> None:
        lane = variable.lane
        if variable.held and variable.coupled:
            self.lanes.hold(variable, float(own_value(variable, value)))  # type: ignore[arg-type]
        if lane is not None and lane.size > 1:  # only whole arrays can be set: see `start`
            key = (variable.type, variable.value_reference)
            self._given.setdefault(key, {})[lane.element] = own_value(variable, value)
            return
        structural = variable.causality == "structuralParameter"
        if structural:
            self._call("refused to be configured", self._fmu.enterConfigurationMode)
        self._set(variable, value)
        if structural:
            unit = f" {variable.unit}" if variable.unit else ""
            what = f"cannot be configured with {variable.name} = {value}{unit}"
            self._call(what, self._fmu.exitConfigurationMode)

    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        self._set_arrays()
        self._begin = time
        self._call(
            "cannot be initialized",
            self._fmu.enterInitializationMode,
            tolerance=tolerance or self.description.tolerance,
            startTime=time,
            stopTime=stop,
        )
        inputs = {(v.type, v.value_reference): v for v in self.description.inputs if not v.held}
        for key, store in self.lanes.arrays().items():
            if key in inputs:  # of which an element may stay at its start
                values = self._call(
                    f"cannot read {inputs[key].name}",
                    self._accessor("get", inputs[key]),
                    [key[1]],
                    nValues=len(store),
                )
                store[:] = values

    def begin_stepping(self) -> None:
        self._call("cannot be initialized", self._fmu.exitInitializationMode)
        self._stepping = True
        if self.description.has_events:
            self._ask_intervals()
        status = self.lanes.begin_stepping(self._begin)
        if self.lanes.ended is not None:
            raise SlaveError(f"{self.name} asks to end the run at its start{self.said()}")
        if not fine(status):
            raise SlaveError(
                f"{self.name} ({self.description.label}) cannot leave event mode at its start: "
                f"it {returned(status)}{self.said()}"
            )

    def _ask_intervals(self) -> None:
        """Ask for the intervals of clocks that the description does not give."""
        for number, clock in enumerate(self.description.clocks):
            own = clock.triggered or clock.variability == "countdown"
            if own or clock.interval is not None:
                continue
            what = f"does not say how often its clock {clock.name} ticks"
            place = (fmi3.fmi3ValueReference * 1)(clock.reference)
            interval, shift = (fmi3.fmi3Float64 * 1)(), (fmi3.fmi3Float64 * 1)()
            qualifier = (fmi3.fmi3IntervalQualifier * 1)()
            self._call(what, self._fmu.getIntervalDecimal, place, interval, qualifier)
            self._call(what, self._fmu.getShiftDecimal, place, shift)
            if not interval[0] > 0.0:
                raise SlaveError(f"{self.name} ({self.description.label}) {what}")
            self.lanes.set_interval(number, interval[0], shift[0])

    def free_state(self, handle: int) -> None:
        if handle:
            self._fmu.freeFMUState(ctypes.c_void_p(handle))

    def _serialized(self) -> bytes:
        held = self._call("cannot save its state", self._fmu.getFMUState)
        try:
            return self._call("cannot serialize its state", self._fmu.serializeFMUState, held)
        finally:
            self._fmu.freeFMUState(held)

    def _deserialize(self, state: bytes) -> None:
        what = "cannot take the state of the checkpoint"
        held = self._call(what, self._fmu.deserializeFMUState, state)
        try:
            self._call(what, self._fmu.setFMUState, held)
        finally:
            self._fmu.freeFMUState(held)

    def _set_arrays(self) -> None:
        """Set the arrays of which elements were given, the others at their start."""
        elements: dict[tuple[str, int], list[Variable]] = {}
        for v in self.description.variables.values():
            if (v.type, v.value_reference) in self._given:
                elements.setdefault((v.type, v.value_reference), []).append(v)
        for key, given in self._given.items():
            ordered = sorted(elements[key], key=lambda v: v.lane.element if v.lane else 0)
            values = [given[n] if n in given else self._start_of(v) for n, v in enumerate(ordered)]
            whole = ordered[0].name.rpartition("[")[0]
            shown = " ".join(map(str, values))
            self._call(
                f"refused {whole} = {shown}", self._accessor("set", ordered[0]), [key[1]], values
            )

    def _start_of(self, variable: Variable) -> Value:
        start = variable.start
        if start is None:
            raise SlaveError(
                f"{self.name}.{variable.name} has no start value, since its array was resized; "
                "give values of all elements"
            )
        if variable.kind == "string":
            return start
        if variable.kind == "boolean":
            return start in ("true", "1")
        number = float(start) if variable.kind == "real" else int(start)
        return own_value(variable, number)

    def _heard(self, _: int, status: int, category: bytes, message: bytes) -> None:
        self.heard(status, (message or b"").decode(errors="replace").strip())
