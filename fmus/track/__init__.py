"""The track block: irregularities of alignment, profile, cross-level and gauge."""

from .block import Track

__all__ = ["Track"]
