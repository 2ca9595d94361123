"""The hunting study."""

from __future__ import annotations

from .study import command, hunting

__all__ = ["command", "hunting"]
