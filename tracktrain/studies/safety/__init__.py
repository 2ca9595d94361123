"""The study of safety: limits against speed, curve, load and profiles."""

from __future__ import annotations

from .study import command, safety

__all__ = ["command", "safety"]
