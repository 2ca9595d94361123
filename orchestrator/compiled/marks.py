"""Marks of the Python functions that there is C of, too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

REASSOCIATED: set[Callable[..., Any]] = set()
"""Functions whose sums may be added up in any order."""


def in_c(function: F) -> F:
    """Say of a function that compiled code calls it: it is written in the subset of `translate`."""
    return function


def in_any_order(function: F) -> F:
    """Say the same of one whose result does not depend on the order in which its sums are added."""
    REASSOCIATED.add(function)
    return function
