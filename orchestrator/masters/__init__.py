"""Masters: how the slaves are coupled over a macro step, one algorithm a file.

A master module has `prepare(plan, slaves, options) -> Prepared`: a compiled macro loop and
its tables.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from ..errors import (
    CouplingError,
    choices,
)

MASTERS = {
    "one-pass": "one_pass",
    "jacobi": "jacobi",
    "gauss-seidel": "gauss_seidel",
    "iterated": "iterated",
}
"""Name of each master and the module that has it."""


def master_module(name: str) -> ModuleType:
    """The module of a master; raises CouplingError for an unknown one."""
    if name not in MASTERS:
        raise CouplingError(f"there is no master '{name}'; {choices(name, MASTERS)}")
    return import_module(f".{MASTERS[name]}", __name__)
