"""What a study is given in a script, as people write it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import wraps
from inspect import signature
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from orchestrator import in_unit

P = ParamSpec("P")
R = TypeVar("R")


def taking(**units: str | list[str]) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Have a function take quantities as numbers [unit] or as text with a unit, and paths as text.

    units: by argument; in a list for one that takes several, or one alone. The wrapped function
    raises orchestrator.ValueRefusedError for what cannot be.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        known = signature(function)

        @wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            bound = known.bind(*args, **kwargs)
            for name, given in bound.arguments.items():
                if name in units:
                    bound.arguments[name] = _taken(given, units[name], name)
                elif "Path" in str(known.parameters[name].annotation) and isinstance(given, str):
                    bound.arguments[name] = Path(given)
            return function(*bound.args, **bound.kwargs)

        return call

    return decorate


def _taken(given: Any, unit: str | list[str], name: str) -> Any:
    if given is None:
        return None
    if isinstance(unit, str):
        return in_unit(given, unit, name)
    alone = isinstance(given, str) or not isinstance(given, Iterable)
    return tuple(in_unit(each, unit[0], name) for each in ([given] if alone else given))
