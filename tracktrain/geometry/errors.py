"""What can be wrong with track geometry."""

from __future__ import annotations

from ..errors import TracktrainError


class GeometryError(TracktrainError, ValueError):
    """Track geometry that cannot be taken; the message names the file, the line and what to do."""
