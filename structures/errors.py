"""What can go wrong in this package."""

from __future__ import annotations


class StructureError(Exception):
    """Base of this package's errors; the message is meant for the user."""
