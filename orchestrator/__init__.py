"""Couples FMUs at fixed macro steps, and says how far the answer can be trusted.

system = System({"a": Component(Path("a.fmu")), "b": Component(Path("b.fmu"))},
                (Connection("a.force", "b.force"), Connection("b.v", "a.v")))
run = simulate(system, duration=8.0, step=1e-3)
run.dataset["b.v"].plot()
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .errors import (
        ArchiveError,
        CouplingError,
        DimensionError,
        FmuError,
        OrchestratorError,
        UnitError,
    )
    from .fmu.archive import Archive, open_archive
    from .fmu.arrays import shaped, taken_apart
    from .fmu.description import Description, Tangent, Variable
    from .fmu.port_map import Port, PortMap
    from .fmu.read import Contents, describe, open_fmu, survey
    from .fmu.units import Quantity, conversion, scale_of
    from .masters.coupling import Way, couple, interpolated
    from .plan.plan import Plan, component_description, make_plan
    from .plan.ports import Problem, fit
    from .results.energy import BondResidual
    from .results.metrics import dominant_frequency, peak, rms
    from .results.run import Run
    from .run.checkpoint import read_checkpoint
    from .run.log import Log
    from .run.simulate import resume, simulate
    from .slaves.inline import InlineModel, Mock
    from .slaves.session import Session
    from .ssp import read_ssp, write_ssp
    from .ssp.port_map import read_port_map
    from .system.system import Component, Connection, Experiment, PowerBond, System, Value
    from .system.transformation import Linear, Table
    from .trust import CHECKS, self_tests
    from .whole.linearise import LinearModel, linearise
    from .whole.monolith import monolith
    from .whole.verify import verify

_PUBLIC = {
    "errors": (
        "ArchiveError",
        "CouplingError",
        "DimensionError",
        "FmuError",
        "OrchestratorError",
        "UnitError",
    ),
    "fmu.archive": ("Archive", "open_archive"),
    "fmu.arrays": ("shaped", "taken_apart"),
    "fmu.description": ("Description", "Tangent", "Variable"),
    "fmu.port_map": ("Port", "PortMap"),
    "fmu.read": ("Contents", "describe", "open_fmu", "survey"),
    "fmu.units": ("Quantity", "conversion", "scale_of"),
    "masters.coupling": ("Way", "couple", "interpolated"),
    "plan.plan": ("Plan", "component_description", "make_plan"),
    "plan.ports": ("Problem", "fit"),
    "results.energy": ("BondResidual",),
    "results.metrics": ("dominant_frequency", "peak", "rms"),
    "results.run": ("Run",),
    "run.checkpoint": ("read_checkpoint",),
    "run.log": ("Log",),
    "run.simulate": ("resume", "simulate"),
    "slaves.inline": ("InlineModel", "Mock"),
    "slaves.session": ("Session",),
    "ssp": ("read_ssp", "write_ssp"),
    "ssp.port_map": ("read_port_map",),
    "system.system": ("Component", "Connection", "Experiment", "PowerBond", "System", "Value"),
    "system.transformation": ("Linear", "Table"),
    "trust": ("CHECKS", "self_tests"),
    "whole.linearise": ("LinearModel", "linearise"),
    "whole.monolith": ("monolith",),
    "whole.verify": ("verify",),
}
"""The public names by the module that has them; one is imported when it is first asked for."""

_MODULE_OF = {name: module for module, names in _PUBLIC.items() for name in names}
__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_MODULE_OF[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
