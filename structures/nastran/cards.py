"""Nastran bulk data as cards: small, large and free fields, continuations, numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import StructureError

REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD]?([+-]?\d+))?")
SIGNED = re.compile(r"(?<=[\d.])([+-]\d+)$")
BEGIN = re.compile(r"^\s*BEGIN\s+BULK", re.IGNORECASE)
ENTRIES = 8
"""Data fields of a line."""


@dataclass(frozen=True)
class Card:
    """One entry: name, fields (the first is field 2 of the line), and where it stands."""

    file: str
    line: int
    name: str
    fields: tuple[str, ...]

    @property
    def title(self) -> str:
        """Name and number."""
        return f"{self.name} {self.field(1)}".strip()

    def field(self, number: int) -> str:
        """Data field of this number, from 1; blank beyond the card."""
        return self.fields[number - 1] if number <= len(self.fields) else ""

    def line_of(self, number: int) -> Sequence[str]:
        """Eight data fields of a line of the card, from 0."""
        return [self.field(ENTRIES * number + n) for n in range(1, ENTRIES + 1)]

    @property
    def lines(self) -> int:
        return -(-len(self.fields) // ENTRIES)

    def error(self, text: str) -> StructureError:
        return StructureError(f"{self.file}, line {self.line}: {self.title} {text}")

    def whole(self, number: int, what: str, default: int | None = None) -> int:
        """A whole number; raises StructureError where it is none, or blank without a default."""
        text = self.field(number)
        if not text:
            if default is None:
                raise self._blank(number, what)
            return default
        if not re.fullmatch(r"[+-]?\d+", text):
            raise self.error(f"has '{text}' as its {what} (entry {number}); write a whole number")
        return int(text)

    def real(self, number: int, what: str, default: float | None = None) -> float:
        """A number; 1.0-3 is 0.001. Raises StructureError as `whole` does."""
        text = self.field(number)
        if not text:
            if default is None:
                raise self._blank(number, what)
            return default
        if not REAL.fullmatch(text):
            raise self.error(
                f"has '{text}' as its {what} (entry {number}); write a number such as 0.25, 2.5-1 "
                "or 2.5E-1"
            )
        return float(SIGNED.sub(r"e\1", re.sub("[dD]", "e", text)) if "e" not in text.lower()
                     else re.sub("[dD]", "e", text))  # fmt: skip

    def reals(self, first: int, what: str, count: int = 3) -> tuple[float, ...]:
        """So many numbers from a field on, each 0 where it is blank."""
        return tuple(self.real(first + n, what, 0.0) for n in range(count))

    def _blank(self, number: int, what: str) -> StructureError:
        return self.error(
            f"lacks its {what} (entry {number} is blank, or the line is cut off); write it"
        )


def read_cards(path: Path) -> list[Card]:
    """The cards of a deck's bulk data, in order. Raises StructureError with the line."""
    found: list[Card] = []
    for number, line in _bulk_lines(path):
        name, fields, more = _split(path.name, number, line)
        if more:
            if not found:
                raise StructureError(
                    f"{path.name}, line {number} goes on with a card, and there is none before it: "
                    f"{line.strip()[:40]}"
                )
            last = found[-1]
            width = 4 if len(last.fields) % ENTRIES == 4 and len(fields) == 4 else ENTRIES
            padded = (*last.fields, *[""] * (-len(last.fields) % width))
            found[-1] = Card(last.file, last.line, last.name, (*padded, *fields))
        else:
            found.append(Card(path.name, number, name, tuple(fields)))
    return [Card(c.file, c.line, c.name, _trimmed(c.fields)) for c in found]


def text_of(path: Path, wanted: str) -> str:
    """The text of a file; raises StructureError for one that is none. wanted: what it should be."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise StructureError(f"{path} cannot be read: {error.strerror}") from error
    if b"\0" in content[:4096] or content.startswith(b"PK"):
        raise StructureError(
            f"{path.name} is no text but a file of another kind (OP2 or HDF5 results are not "
            f"read); {wanted}"
        )
    return content.decode("latin-1")


def _bulk_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Lines of the bulk data with their numbers, without comments."""
    text = text_of(path, "give the bulk data as text (.bdf, .dat, .nas)")
    lines = list(enumerate(text.splitlines(), start=1))
    start = next((n for n, line in lines if BEGIN.match(line)), 0)
    any_card = False
    for number, line in lines[start:]:
        bare = line.partition("$")[0].rstrip().expandtabs(8)
        if not bare:
            continue
        if bare.strip().upper().startswith("ENDDATA"):
            return
        if bare.strip().upper().startswith("INCLUDE"):
            raise StructureError(
                f"{path.name}, line {number}: INCLUDE is not followed; put the files into one "
                f"({bare.strip()[:60]})"
            )
        any_card = True
        yield number, bare
    if not any_card:
        raise StructureError(f"{path.name} has no bulk data; is it a file of another kind?")


def _split(file: str, number: int, line: str) -> tuple[str, list[str], bool]:
    """Name, data fields, and whether the line goes on with the card before it."""
    if "," in line:
        parts = [part.strip() for part in line.split(",")]
        head, data = parts[0], parts[1:]
        count = 4 if head.endswith("*") or head.startswith("*") else ENTRIES
        if len(data) > count + 1 and any(data[count + 1 :]):
            raise StructureError(
                f"{file}, line {number} has {len(data)} entries in free field; a line has {count} "
                f"and a mark of continuation: {line[:60]}"
            )
        fields = (data + [""] * count)[:count]
    else:
        head = line[:8].strip()
        large = head.endswith("*") or head.startswith("*")
        width, count = (16, 4) if large else (8, ENTRIES)
        padded = line[8:].ljust(width * count)
        fields = [padded[width * n : width * (n + 1)].strip() for n in range(count)]
    more = not head or head[0] in "+*"
    name = head.rstrip("*").strip().upper()
    if not more and not re.fullmatch(r"[A-Z][A-Z0-9]{0,7}", name):
        raise StructureError(
            f"{file}, line {number} begins with '{head[:24]}', which is no name of a card; is this "
            "a Nastran bulk data file, and is the line whole?"
        )
    return name, fields, more


def _trimmed(fields: Sequence[str]) -> tuple[str, ...]:
    """Without blank fields at the end; blanks inside a number (2.5 E-1) are not allowed for."""
    count = len(fields)
    while count and not fields[count - 1]:
        count -= 1
    return tuple(fields[:count])
