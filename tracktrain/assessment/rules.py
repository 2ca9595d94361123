"""The rules of limits.toml: what is measured how, and by what it is judged."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from orchestrator import Quantity, conversion, scale_of


class NotApplicableError(Exception):
    """Why a rule says nothing about a run."""


class ForeignError(NotApplicableError):
    """A rule looks at what the run's system does not have."""


@dataclass(frozen=True)
class Band:
    """Frequencies that are kept [Hz]; `around`: that far from the dominant one."""

    low: float = 0.0
    high: float = 0.0
    around: float = 0.0

    def __str__(self) -> str:
        if self.around:
            return f"dominant ± {self.around:g} Hz"
        return f"{self.low:g} to {self.high:g} Hz" if self.low else f"below {self.high:g} Hz"


@dataclass(frozen=True)
class Scope:
    """What a rule is for: other vehicles (`foreign`), or this car at these speeds [m/s]."""

    text: str
    foreign: bool = False
    least_speed: float = 0.0
    most_speed: float = math.inf

    def includes(self, speed: float) -> bool:
        """Whether a run whose largest speed is this [m/s] is judged by the rule."""
        return not self.foreign and self.least_speed <= speed <= self.most_speed


ANYTHING = Scope("")


@dataclass(frozen=True)
class Rule:
    """One line of the assessment.

    window: in m or s; limit: in `unit`, None for a formula's; sustained [s]: how long a moving
    value must last to count; stride [m]: way between two values that count, 0 for all.
    """

    key: str
    quantity: str
    statistic: str
    source: str
    verified: bool
    band: Band | None
    window: Quantity | None
    ignored: float
    limit: float | None
    formula: str
    unit: str
    at_least: bool
    inapplicable: str
    scope: Scope
    quote: str
    sustained: float
    stride: float

    @property
    def judged(self) -> bool:
        """Whether there is a limit at all."""
        return self.limit is not None or bool(self.formula)

    @property
    def over_way(self) -> bool:
        """Whether its window is a length."""
        return self.window is not None and conversion(self.window.unit, "m") is not None

    @property
    def shown_unit(self) -> str:
        return {"1": "", "g_0": "g", "m/s**2": "m/s²"}.get(self.unit, self.unit)


@cache
def rules() -> tuple[Rule, ...]:
    """All rules, in their order in the file."""
    return tuple(_rule(key, given) for key, given in content()["rules"].items())


@cache
def parameter(name: str) -> float:
    """A parameter that formulas share [SI]."""
    given = content()["parameters"][name]
    return to_si(given["value"], given["unit"])


def to_si(value: float, unit: str) -> float:
    """A value in SI."""
    scale = scale_of(unit)
    return scale.factor * value + scale.offset


def from_si(value: float, unit: str) -> float:
    """A value [SI] in a unit of the same dimension."""
    return value / to_si(1.0, unit)


def _rule(key: str, given: Mapping[str, Any]) -> Rule:
    limit = given.get("limit", {})
    window = given.get("window")
    band = {name: value for name, value in given.get("band", {}).items() if name != "unit"}
    return Rule(
        key=key,
        quantity=given["quantity"],
        statistic=given["statistic"],
        source=given["source"],
        verified=given["verified"],
        band=Band(**band) if band else None,
        window=Quantity(**window) if window else None,
        ignored=_si(given, "ignored"),
        limit=limit.get("value"),
        formula=limit.get("formula", ""),
        unit=limit.get("unit", "1" if "sperling" in key else "m/s**2"),
        at_least=given.get("at_least", False),
        inapplicable=given.get("inapplicable", ""),
        scope=_scope(given["scope"]) if "scope" in given else ANYTHING,
        quote=given.get("quote", ""),
        sustained=_si(given, "sustained"),
        stride=_si(given, "stride"),
    )


def _si(given: Mapping[str, Any], name: str) -> float:
    """A quantity [SI], 0 where there is none."""
    return to_si(**given[name]) if name in given else 0.0


@cache
def _scope(name: str) -> Scope:
    given = content()["scopes"][name]
    most = _si(given, "most_speed") or math.inf
    return Scope(given["text"], given.get("foreign", False), _si(given, "least_speed"), most)


@cache
def content() -> dict[str, Any]:
    """limits.toml."""
    return tomllib.loads((files(__package__) / "limits.toml").read_text(encoding="utf-8"))
