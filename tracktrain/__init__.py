"""A freight car on irregular track: four building blocks as FMUs, coupled by an orchestrator.

`hopper_car` is the 80-ton hopper car as a system of eight instances.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from .car.hopper import hopper_car

__all__ = ["hopper_car"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("tracktrain")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
