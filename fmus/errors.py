"""What can go wrong in this package."""

from __future__ import annotations


class FmusError(Exception):
    """Base of this package's errors; the message is meant for the user."""


class ParameterError(FmusError, ValueError):
    """A parameter set or one of its files cannot be used."""
