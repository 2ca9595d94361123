"""Couples FMUs at fixed macro steps, and says how far the answer can be trusted.

system = System({"a": Component(Path("a.fmu")), "b": Component(Path("b.fmu"))},
                (Connection("a.force", "b.force"), Connection("b.v", "a.v")))
run = simulate(system, duration=8.0, step=1e-3)
run.dataset["b.v"].plot()
"""

from __future__ import annotations

from .errors import OrchestratorError
from .fmu.description import (
    Description,
    Tangent,
    Variable,
)
from .fmu.port_map import (
    Port,
    PortMap,
)
from .fmu.read import describe
from .fmu.units import Quantity
from .results.energy import BondResidual
from .results.run import Run
from .run.checkpoint import read_checkpoint
from .run.log import Log
from .run.simulate import (
    resume,
    simulate,
)
from .slaves.inline import InlineModel, Mock
from .slaves.session import Session
from .ssp.port_map import read_port_map
from .system.system import (
    Component,
    Connection,
    Experiment,
    PowerBond,
    System,
)
from .system.transformation import (
    Linear,
    Table,
)
from .whole.linearise import (
    LinearModel,
    linearise,
)
from .whole.monolith import monolith
from .whole.verify import verify

__all__ = [
    "BondResidual",
    "Component",
    "Connection",
    "Description",
    "Experiment",
    "InlineModel",
    "Linear",
    "LinearModel",
    "Log",
    "Mock",
    "OrchestratorError",
    "Port",
    "PortMap",
    "PowerBond",
    "Quantity",
    "Run",
    "Session",
    "System",
    "Table",
    "Tangent",
    "Variable",
    "describe",
    "linearise",
    "monolith",
    "read_checkpoint",
    "read_port_map",
    "resume",
    "simulate",
    "verify",
]
