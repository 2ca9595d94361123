"""What a run's answer owes to numbers that are not known exactly."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

from fmus.catalogue import parameters
from orchestrator import Level, Provenance, Responses

from ..car.band import critical_band
from ..car.hopper import CARS, layout_of
from ..car.linear_motion import LinearMotion
from ..car.spreads import uncertain
from ..results import mean_speed
from ..scales import MILE_PER_HOUR
from .standing import HIGHEST, LOWEST, first_critical, linear_of, speed_text, swapped

TODO = "`tracktrain study uncertainty` has the bands of its other answers"

SHOWN = 3
"""Numbers that are named of those that count as known."""

BLOCKS = ("carbody", "truck", "wheelrail")
"""Blocks whose numbers have a say in a critical speed."""


@cache
def bands() -> dict[str, dict[str, Any]]:
    """Of each car the band of its critical speed [m/s], and what it comes from most."""
    return tomllib.loads(files(__package__).joinpath("bands.toml").read_text("utf-8"))


@dataclass(frozen=True)
class Answer:
    """The band of a critical speed [m/s], how many numbers make it, and what it comes from most.

    known: numbers with a range that are none of it, since the car that ran does not have them as
    its parameter set does. value: the critical speed with the numbers as they are, where known.
    """

    numbers: int
    low: float
    high: float
    most: str
    share: float
    known: tuple[str, ...] = ()
    value: float | None = None


def of_numbers(dataset: Responses) -> tuple[Level, str]:
    """How far the numbers of a run's car carry: level and text."""
    nearest = _nearest(dataset)
    if nearest is None:
        return Level.UNKNOWN, f"How far the car's numbers may be off is not known; {TODO}."
    car, changed = nearest
    own = changed or swapped(dataset, layout_of(dataset))
    linear, unknown = (linear_of(dataset) or (None, ())) if own else (None, ())
    if linear is None or unknown:
        text = _text(f"{car} car", Answer(**bands()[car]), dataset, _others(dataset))
        if changed:
            what = "number" if changed == 1 else "numbers"
            text += f"; the run changes {changed} {what}, and the band was computed without that"
    elif (answer := _computed(linear, car)) is not None:
        text = _text(f"{car} car as it ran", answer, dataset)
    else:
        return Level.DOUBTFUL, (
            f"How far the critical speed may be off is not known: the linear car that ran has none "
            f"from {speed_text(LOWEST)} to {speed_text(HIGHEST)}; {TODO}."
        )
    return Level.DOUBTFUL, f"{text}; {TODO}."


def _text(car: str, answer: Answer, dataset: Responses, others: str = "") -> str:
    """others: of which car the band is instead of the one that ran."""
    low, high, speed = answer.low, answer.high, mean_speed(dataset)
    text = (
        f"{answer.numbers} numbers of the {car} have a range: its critical speed is from "
        f"{low / MILE_PER_HOUR:.0f} to {high / MILE_PER_HOUR:.0f} mph (5 to 95 %), most by "
        f"{answer.most} ({100 * answer.share:.0f} %), which to measure would pay most"
    )
    if answer.value is not None and not low <= answer.value <= high:
        text += (
            f"; {answer.value / MILE_PER_HOUR:.0f} mph with the numbers as they are lies outside, "
            "since ranges reach further to one side"
        )
    if answer.known:
        first, more = ", ".join(answer.known[:SHOWN]), len(answer.known) - SHOWN
        text += f"; {first}{f' and {more} more' if more > 0 else ''} count as known: what ran has "
        text += "them as given, or does without them"
    if others:
        text += (
            f"; that is the band {others}, and how far the critical speed of the car that ran may "
            "be off is not computed"
        )
    elif speed is not None and low < speed < high:
        text += "; whether it hunts at this speed is open"
    return text


@lru_cache(maxsize=4)
def _computed(linear: LinearMotion, car: str) -> Answer | None:
    """Of the car that ran, by derivatives of its FMUs; None where it has no critical speed."""
    critical = first_critical(linear)
    if critical is None:
        return None
    numbers = uncertain(car)
    band = critical_band(linear, critical, numbers)
    most, share = next(iter(band.shares.items()), ("", 0.0))
    known = tuple(n.name for n in numbers if n.name not in band.slopes)
    return Answer(len(band.slopes), band.low, band.high, most, share, known, critical.speed)


def _others(dataset: Responses) -> str:
    """Of which car the band is instead of that with the FMUs that ran; "" where they are ours."""
    layout = layout_of(dataset)
    by_block: dict[str, list[str]] = {}
    for instance in swapped(dataset, layout):
        by_block.setdefault(layout.blocks[instance], []).append(instance)
    named = [
        f"{'cones' if block == 'wheelrail' else f'our own {block}'} and not of what ran as "
        f"{', '.join(names)}"
        for block, names in by_block.items()
    ]
    return f"of {'; of '.join(named)}" if named else ""


def _nearest(dataset: Responses) -> tuple[str, int] | None:
    """The car whose numbers a run has, and how many of them are others; None where none is near."""
    layout = layout_of(dataset)
    said = Provenance.of(dataset).parameters
    given = [
        (block, name.removeprefix(f"{instance}."), value)
        for block in BLOCKS
        for instance in layout.instances(block)
        for name, value in said.items()
        if name.startswith(f"{instance}.")
    ]
    found = {}
    for car, vehicle in CARS.items():
        if car not in bands():
            continue
        own = parameters(vehicle.parameters)
        pairs = [
            (value, own[block][name])
            for block, name, value in given
            if name in own[block] and not name.startswith("initial.")
        ]
        if pairs:
            found[car] = sum(a != b for a, b in pairs)
    return min(found.items(), key=lambda item: item[1]) if found else None
