"""The wheelrail block: one wheelset on its rails."""

from .block import WheelRail

__all__ = ["WheelRail"]
