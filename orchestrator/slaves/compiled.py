"""Functions that C code calls in an FMU's place, with the interface of `Addresses`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..compiled.entries import CFunction
from .abi import FUNCTIONS, Addresses


class Adaptors:
    """Functions of this package that have the interface of `Addresses`, by their names there."""

    def __init__(self) -> None:
        self._functions: dict[str, CFunction] = {}

    def __call__(self, function: Callable[..., Any]) -> CFunction:
        """Take a function in, as a decorator."""
        name = function.__name__
        self._functions[name] = CFunction(function, FUNCTIONS[name].signature)
        return self._functions[name]

    def in_front_of(self, instance: int) -> Addresses:
        """What masters call, with the address that the functions take for the instance."""
        return Addresses(instance, *(self._functions[name].address for name in FUNCTIONS))
