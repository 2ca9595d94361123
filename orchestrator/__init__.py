"""Couples FMUs at fixed macro steps, and says how far the answer can be trusted.

system = System({"a": Component(Path("a.fmu")), "b": Component(Path("b.fmu"))},
                (Connection("a.force", "b.force"), Connection("b.v", "a.v")))
run = simulate(system, duration=8.0, step=1e-3)
run.dataset["b.v"].plot()
"""

from __future__ import annotations

from .bonds import BondResidual
from .checkpoint import read_checkpoint
from .description import Description, Tangent, Variable, describe
from .errors import OrchestratorError
from .linear import LinearModel, linearise
from .log import Log
from .mock import Mock
from .monolith import monolith
from .port_map import Port, PortMap, read_port_map
from .results import Run
from .session import Session
from .simulation import resume, simulate
from .system import Component, Connection, Experiment, PowerBond, System
from .transformation import Linear, Table
from .trust.refinement import verify

__all__ = [
    "BondResidual",
    "Component",
    "Connection",
    "Description",
    "Experiment",
    "Linear",
    "LinearModel",
    "Log",
    "Mock",
    "OrchestratorError",
    "Port",
    "PortMap",
    "PowerBond",
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
