"""The carbody block: rigid and elastic modes, exact over a step."""

from .block import Carbody

__all__ = ["Carbody"]
