"""Start values: which variables take one, and from what the user gives to what the FMU gets."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from ..errors import UnitError, ValueRefusedError, choices
from ..fmu.arrays import MOST, element_names, shaped
from ..fmu.description import Description, Variable
from ..fmu.types import TYPES
from ..fmu.units import Quantity, Unit
from ..system.system import Value

WHOLE = ("integer", "enumeration")
NO_UNIT = (None, "", "1")

_WHOLE_NUMBER = re.compile(r"\s*[+-]?\d+\s*")


def resolve(
    instance: str, description: Description, name: str, value: Value
) -> list[tuple[Variable, Value]]:
    """Variables and values [their units, their types]: one, or those of an array's elements.

    Raises ValueRefusedError or UnitError.
    """
    shape = description.arrays.get(name)
    if shape is not None and name not in description.variables:
        elements = element_names(name, shape)
        given = _elements(f"{instance}.{name}", shape, value)
        return [
            _resolve(instance, description, element, each)
            for element, each in zip(elements, given, strict=True)
        ]
    return [_resolve(instance, description, name, value)]


def _resolve(
    instance: str, description: Description, name: str, value: Value
) -> tuple[Variable, Value]:
    variable = description.find(name)
    full = f"{instance}.{name}"
    if variable is None:
        raise description.unknown(instance, name)
    if not variable.takes_value:
        raise ValueRefusedError(
            f"{full} cannot be given a value: it is a {variable.variability} {variable.causality}; "
            "parameters and inputs can"
        )
    if variable.kind == "clock":
        raise ValueRefusedError(f"{full} cannot be given a value: it is a clock")
    if variable.shape:
        raise ValueRefusedError(
            f"{full} cannot be given a value: it is an array of {shaped(variable.shape)}; those of "
            f"up to {MOST} elements can"
        )
    if isinstance(value, list | tuple):
        raise ValueRefusedError(f"{full} cannot be {list(value)}: it is no array")
    if variable.kind == "string":
        return variable, str(value)
    if variable.kind == "binary":
        return variable, _digits(full, value)
    if variable.kind == "boolean":
        return variable, _boolean(full, value)
    if isinstance(value, str) and value.strip() in variable.items:
        return variable, variable.items[value.strip()]
    number = _number(full, variable, description, value)
    if not math.isfinite(number):
        raise ValueRefusedError(f"{full} cannot be {number:g}: a finite number is needed")
    if variable.kind in WHOLE:
        if variable.items and number not in variable.items.values():
            raise ValueRefusedError(
                f"{full} has no item '{value}'; {choices(str(value), variable.items)}, or a number "
                f"from {min(variable.items.values())} to {max(variable.items.values())}"
            )
        if number != int(number):
            raise ValueRefusedError(f"{full} cannot be {number:g}: it is a whole number")
    low, high = variable.minimum, variable.maximum
    if (low is not None and number < low) or (high is not None and number > high):
        unit = f" {variable.unit}" if variable.unit not in NO_UNIT else ""
        ends = [f"at least {low:g}{unit}"] if low is not None else []
        ends += [f"at most {high:g}{unit}"] if high is not None else []
        raise ValueRefusedError(
            f"{full} cannot be {number:g}{unit}: it must be {' and '.join(ends)}"
        )
    limits = TYPES[variable.type].limits
    if limits is not None and not limits[0] <= number <= limits[1]:
        raise ValueRefusedError(
            f"{full} cannot be {int(number)}: it is of type {variable.type}, from {limits[0]} "
            f"to {limits[1]}"
        )
    return variable, int(number) if variable.kind in WHOLE else float(number)


def _elements(full: str, shape: tuple[int, ...], value: Value) -> list[Value]:
    """A value for each element, from a list or from text such as "1 2 3 mm"; one is for all."""
    if isinstance(value, str):
        words = value.split()
        count = next((n for n, word in enumerate(words) if not _is_value(word)), len(words))
        unit = " ".join(words[count:])
        given: list[Value] = [f"{word} {unit}" if unit else word for word in words[:count]]
    else:
        given = [*_flat(value)]
    size = math.prod(shape)
    if len(given) == 1:
        return given * size
    if len(given) != size:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': it is an array of {shaped(shape)}, and {len(given)} "
            f"values were given; give {size}, or one for all"
        )
    return given


def _flat(value: Value) -> Iterator[Value]:
    """The numbers of lists in lists, in FMI's order."""
    if isinstance(value, list | tuple):
        for each in value:
            yield from _flat(each)
    else:
        yield value


def _is_value(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return word.lower() in ("true", "false")
    return True


def _digits(full: str, value: Value) -> str:
    """Bytes as hexadecimal digits, two for each."""
    try:
        return bytes.fromhex(str(value)).hex()
    except ValueError:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': it is of type Binary; give two hexadecimal digits for "
            "each byte, such as 666f6f"
        ) from None


def _boolean(full: str, value: Value) -> bool:
    named = {"true": True, "false": False, "1": True, "0": False}
    key = str(int(value)) if isinstance(value, float) and value in (0.0, 1.0) else str(value)
    if key.strip().lower() not in named:
        raise ValueRefusedError(f"{full} cannot be '{value}': it is true or false")
    return named[key.strip().lower()]


def _number(
    full: str, variable: Variable, description: Description, value: float | int | str
) -> float | int:
    if not isinstance(value, str):
        return value
    if variable.kind in WHOLE and _WHOLE_NUMBER.fullmatch(value):
        return int(value)  # all digits, of which a double has 15
    unit = variable.unit or ""
    try:
        given = Quantity.parsed(value)
    except UnitError:
        example = "'1'" if unit in NO_UNIT else f"'1 {unit}'"
        wanted = f"one of: {', '.join(variable.items)}" if variable.items else example
        raise ValueRefusedError(f"{full} cannot be '{value}'; write it like {wanted}") from None
    if not given.unit:
        return given.value
    try:
        own = Unit(unit, description.units, variable.difference)
        found = Unit(given.unit, description.units).to(own)
    except UnitError as error:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': {error}; its unit is {unit or '1'}"
        ) from None
    if found is None:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': {given.unit} cannot be converted to its unit, "
            f"{unit or '1'}"
        )
    gain, offset = found
    return gain * given.value + offset
