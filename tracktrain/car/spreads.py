"""What is not known exactly of a car: its uncertain numbers, each with how far it may be off.

for number in uncertain("loaded"):
    print(number.name, number.spread)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from fmus.catalogue import parameter_units
from fmus.describe.parameters import parameter_set
from fmus.describe.spread import Spread
from orchestrator import choices

from ..errors import HopperError
from .hopper import parameters_of, vehicle

BLOCKS = ("carbody", "truck", "wheelrail")
"""Blocks whose numbers a car has; those of the track describe no car."""


@dataclass(frozen=True)
class Uncertain:
    """A number of a car: the blocks that have it, its spread [SI], and what follows it.

    followers: factors of the parameters that change in proportion, by name.
    """

    name: str
    blocks: tuple[str, ...]
    unit: str
    description: str
    basis: str
    spread: Spread
    followers: Mapping[str, float] = field(default_factory=dict)

    def changes(self, value: float) -> dict[str, float]:
        """Parameters [SI] by name where this number has another value [SI]."""
        return {self.name: value} | {name: f * value for name, f in self.followers.items()}

    def matches(self, patterns: Iterable[str]) -> bool:
        """Whether a pattern fits its name, with or without a block before it."""
        names = [self.name, *(f"{block}.{self.name}" for block in self.blocks)]
        return any(fnmatchcase(name, pattern) for pattern in patterns for name in names)


def uncertain(car: str = "loaded", patterns: Sequence[str] = ("*",)) -> list[Uncertain]:
    """The uncertain numbers of a car whose names fit a pattern, as "wheelrail.*" or "warp.*".

    Those that follow another are not listed beside it: they change with it. Raises HopperError
    where nothing fits.
    """
    given, values = parameter_set(vehicle(car).parameters), parameters_of(car)
    at = {name: value for block in BLOCKS for name, value in values[block].items()}
    entries = {
        block: {name: entry for name in values[block] if (entry := given.entry(name, block))}
        for block in BLOCKS
    }
    following = {n: e.follows for own in entries.values() for n, e in own.items() if e.follows}
    found: dict[str, Uncertain] = {}
    for block, own in entries.items():
        units = parameter_units(block)
        for name, entry in own.items():
            spread = entry.spread_in(units[name])
            if spread is None:
                continue
            before = found[name].blocks if name in found else ()
            followers = {n: at[n] / spread.value for n, of in following.items() if of == name}
            found[name] = Uncertain(
                name,
                (*before, block),
                units[name],
                entry.description,
                entry.basis,
                spread,
                followers,
            )
    chosen = [number for number in found.values() if number.matches(patterns)]
    if not chosen:
        wanted = ", ".join(patterns)
        raise HopperError(f"no uncertain number is called '{wanted}'; {choices(wanted, found)}")
    return chosen
