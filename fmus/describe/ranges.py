"""What the laws of a block hold for: limits of its outputs, each with unit, basis and source."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import ParameterError
from .block import Block
from .units import MismatchError, gain
from .variables import BASES, Limit, Variable

FILE = "range.toml"
"""In the folder of a block; a file without limits says that the block's laws hold everywhere."""

TEXTS = ("beyond", "remedy", "basis", "source")

HOME = Path(__file__).parents[1]
"""The folder with those of the blocks."""


def range_of(block: Block) -> Sequence[Limit] | None:
    """What a block's laws hold for; None where nothing says so.

    A block that stands for another holds for the same, unless its own folder says otherwise.
    """
    if block.limits is not None:
        return block.limits
    found = (
        read_range(HOME / folder / FILE, block.outputs)
        for folder in (block.folder, block.stands_for)
        if folder
    )
    return next((limits for limits in found if limits is not None), None)


def read_range(path: Path, outputs: Iterable[Variable]) -> tuple[Limit, ...] | None:
    """The limits of a file, in its order, for a block with these outputs; None where there is none.

    Raises ParameterError for a file that is wrong.
    """
    if not path.exists():
        return None
    try:
        given = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterError(f"{path} is no TOML: {error}") from error
    units = {variable.name: variable.unit for variable in outputs}
    place = f"{path.parent.name}/{path.name}"
    return tuple(_limit(f"{place}: [{name}]", name, each, units) for name, each in given.items())


def _limit(place: str, name: str, given: Mapping[str, Any], units: Mapping[str, str]) -> Limit:
    missing = [field for field in ("outputs", *TEXTS) if not given.get(field)]
    if missing or not {"least", "largest"} & given.keys():
        wanted = ", ".join(missing or ["least or largest"])
        raise ParameterError(f"{place} lacks {wanted}; add it, every limit has it")
    unknown = [output for output in given["outputs"] if output not in units]
    if unknown:
        raise ParameterError(
            f"{place} limits {', '.join(unknown)}, which is no output of the block; it has "
            f"{', '.join(units)}"
        )
    if given["basis"] not in BASES:
        raise ParameterError(
            f"{place}: the basis {given['basis']!r} is not known; it is one of {', '.join(BASES)}"
        )
    unit = units[given["outputs"][0]]
    if any(units[output] != unit for output in given["outputs"]):
        raise ParameterError(f"{place} limits outputs of different units; make it two limits")
    ends = {end: _in(place, given[end], unit) for end in ("least", "largest") if end in given}
    return Limit(
        name,
        tuple(given["outputs"]),
        unit,
        ends.get("least"),
        ends.get("largest"),
        **{text: str(given[text]) for text in TEXTS},
        void=bool(given.get("void", False)),
        allowed=_in(place, given["allowed"], "1") if "allowed" in given else 0.0,
    )


def _in(place: str, given: Mapping[str, Any], unit: str) -> float:
    """A value with its unit, in an FMI unit."""
    try:
        return gain(given["unit"], unit) * float(given["value"])
    except MismatchError as error:
        own = given["unit"]
        raise ParameterError(f"{place} is given in {own!r}; give it in a unit of {unit}") from error
