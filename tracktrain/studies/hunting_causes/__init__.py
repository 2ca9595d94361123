"""The study of what turns the hunting: one factor at a time, and in pairs."""

from __future__ import annotations

from .study import command, hunting_causes

__all__ = ["command", "hunting_causes"]
