"""A quantity over time that drives an input: points of a table, and straight lines between them."""

from __future__ import annotations

import csv
import hashlib
import math
import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

from ..errors import ProfileError, UnitError, choices
from ..files import content_of
from ..fmu.description import Description, Variable
from ..fmu.units import conversion, scale_of

DELIMITERS = (",", ";", "\t")
TIME = "time"

_COLUMN = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")


@dataclass(frozen=True)
class Profile:
    """Values [unit] at times [s], which increase; linear between. origin: where they were read.

    In a system it is a component with the output `name` and its rate. Raises ProfileError.
    """

    name: str
    unit: str
    times: tuple[float, ...]
    values: tuple[float, ...]
    origin: str = ""

    def __post_init__(self) -> None:
        if len(self.times) != len(self.values):
            self._fail(f"it has {len(self.times)} times and {len(self.values)} values")
        if len(self.times) < 2:
            self._fail("it needs at least two points")
        for place, pair in enumerate(zip(self.times, self.values, strict=True)):
            self.check_point(pair, self.times[place - 1] if place else -math.inf, "point", place)
        try:
            scale_of(self.unit)
        except UnitError as error:
            self._fail(f"{error}; write it like m/s, or 1 for a plain number")

    def check_point(self, pair: tuple[float, float], before: float, word: str, number: int) -> None:
        """Raise ProfileError unless a point is finite and later than the one before."""
        time, value = pair
        if not (math.isfinite(time) and math.isfinite(value)):
            self._fail(f"{word} {number} is ({time:g}, {value:g}); finite numbers are needed")
        if time <= before:
            self._fail(
                f"its times must increase: {time:g} s of {word} {number} follows {before:g} s"
            )

    @property
    def rate(self) -> str:
        """Name of the output that is the rate."""
        return f"der({self.name})"

    @property
    def description(self) -> Description:
        """As a model description would have it."""
        per_second = f"{self.unit}/s" if self.unit not in ("", "1") else "1/s"
        return Description(
            label=f"table {self.origin or self.name}",
            variables={
                self.name: Variable(self.name, 0, "Real", "output", unit=self.unit),
                self.rate: Variable(
                    self.rate, 1, "Real", "output", unit=per_second, derivative_of=self.name
                ),
            },
            saves_state=True,
            serializes_state=True,
            variable_step=True,
            sha256=self._sha256,
        )

    @cached_property
    def _sha256(self) -> str:
        """Of the numbers: a table that was changed is another one, as an FMU is."""
        said = repr((self.unit, self.times, self.values))
        return hashlib.sha256(said.encode()).hexdigest()

    def at(self, time: float) -> tuple[float, float]:
        """Value and rate [1/s] at a time [s]; at a point the rate is that of what follows."""
        place = min(max(bisect_right(self.times, time), 1), len(self.times) - 1)
        first, last = self.times[place - 1], self.times[place]
        low, high = self.values[place - 1], self.values[place]
        rate = (high - low) / (last - first)
        if time >= last:
            return high, rate
        return low + rate * (max(time, first) - first), rate

    def check_span(self, instance: str, start: float, stop: float) -> None:
        """Raise ProfileError for a run [s] that is longer than the table."""
        first, last = self.times[0], self.times[-1]
        slack = 1e-9 * max(1.0, abs(stop))
        if start < first - slack or stop > last + slack:
            self._fail(
                f"it goes from {first:g} to {last:g} s, but the run that it drives as {instance} "
                f"from {start:g} to {stop:g} s; extend the table, or run within it"
            )

    def _fail(self, problem: str) -> None:
        raise ProfileError(f"the table {self.origin or self.name}: {problem}")


def read_profile(
    path: Path | str,
    column: str | None = None,
    likely: Sequence[str] = (),
    units: Mapping[str, str] | None = None,
) -> Profile:
    """One column over time of a CSV file whose first line names them: "time [s],speed [ft/s]".

    column: which, where there are several; `likely` are names that are tried without it. units:
    of columns that have none in the file. Lines that begin with # are skipped. Raises ProfileError.
    """
    path = Path(path)
    lines = _lines(path)
    number, header = next(lines, (1, ""))
    delimiter = max(DELIMITERS, key=header.count)
    cells = _cells(header, delimiter)
    if len(cells) < 2 or not re.match(rf"\s*{TIME}\b|\s*t\b", cells[0], re.IGNORECASE):
        raise ProfileError(
            f"the table {path}: line {number} must name the columns, time first, each with its "
            f"unit, such as 'time [s],speed [ft/s]'; it is '{header.strip()[:60]}'"
        )
    columns = [_column(path, text, units or {}) for text in cells]
    names = [name for name, _ in columns]
    place = _wanted(path, names, column, likely)
    name, unit = columns[place]
    points = [
        _point(path, line, _cells(text, delimiter), len(columns), place) for line, text in lines
    ]
    gain = _seconds(path, columns[0][1])
    for (_, (before, _)), (line, (time, _)) in pairwise(points):
        if time <= before:
            raise ProfileError(
                f"the table {path}: its times must increase: {time:g} of line {line} follows "
                f"{before:g}"
            )
    times, values = (
        (tuple(of) for of in zip(*(p for _, p in points), strict=True)) if points else ((), ())
    )
    return Profile(name, unit, tuple(gain * t for t in times), values, path.name)


def write_profile(profile: Profile) -> str:
    """The table as CSV, with the columns' plain names in its first line, times in s."""
    rows = zip(profile.times, profile.values, strict=True)
    return "".join([f"{TIME},{profile.name}\n", *(f"{t!r},{v!r}\n" for t, v in rows)])


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Numbers and texts of the lines that say something."""
    try:
        text = content_of(path).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise ProfileError(f"the table {path} cannot be read: {reason.lower()}") from None
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield number, line


def _cells(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line], delimiter=delimiter), [])


def _column(path: Path, text: str, units: Mapping[str, str]) -> tuple[str, str]:
    """Name and unit that a cell of the first line gives."""
    match = _COLUMN.fullmatch(text)
    name, unit = (match[1], match[2]) if match else (text.strip(), None)
    unit = unit or units.get(name)
    if not name or unit is None:
        raise ProfileError(
            f"the table {path}: the column '{text.strip()}' has no unit; write it like "
            f"'{name or 'speed'} [m/s]', with 1 for a plain number"
        )
    try:
        scale_of(unit)
    except UnitError as error:
        raise ProfileError(f"the table {path}: the column '{name}': {error}") from None
    return name, unit


def _wanted(path: Path, names: list[str], column: str | None, likely: Sequence[str]) -> int:
    """Number of the column that is meant."""
    if column is None and len(names) == 2:
        return 1
    for name in [column] if column is not None else likely:
        if name in names[1:]:
            return names.index(str(name))
    asked = column or next(iter(likely), "")
    raise ProfileError(
        f"the table {path} has no column '{asked}'; {choices(asked, names[1:])} "
        "(written FILE:COLUMN)"
    )


def _point(
    path: Path, line: int, cells: list[str], count: int, place: int
) -> tuple[int, tuple[float, float]]:
    """Line, time and value."""
    if len(cells) != count:
        raise ProfileError(
            f"the table {path}: line {line} has {len(cells)} cells, and the first line {count}"
        )
    try:
        time, value = float(cells[0]), float(cells[place])
    except ValueError:
        bad = next(c for c in (cells[0], cells[place]) if not _is_number(c))
        said = f"'{bad.strip()}' is no number" if bad.strip() else "a cell is empty: a gap"
        raise ProfileError(f"the table {path}: line {line}: {said}") from None
    if not (math.isfinite(time) and math.isfinite(value)):
        raise ProfileError(
            f"the table {path}: line {line}: ({time:g}, {value:g}) is not finite; leave the line "
            "out, or fill it"
        )
    return line, (time, value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _seconds(path: Path, unit: str) -> float:
    """Seconds of one unit of time."""
    found = conversion(unit, "s")
    if found is None:
        raise ProfileError(
            f"the table {path}: its first column is in {unit}, which is no time; give s, min or ms"
        )
    return found[0]
