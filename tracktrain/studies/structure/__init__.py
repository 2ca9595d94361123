"""The structure study."""

from __future__ import annotations

from .study import command, structure

__all__ = ["command", "structure"]
