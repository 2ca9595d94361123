"""The response study."""

from __future__ import annotations

from .study import command, response

__all__ = ["command", "response"]
