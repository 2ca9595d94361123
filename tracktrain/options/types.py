"""Kinds of command-line values: quantities with units, names, assignments."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

import click

from ..errors import choices

NUMBER_THEN_UNIT = re.compile(
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf)(?!\w))\s*(?P<unit>.*?)\s*",
    re.IGNORECASE,
)


class Quantity(click.ParamType):
    """A number above zero with a unit, converted to `unit`; `units` are some that it may have."""

    def __init__(self, name: str, unit: str, units: Sequence[str], example: str) -> None:
        self.name, self.unit, self.units, self.example = name, unit, tuple(units), example

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Value in `self.unit`; click.BadParameter for anything else than such a quantity."""
        if isinstance(value, float):
            return value
        match = NUMBER_THEN_UNIT.fullmatch(value)
        if match is None:
            self.fail(f"'{value}' is not a number with a unit; {self._advice()}", param, ctx)
        number, unit = float(match["number"]), match["unit"]
        if not math.isfinite(number):
            self.fail(f"'{value}' is not a finite number; {self._advice()}", param, ctx)
        if number <= 0.0:
            self.fail(f"a {self.name} of {value} cannot be run; it must be above zero", param, ctx)
        if not unit:
            self.fail(f"'{value}' has no unit; {self._advice()}", param, ctx)
        return self._converted(number, unit, param, ctx)

    def _converted(
        self, number: float, unit: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        import pint

        registry = pint.get_application_registry()
        try:
            value = float(registry.Quantity(number, unit).to(self.unit).magnitude)
            return float(f"{value:.15g}")  # 60 ft/s is 18.288 m/s, not a rounding error less
        except pint.DimensionalityError as error:
            kind = str(error.dim1).strip("[]") or "plain number"
            message = f"'{number:g} {unit}' is a {kind}, not a {self.name}; {self._advice()}"
        except (pint.PintError, ValueError, TypeError, AttributeError, AssertionError):
            message = f"'{unit}' is not a known unit; {choices(unit, self.units)}"
        self.fail(message, param, ctx)

    def _advice(self) -> str:
        return f'give a {self.name} such as "{self.example}" (units: {", ".join(self.units)})'


class Name(click.ParamType):
    """One of `available`; a wrong one is answered with the closest match."""

    def __init__(self, name: str, available: Collection[str]) -> None:
        self.name, self.available = name, available

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        return f"[{'|'.join(self.available)}]"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value not in self.available:
            self.fail(
                f"there is no {self.name} '{value}'; {choices(value, self.available)}", param, ctx
            )
        return value


class Assignment(click.ParamType):
    """`instance.name=value`, split into the three; without a name where the example has none.

    Where the command is given a file, only the file knows which instances there are.
    """

    name = "assignment"

    def __init__(self, instances: Callable[[], Collection[str]], example: str) -> None:
        self.instances, self.example = instances, example

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str, str]:
        target, equals, right = value.partition("=")
        instance, dot, name = target.strip().partition(".")
        named = "." in self.example.partition("=")[0]
        if not equals or not right.strip() or (named and not name) or (dot and not named):
            self.fail(f"'{value}' cannot be read; write it as {self.example}", param, ctx)
        run = ctx is not None and ctx.info_name == "run"
        from_file = run and ctx is not None and isinstance(ctx.params.get("file"), Path)
        if instance not in self.instances() and not from_file:
            self.fail(
                f"there is no instance '{instance}'; {choices(instance, self.instances())}",
                param,
                ctx,
            )
        return instance, name, right.strip()
