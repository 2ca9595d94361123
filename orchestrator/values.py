"""Start values: which variables take one, and from what the user gives to what the FMU gets."""

from __future__ import annotations

import math

from .description import Description, Variable
from .errors import UnitError, ValueRefusedError, choices
from .system import Value
from .units import conversion, quantity

WHOLE = ("Integer", "Enumeration")
NO_UNIT = (None, "", "1")


def settable(description: Description) -> list[str]:
    """Names of the variables that may be given a value before the run."""
    return [v.name for v in description.variables.values() if _takes_value(v)]


def resolve(
    instance: str, description: Description, name: str, value: Value
) -> tuple[Variable, Value]:
    """The variable and the value [its unit, its type]; raises ValueRefusedError or UnitError."""
    variable = description.variables.get(name)
    full = f"{instance}.{name}"
    if variable is None:
        names = [v for v in settable(description) if v not in description.partials]
        raise ValueRefusedError(
            f"{instance} ({description.label}) has no variable '{name}'; {choices(name, names)}"
        )
    if not _takes_value(variable):
        raise ValueRefusedError(
            f"{full} cannot be given a value: it is a {variable.variability} {variable.causality}; "
            "parameters and inputs can"
        )
    if variable.type == "String":
        return variable, str(value)
    if variable.type == "Boolean":
        return variable, _boolean(full, value)
    if isinstance(value, str) and value.strip() in variable.items:
        return variable, variable.items[value.strip()]
    number = _number(full, variable, description, value)
    if not math.isfinite(number):
        raise ValueRefusedError(f"{full} cannot be {number:g}: a finite number is needed")
    if variable.type in WHOLE:
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
    return variable, int(number) if variable.type in WHOLE else number


def _takes_value(variable: Variable) -> bool:
    if variable.variability == "constant" or variable.causality == "independent":
        return False
    if variable.causality in ("parameter", "input"):
        return True
    return variable.initial in ("exact", "approx")


def _boolean(full: str, value: Value) -> bool:
    named = {"true": True, "false": False, "1": True, "0": False}
    key = str(int(value)) if isinstance(value, float) and value in (0.0, 1.0) else str(value)
    if key.strip().lower() not in named:
        raise ValueRefusedError(f"{full} cannot be '{value}': it is true or false")
    return named[key.strip().lower()]


def _number(full: str, variable: Variable, description: Description, value: Value) -> float:
    if not isinstance(value, str):
        return float(value)
    unit = variable.unit or ""
    try:
        number, given = quantity(value)
    except UnitError:
        example = "'1'" if unit in NO_UNIT else f"'1 {unit}'"
        wanted = f"one of: {', '.join(variable.items)}" if variable.items else example
        raise ValueRefusedError(f"{full} cannot be '{value}'; write it like {wanted}") from None
    if not given:
        return number
    try:
        found = conversion(given, unit, description.units, description.units)
    except UnitError as error:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': {error}; its unit is {unit or '1'}"
        ) from None
    if found is None:
        raise ValueRefusedError(
            f"{full} cannot be '{value}': {given} cannot be converted to its unit, {unit or '1'}"
        )
    gain, offset = found
    return gain * number + offset
