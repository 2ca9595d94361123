"""Instances of FMI 3.0 FMUs for model exchange, their ports called through adaptors."""

from __future__ import annotations

from ..slaves.fmi3 import Fmi3Slave
from .model_exchange import Exchanging


class Fmi3Model(Exchanging, Fmi3Slave):
    """An instance of an FMI 3.0 FMU for model exchange."""

    wrapper = "FMU3Model"
    prefix, rates, update = "fmi3", "GetContinuousStateDerivatives", "updateDiscreteStates"

    def _instantiate(self, resources: str) -> None:
        self._fmu.component = self._fmu.fmi3InstantiateModelExchange(
            self.name.encode(),
            self.description.guid.encode(),
            resources.encode(),
            False,
            False,
            self.lanes.address,
            self._log,
        )
