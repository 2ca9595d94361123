"""What a run's answer owes to numbers that are not known exactly."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

from fmus.catalogue import parameters
from orchestrator import Level, Provenance, Responses

from ..car.hopper import CARS, layout_of
from ..results import mean_speed
from ..scales import MILE_PER_HOUR
from .standing import swapped

TODO = "`tracktrain study uncertainty` has the bands of its other answers"


BLOCKS = ("carbody", "truck", "wheelrail")
"""Blocks whose numbers have a say in a critical speed."""


@cache
def bands() -> dict[str, dict[str, Any]]:
    """Of each car the band of its critical speed [m/s], and what it comes from most."""
    return tomllib.loads(files(__package__).joinpath("bands.toml").read_text("utf-8"))


def of_numbers(dataset: Responses) -> tuple[Level, str]:
    """How far the numbers of a run's car carry: level and text."""
    nearest = _nearest(dataset)
    if nearest is None:
        return Level.UNKNOWN, f"How far the car's numbers may be off is not known; {TODO}."
    car, changed = nearest
    band = bands()[car]
    low, high = band["low"], band["high"]
    speed = mean_speed(dataset)
    text = (
        f"{band['numbers']} numbers of the {car} car have a range: its critical speed is from "
        f"{low / MILE_PER_HOUR:.0f} to {high / MILE_PER_HOUR:.0f} mph (5 to 95 %), most by "
        f"{band['most']} ({100 * band['share']:.0f} %), which to measure would pay most"
    )
    others = _others(dataset)
    if others:
        text += (
            f"; that is the band {others}, and how far the critical speed of the car that ran may "
            "be off is not computed"
        )
    elif speed is not None and low < speed < high:
        text += "; whether it hunts at this speed is open"
    if changed:
        what = "number" if changed == 1 else "numbers"
        text += f"; the run changes {changed} {what}, and the band was computed without that"
    return Level.DOUBTFUL, f"{text}; {TODO}."


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
    given = {
        block: {
            name.removeprefix(f"{instance}."): value
            for name, value in said.items()
            if name.startswith(f"{instance}.")
        }
        for block in BLOCKS
        for instance in layout.instances(block)[:1]
    }
    found = {}
    for car, vehicle in CARS.items():
        if car not in bands():
            continue
        own = parameters(vehicle.parameters)
        pairs = [
            (value, own[block][name])
            for block, values in given.items()
            for name, value in values.items()
            if name in own[block] and not name.startswith("initial.")
        ]
        if pairs:
            found[car] = sum(a != b for a, b in pairs)
    return min(found.items(), key=lambda item: item[1]) if found else None
