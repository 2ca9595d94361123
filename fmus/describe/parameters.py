"""Parameter sets: numbers of a car from TOML files, with unit, basis and source, to SI."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from ..names import NAMES
from .spread import FIELDS, Spread, check
from .units import MismatchError, gain, is_known
from .variables import BASES, Parameter

if TYPE_CHECKING:
    from .block import Block

FOLDER = Path(__file__).parents[1] / "parameters"
DEFAULT_SET = "loaded"
PARAMETER_SETS = (DEFAULT_SET, "empty", "report-linear")
SHARED = "vehicle"
TABLES = (SHARED, *NAMES)
NO_STOP = 1e3
"""Free play [m or rad] that `inf` in a file becomes, since an FMU's numbers are finite."""


@dataclass(frozen=True)
class Entry:
    """One number of a parameter file, as published.

    low, high, deviation: how far it may be off, in its unit; or `follows`: the parameter that it
    is in proportion to. spread: why so far, or why there is nothing of it.
    """

    value: float
    unit: str
    symbol: str
    basis: str
    source: str
    description: str
    low: float | None = None
    high: float | None = None
    deviation: float | None = None
    follows: str = ""
    spread: str = ""

    def to(self, unit: str) -> float:
        """The value in an FMI unit such as `N.m/rad`; raises as `units.gain`."""
        value = gain(self.unit, unit) * self.value
        return NO_STOP if math.isinf(value) else value

    def spread_in(self, unit: str) -> Spread | None:
        """Range or deviation in an FMI unit; None where the number has neither of its own."""
        if self.low is None and self.deviation is None:
            return None
        low, high, deviation = (
            None if number is None else gain(self.unit, unit) * number
            for number in (self.low, self.high, self.deviation)
        )
        return Spread(self.to(unit), low, high, deviation, self.spread)


INHERITED = ("symbol", "description")
"""Fields that an entry of a set which extends another may leave to that other."""


@dataclass(frozen=True)
class ParameterSet:
    """Numbers of one car. entries: by table, then by parameter name."""

    path: Path
    description: str
    entries: Mapping[str, Mapping[str, Entry]]

    @property
    def name(self) -> str:
        return self.path.stem

    def entry(self, name: str, *blocks: str) -> Entry | None:
        """Entry of a parameter in the blocks' tables, the first before the next, or shared.

        Without blocks in any table; None when no file gives it.
        """
        tables = (*blocks, SHARED) if blocks else tuple(self.entries)
        found = (self.entries.get(table, {}).get(name) for table in tables)
        return next((entry for entry in found if entry), None)

    def values(self, block: Block) -> dict[str, float]:
        """Values [SI] of all parameters of a block; raises ParameterError for a gap."""
        known = {parameter.name for parameter in block.parameters}
        own = {} if block.stands_for else self.entries.get(block.name, {})
        for name in own:
            if name not in known:
                raise ParameterError(
                    f"{self.path.name}: [{block.name}] gives {name!r}, which is no parameter of "
                    f"this block; it has {', '.join(sorted(known))}"
                )
        return {parameter.name: self._value(block, parameter) for parameter in block.parameters}

    def _value(self, block: Block, parameter: Parameter) -> float:
        kin = (block.stands_for,) if block.stands_for else ()
        entry = self.entry(parameter.name, block.name, *kin)
        place = f"{self.path.name}: {parameter.name} of the block {block.name!r}"
        if entry is None:
            if parameter.default is None:
                raise ParameterError(
                    f"{place} has no value; add it to [{block.name}], in a unit of "
                    f"{parameter.unit}, or to [{SHARED}] if blocks share it"
                )
            return parameter.default
        try:
            value = entry.to(parameter.unit)
        except MismatchError as error:
            hint = "; lb is a mass, lbf a force" if "lb" in entry.unit else ""
            raise ParameterError(
                f"{place} is given in {entry.unit!r}, which is {error.own}; "
                f"give it in a unit of {parameter.unit} {error.other}{hint}"
            ) from error
        low, high = parameter.minimum, parameter.maximum
        if (low is not None and value < low) or (high is not None and value > high):
            lowest, highest = (f"{v:g}" if v is not None else "any" for v in (low, high))
            raise ParameterError(
                f"{place} is {value:g} {parameter.unit}; give a value from {lowest} to {highest}"
            )
        return value


@cache
def parameter_set(name: str) -> ParameterSet:
    """The shipped parameter set of this name; raises ParameterError for an unknown one."""
    if name not in PARAMETER_SETS:
        raise ParameterError(
            f"there is no parameter set {name!r}; choose one of {', '.join(PARAMETER_SETS)}"
        )
    return load(FOLDER / f"{name}.toml")


def load(path: Path) -> ParameterSet:
    """The parameter set of a file and of those that it extends; raises ParameterError."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path} is no TOML: {error}") from error
    base = None
    if "extends" in content:
        base = load(_extended(path, content.pop("extends")))
    description = content.pop("description", "")
    entries = {table: dict(base.entries[table]) if base else {} for table in TABLES}
    for table, group in content.items():
        if table not in TABLES or not isinstance(group, dict):
            raise ParameterError(
                f"{path.name}: [{table}] is no table of a parameter set; "
                f"there are {', '.join(TABLES)}"
            )
        for name, given in _leaves(path, table, group):
            inherited = base.entries[table].get(name) if base else None
            if base and inherited is None:
                raise ParameterError(
                    f"{path.name}: [{table}] gives {name!r}, which {base.path.name} lacks; "
                    f"correct the name (there are {', '.join(base.entries[table])}) or add it there"
                )
            entries[table][name] = _entry(f"{path.name}: [{table}] {name}", given, inherited)
    _check_followers(path, entries)
    return ParameterSet(path, description, entries)


def _check_followers(path: Path, entries: Mapping[str, Mapping[str, Entry]]) -> None:
    """Raise ParameterError for a number that follows one which is not there, or which follows."""
    leaders = {n for group in entries.values() for n, e in group.items() if not e.follows}
    for table, group in entries.items():
        for name, entry in group.items():
            if entry.follows and entry.follows not in leaders:
                raise ParameterError(
                    f"{path.name}: [{table}] {name} follows {entry.follows!r}, which no table has, "
                    "or which follows another itself; name a parameter that has its own spread"
                )


def _extended(path: Path, name: object) -> Path:
    for folder in (path.parent, FOLDER):
        if (folder / f"{name}.toml").exists() and folder / f"{name}.toml" != path:
            return folder / f"{name}.toml"
    raise ParameterError(
        f"{path.name}: extends {name!r}, which is neither a file beside it nor one of the shipped "
        f"sets {', '.join(PARAMETER_SETS)}"
    )


def _leaves(
    path: Path, table: str, group: Mapping[str, Any], prefix: str = ""
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Names with dots and fields of all entries below a table."""
    for key, item in group.items():
        if not isinstance(item, dict):
            raise ParameterError(
                f"{path.name}: [{table}] {prefix}{key} is a bare {item!r}; an entry is written "
                "{ value = ..., unit = ..., symbol = ..., basis = ..., source = ..., "
                "description = ... }"
            )
        if item and all(isinstance(value, dict) for value in item.values()):
            yield from _leaves(path, table, item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", item


def _entry(place: str, given: Mapping[str, Any], inherited: Entry | None) -> Entry:
    """The entry with all its fields checked; the place stands in messages."""
    known = [field.name for field in fields(Entry)]
    needed = [name for name in known if name not in FIELDS]
    taken = {name: getattr(inherited, name) for name in INHERITED} if inherited else {}
    merged = {**taken, **given}
    missing = [name for name in needed if merged.get(name, "") == ""]
    if missing:
        raise ParameterError(f"{place} lacks {', '.join(missing)}; add it, every entry has it")
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise ParameterError(
            f"{place} has the unknown field {', '.join(unknown)}; the fields are {', '.join(known)}"
        )
    value = merged["value"]
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        raise ParameterError(f"{place}: the value {value!r} is no number; give one")
    if math.isinf(value) and not (value > 0 and place.endswith("free_play")):
        raise ParameterError(f"{place}: the value is {value}; only a free play may be inf")
    if merged["basis"] not in BASES:
        raise ParameterError(
            f"{place}: the basis {merged['basis']!r} is not known; it is one of {', '.join(BASES)}"
        )
    check(place, float(value), {name: given[name] for name in FIELDS if name in given})
    entry = Entry(**{**merged, "value": float(value)})
    if not is_known(entry.unit):
        raise ParameterError(
            f"{place}: the unit {entry.unit!r} is not known; write it like lbf*in/rad, kg*m**2, "
            "or 1 for a plain number"
        )
    return entry
