"""Kinds of command-line values: quantities with units, names, assignments."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

import click

import orchestrator
from orchestrator import choices, is_pattern, picked

TYPED = "typed"
"""What a context knows a quantity by as it was typed, before the name of its parameter."""


class Quantity(click.ParamType):
    """A number above zero with a unit, converted to `unit`; `units` are some that it may have.

    most: the largest one, with its unit, if there is one. zero: nothing of it may be asked for.
    """

    def __init__(
        self,
        name: str,
        unit: str,
        units: Sequence[str],
        example: str,
        most: str | None = None,
        zero: bool = False,
    ) -> None:
        self.name, self.unit, self.units, self.example = name, unit, tuple(units), example
        self.most, self.zero = most, zero

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Value in `self.unit`; click.BadParameter for anything else than such a quantity."""
        if isinstance(value, float):
            return value
        if ctx is not None and param is not None:
            ctx.meta[f"{TYPED}.{param.name}"] = value
        try:
            given = orchestrator.Quantity.parsed(value)
        except orchestrator.UnitError:
            self.fail(f"'{value}' is not a number with a unit; {self._advice()}", param, ctx)
        if not math.isfinite(given.value):
            self.fail(f"'{value}' is not a finite number; {self._advice()}", param, ctx)
        if given.value < 0.0 or (given.value == 0.0 and not self.zero):
            least = "zero or more" if self.zero else "above zero"
            self.fail(f"a {self.name} of {value} cannot be run; it must be {least}", param, ctx)
        if not given.unit:
            self.fail(f"'{value}' has no unit; {self._advice()}", param, ctx)
        try:
            value = float(f"{given.to(self.unit):.15g}")  # 60 ft/s is 18.288 m/s, not a bit less
            if self.most and value > orchestrator.Quantity.parsed(self.most).to(self.unit):
                problem = f"a {self.name} of {given} is too large; give {self.most} at most"
                self.fail(problem, param, ctx)
            return value
        except orchestrator.DimensionError:
            dimension = given.dimension
            kind = dimension.strip("[]") if dimension.count("[") < 2 else dimension
            kind = kind or "plain number"
            problem = f"'{given}' is a {kind}, not a {self.name}; {self._advice()}"
        except orchestrator.UnitError:
            problem = f"'{given.unit}' is not a known unit; {choices(given.unit, self.units)}"
        self.fail(problem, param, ctx)

    def _advice(self) -> str:
        a = "an" if self.name[0] in "aeiou" else "a"
        return f'give {a} {self.name} such as "{self.example}" (units: {", ".join(self.units)})'


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

    patterns: whether `*` and `?` in the instance may stand for several. Where the command is given
    a file, only the file knows which instances there are.
    """

    name = "assignment"

    def __init__(
        self, instances: Callable[[], Collection[str]], example: str, patterns: bool = False
    ) -> None:
        self.instances, self.example, self.patterns = instances, example, patterns

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
        if not from_file and not self._known(instance):
            several = self.patterns and is_pattern(instance)
            problem = "no instance fits" if several else "there is no instance"
            self.fail(f"{problem} '{instance}'; {choices(instance, self.instances())}", param, ctx)
        return instance, name, right.strip()

    def _known(self, instance: str) -> bool:
        known = self.instances()
        several = self.patterns and is_pattern(instance)
        return instance in known or (several and bool(picked(instance, known)))


def each_once(
    ctx: click.Context, param: click.Parameter, given: Sequence[tuple[str, str, str]]
) -> Sequence[tuple[str, str, str]]:
    """What assignments say, each of something else; click.BadParameter where two are of one."""
    said: dict[str, str] = {}
    for instance, name, value in given:
        target = f"{instance}.{name}" if name else instance
        if target in said:
            raise click.BadParameter(
                f"{target} is given twice, as '{said[target]}' and as '{value}'; leave out one",
                ctx,
                param,
            )
        said[target] = value
    return given
