"""What callers give, as people write it: quantities, names, paths. What cannot be is refused."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import Field, fields
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from ..errors import UnitError, ValueRefusedError, choices
from .units import Quantity


def in_unit(given: Any, unit: str, name: str) -> float:
    """A number [unit], or text with a unit such as "60 ft/s", as a number [unit].

    name: what it is called in a message. Raises ValueRefusedError.
    """
    if isinstance(given, Real) and not isinstance(given, bool):
        return float(given)
    advice = f"give a number [{unit}], or text with a unit, as in '1 {unit}'"
    if unit == "1":
        advice = "give a number"
    if not isinstance(given, str):
        raise ValueRefusedError(f"{name} cannot be {given!r:.100}: {advice}")
    try:
        found = Quantity.parsed(given)
        if not found.unit and found.value != 0.0 and unit != "1":
            raise ValueRefusedError(
                f"{name} cannot be '{given:.100}': the unit is missing; {advice}"
            )
        value = found.value if not found.unit else found.to(unit)
    except UnitError as error:
        raise ValueRefusedError(f"{name} cannot be '{given:.100}': {error}; {advice}") from None
    return float(f"{value:.15g}")  # 60 ft/s is 18.288 m/s, not a bit less


def several(given: str | Iterable[str], name: str) -> tuple[str, ...]:
    """Names or patterns, of which one may stand alone; raises ValueRefusedError."""
    if isinstance(given, str):
        return (given,)
    found = tuple(given) if isinstance(given, Iterable) else (given,)
    if not all(isinstance(each, str) for each in found):
        raise ValueRefusedError(f"{name} cannot be {given!r:.100}: give a name, or a list of names")
    return found


def take_fields(data: Any) -> None:
    """Have the fields of frozen data, each an `options.option`, what was meant by what was given.

    Quantities and names as above, paths as text; raises ValueRefusedError for what cannot be.
    """
    for stated in fields(data):
        given = getattr(data, stated.name)
        if stated.metadata and not (given is None and stated.default is None):
            object.__setattr__(data, stated.name, _taken(stated, given))


def _taken(stated: Field[Any], given: Any) -> Any:
    said, name, kind = stated.metadata, stated.name, str(stated.type)
    if kind.startswith("tuple"):
        return several(given, name)
    if kind.startswith("Path"):
        if not isinstance(given, str | Path):
            raise ValueRefusedError(f"{name} cannot be {given!r:.100}: give a path")
        return Path(given)
    if kind == "bool":
        if not isinstance(given, bool):
            raise ValueRefusedError(f"{name} cannot be {given!r:.100}: it is True or False")
        return given
    if kind.startswith("str"):
        return _chosen(name, given, said["choices"])
    if kind == "int":
        if not isinstance(given, Integral) or isinstance(given, bool):
            raise ValueRefusedError(f"{name} cannot be {given!r:.100}: it is a whole number")
        return _bounded(name, int(given), said)
    return _bounded(name, in_unit(given, said["unit"] or "1", name), said)


def _chosen(name: str, given: Any, known: Sequence[str]) -> str:
    if not isinstance(given, str) or (known and given not in known):
        raise ValueRefusedError(f"{name} cannot be {given!r:.100}; {choices(str(given), known)}")
    return given


def _bounded(name: str, value: Any, said: Any) -> Any:
    """The number, where it is within its bounds."""
    low, high, above = said["least"], said["most"], said["above"]
    ends = [f"at least {low:g}"] if low is not None else []
    ends += [f"at most {high:g}"] if high is not None else []
    ends += [f"above {above:g}"] if above is not None else []
    inside = (
        (low is None or value >= low)
        and (high is None or value <= high)
        and (above is None or value > above)
    )
    if not ends or (inside and math.isfinite(value)):  # a time without bounds is for the grid
        return value
    raise ValueRefusedError(f"{name} cannot be {value:g}: it must be {' and '.join(ends)}")
