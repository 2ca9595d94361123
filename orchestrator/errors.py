"""What can go wrong with a system of FMUs; every message is meant for the user."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence

WORD, TEXT = 400, 4000
"""Characters of a word, and of a text, above which only their ends are shown."""

_LONG = re.compile(rf"\S{{{WORD},}}")

CONSIDERED = 20_000
"""Names among which a close one is looked for."""


def plain(text: str) -> str:
    """Text from elsewhere as it can be shown: one line, not endless, no escape sequences.

    What cannot be printed stands as Python writes it, such as `\\x1b`.
    """
    if len(text) > TEXT:
        text = f"{text[: TEXT // 2]} ... {text[-TEXT // 2 :]}"
    return printable(_LONG.sub(_clipped, text))


def printable(text: str) -> str:
    """Text without what cannot be printed, escape sequences above all: `\\x1b` stands for it."""
    return text if text.isprintable() else "".join(map(_shown, text))


def _clipped(word: re.Match[str]) -> str:
    return f"{word[0][: WORD // 4]}...{word[0][-WORD // 10 :]}"


def _shown(character: str) -> str:
    if character.isprintable():
        return character
    if character.isspace() and character not in "\x1c\x1d\x1e\x1f\x85":
        return " "
    return character.encode("unicode_escape", "surrogatepass").decode()


class OrchestratorError(Exception):
    """Base of this package's errors; what they quote is shown by `plain`."""

    def __str__(self) -> str:
        return plain(super().__str__())


class FmuError(OrchestratorError):
    """An FMU file cannot be used."""


class ArchiveError(FmuError):
    """An archive is damaged, or not safe to unpack."""


class CouplingError(OrchestratorError):
    """Components, connections or bonds do not fit each other."""


class SspError(OrchestratorError):
    """A file of the SSP standard cannot be read, or a system cannot be written as one."""


class ValueRefusedError(OrchestratorError):
    """A value does not fit the variable that it is for."""


class UnitError(OrchestratorError):
    """A unit is not known, or does not fit."""


class DimensionError(UnitError):
    """A unit measures something else."""


class MixtureError(UnitError):
    """A difference meets what is none, in units whose zeros differ."""


class ProfileError(OrchestratorError):
    """A table cannot drive an input."""


class SlaveError(OrchestratorError):
    """An FMU could not be loaded, or refused what it was given before the run began."""


class InitializationError(OrchestratorError):
    """The values at the start do not settle."""


class ResultsError(OrchestratorError):
    """Results cannot be selected or written."""


class DamageError(ResultsError):
    """Results are not what the run wrote."""


class UnwrittenError(OrchestratorError):
    """A file cannot be written."""


class LogError(OrchestratorError):
    """A log cannot be kept as asked for."""


class CheckpointError(OrchestratorError):
    """A checkpoint cannot be written, or does not fit the run that is to go on from it."""


class RecordSizeError(ResultsError, MemoryError):
    """The results do not fit into memory."""


def choices(asked: object, available: Iterable[str], limit: int = 16) -> str:
    """`available` as a phrase, at most `limit` of them, after those that `asked` may have meant.

    These are up to three names that begin with it, or else are spelled much like it.
    """
    asked, names = str(asked), list(available)
    if not names:
        return "there are none"
    considered = [name for name in names[:CONSIDERED] if len(name) <= WORD]
    close = [name for name in considered if asked and name.startswith(asked)][:3]
    close = close or difflib.get_close_matches(asked[:WORD], considered, n=3, cutoff=0.6)
    guess = f"did you mean {' or '.join(close)}? " if close else ""
    return f"{guess}choose one of: {listed(names, limit)}"


def listed(names: Sequence[str], most: int = 8) -> str:
    """The first names as a phrase, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return f"{', '.join(names[:most])}{more}"
