"""Dry friction of a run: elements that never slip, whose limit has no say, and that always do.

What is told is told of friction with a constant limit; where it follows a load, nothing is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from orchestrator import Provenance, Responses

from ..rows import chunks
from .hopper import layout_of

FRICTION = re.compile(r"friction\[\d+\]")
ELEMENT = re.compile(r"element \d+, (.+)")
WEDGES = {"bolster_roll", "bolster_vertical", "bolster_lateral"}
PLATE = {"centre_plate_lateral", "centre_plate_yaw"}
FOLLOWS = {
    "wedge_law": (WEDGES, (1, "constant")),
    "wedge_friction": (WEDGES, (1, "measured")),
    "centre_plate_friction": (PLATE, (1, "constant")),
    "side_bearing_preload": (PLATE, (0,)),
}
"""Elements whose limit is not their parameter's unless this one has one of these values."""

ROUNDING = 1e-9
"""Share of a limit that does not count."""

SLIPPING = 0.999
"""Share of a limit from which an element slips: its force is given a little beside its state."""

ALWAYS = 0.95
"""Share of the rows from which an element counts as one that always slips."""


@dataclass
class Slip:
    """A friction element: the share of rows in which it slips, and the largest share of its limit
    that it used; whether its force moved at all."""

    truck: str
    element: str
    slipping: float
    used: float
    moved: bool


def slips(dataset: Responses) -> list[Slip]:
    """The friction elements of a run's trucks whose limit is known and constant."""
    given = Provenance.of(dataset).parameters
    limits: dict[str, tuple[str, str, float]] = {}
    for truck in layout_of(dataset).instances("truck"):
        loose = [
            elements
            for law, (elements, plain) in FOLLOWS.items()
            if given.get(f"{truck}.{law}", plain[0]) not in plain
        ]
        for name in map(str, dataset.data_vars):
            instance, _, output = name.partition(".")
            if instance != truck or not FRICTION.fullmatch(output):
                continue
            said = ELEMENT.search(str(dataset[name].attrs.get("description", "")))
            element = said[1].replace(" ", "_") if said else ""
            limit = given.get(f"{truck}.{element}.friction_limit", 0.0)
            if isinstance(limit, (int, float)) and limit > 0 and element not in set().union(*loose):
                limits[name] = (truck, element, float(limit))
    if not limits:
        return []
    counts, used = dict.fromkeys(limits, 0), dict.fromkeys(limits, 0.0)
    least, most = dict.fromkeys(limits, np.inf), dict.fromkeys(limits, -np.inf)
    for _, values in chunks(dataset, list(limits)):
        for name, force in values.items():
            share = np.abs(force) / limits[name][2]
            counts[name] += int(np.count_nonzero(share >= SLIPPING))
            used[name] = max(used[name], float(share.max()))
            least[name], most[name] = min(least[name], force.min()), max(most[name], force.max())
    rows = max(dataset.sizes["time"], 1)
    return [
        Slip(
            truck,
            element,
            counts[name] / rows,
            used[name],
            bool(most[name] - least[name] > ROUNDING * limit),
        )
        for name, (truck, element, limit) in limits.items()
    ]


def remarks(dataset: Responses) -> list[str]:
    """Sentences on friction that is never or always at its limit."""
    found = slips(dataset)
    said = {
        "friction that never slips, so that a higher limit has no say; used of it at most": [
            (slip, f"{min(round(100.0 * slip.used), 99)}%")
            for slip in found
            if slip.moved and not slip.slipping
        ],
        "friction that all but always slips, so that its stiffness has no say": [
            (slip, f"{slip.slipping:.0%} of the time") for slip in found if slip.slipping >= ALWAYS
        ],
        "friction that is not excited": [(slip, "") for slip in found if not slip.moved],
    }
    return [f"{text}: {_listed(those)}" for text, those in said.items() if those]


def _listed(those: list[tuple[Slip, str]]) -> str:
    """Elements with their trucks and numbers, an element once."""
    elements = dict.fromkeys(slip.element for slip, _ in those)
    texts = []
    for element in elements:
        own = [(slip.truck, text) for slip, text in those if slip.element == element]
        texts.append(
            f"{element.replace('_', ' ')} ({', '.join(f'{t} {x}'.strip() for t, x in own)})"
        )
    return ", ".join(texts)
