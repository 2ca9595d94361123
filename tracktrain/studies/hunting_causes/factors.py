"""The factors, as data: what each changes in a car's parameters, and what the field reports."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from itertools import combinations
from typing import Any

from ...car.hopper import parameters_of
from ...scales import MILE_PER_HOUR


@dataclass(frozen=True)
class Factor:
    """A change of a car; parameters by "block.parameter", in SI."""

    title: str
    basis: str
    source: str
    set: Mapping[str, float] = field(default_factory=dict)
    scale: Mapping[str, float] = field(default_factory=dict)
    by_axle_load: tuple[str, ...] = ()

    def changes(self, car: str) -> dict[str, float]:
        """The parameters that this factor gives a car; empty where it has them already."""
        own, loaded = parameters_of(car), parameters_of("loaded")

        def value(name: str) -> float:
            block, _, parameter = name.partition(".")
            return own[block][parameter]

        share = own["truck"]["axle_load"] / loaded["truck"]["axle_load"]
        changed = {**self.set}
        changed |= {name: factor * value(name) for name, factor in self.scale.items()}
        changed |= {name: share * value(name) for name in self.by_axle_load}
        return {name: new for name, new in changed.items() if new != value(name)}


@cache
def factors() -> dict[str, Factor]:
    """All factors by name."""
    return {
        name: Factor(**{**given, "by_axle_load": tuple(given.get("by_axle_load", ()))})
        for name, given in _data()["factors"].items()
    }


def field_speeds(car: str) -> tuple[float, float]:
    """Speeds [m/s] between which the field reports the onset of hunting of a car."""
    found = _data()["field"][car]
    return found["low"] * MILE_PER_HOUR, found["high"] * MILE_PER_HOUR


def field_frequency() -> float:
    """Frequency [Hz] that the field reports."""
    return float(_data()["field_frequency"]["value"])


def sets_of(names: Iterable[str], most: int) -> list[tuple[str, ...]]:
    """No factor, each alone, and together up to `most` of them."""
    known = tuple(names)
    return [chosen for size in range(most + 1) for chosen in combinations(known, size)]


def joined(car: str, names: Iterable[str]) -> dict[str, float]:
    """What the factors change in a car together; they touch different parameters."""
    changed: dict[str, float] = {}
    for name in names:
        changed |= factors()[name].changes(car)
    return changed


@cache
def _data() -> dict[str, Any]:
    return tomllib.loads(files(__package__).joinpath("factors.toml").read_text("utf-8"))
