"""The study of how certain the answers are: bands, what they come from, what to measure."""

from __future__ import annotations

from .study import command, uncertainty

__all__ = ["command", "uncertainty"]
