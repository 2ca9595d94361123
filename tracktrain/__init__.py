"""A freight car on irregular track: four building blocks as FMUs, coupled by an orchestrator.

`hopper_car` is the 80-ton hopper car as a system of eight instances; `plot` draws
signals of runs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .car.hopper import hopper_car
    from .plotting import plot

__all__ = ["hopper_car", "plot"]


def __getattr__(name: str) -> Any:
    """Loaded when it is asked for: a command line wants its help at once."""
    if name == "hopper_car":
        return import_module(".car.hopper", __name__).hopper_car
    if name == "plot":
        return import_module(".plotting", __name__).plot
    if name == "__version__":
        return import_module("importlib.metadata").version("tracktrain")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
