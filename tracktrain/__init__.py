"""A freight car on irregular track: four building blocks as FMUs, coupled by an orchestrator.

`hopper.hopper_car` is the 80-ton hopper car as a system of eight instances; `cli` is the command
`tracktrain`; `plots` draws what a run gave.
"""

from __future__ import annotations


def __getattr__(name: str) -> str:
    if name == "__version__":
        from importlib.metadata import version

        return version("tracktrain")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
