"""What can go wrong with what a user asks for."""

from __future__ import annotations


class TracktrainError(Exception):
    """Base of this package's errors; the message is meant for the user."""


class HopperError(TracktrainError, ValueError):
    """A hopper car that does not exist was asked for."""
