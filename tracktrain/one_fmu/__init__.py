"""A coupled system as one FMU: its FMUs and their master, compiled together."""

from __future__ import annotations

from .build import build_one_fmu

__all__ = ["build_one_fmu"]
