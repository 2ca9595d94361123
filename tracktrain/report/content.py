"""What a run's page says in words and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fmus.catalogue import parameter_units
from fmus.describe.parameters import PARAMETER_SETS, Entry, parameter_set
from orchestrator import Provenance, Responses

from ..assessment import EXCEEDED, PASSED
from ..car.hopper import layout_of
from ..events import Event, events, gravest
from ..results import RELATIVE, Bond, mean_speed
from ..rows import each
from ..scales import FOOT, MILE_PER_HOUR, three_digits
from ..statistics import STATISTICS
from ..told import cells, told_of_car
from .system import titled


@dataclass(frozen=True)
class Fact:
    """A number at the top of the page, what it is, and what to think of it."""

    label: str
    value: str
    note: str = ""
    tone: str = ""


def title(dataset: Responses) -> str:
    """What was run, in a line."""
    if not is_car(dataset):
        return titled(dataset)
    return "Hopper car on irregular track" if _moves(dataset) else "Hopper car on perfect track"


def is_car(dataset: Responses) -> bool:
    """Whether the run's system has all instances of a car."""
    return layout_of(dataset).blocks.keys() <= Provenance.of(dataset).fmus.keys()


def facts(
    dataset: Responses, table: Sequence[Mapping[str, Any]], bonds: Sequence[Bond] | None
) -> list[Fact]:
    """The numbers at the top. table: as `tracktrain.assessment.judged` gives it."""
    time = dataset["time"].values
    found = []
    if not is_car(dataset):
        known = Provenance.of(dataset)
        found.append(
            Fact("system", f"{len(known.fmus)} FMUs", f"{len(known.connections)} connections")
        )
    speed = mean_speed(dataset)
    if speed is not None:
        units = f"{speed / FOOT:.4g} ft/s, {speed / MILE_PER_HOUR:.3g} mph"
        found.append(Fact("speed", f"{speed * 3.6:.3g} km/h", units))
    span, step = float(time[-1] - time[0]), float(dataset.attrs.get("step", 0.0))
    way, name = "", layout_of(dataset).distance
    if name in dataset:
        distance = dataset[name].values
        way = f"{three_digits(float(distance[-1] - distance[0]))} m of track"
    found.append(Fact("simulated", f"{span:.4g} s", way))
    found.append(Fact("macro step", f"{1e3 * step:.4g} ms", f"{dataset.attrs.get('master', '')}"))
    held = [row for row in table if row["applies"] and row["result"] in (PASSED, EXCEEDED)]
    if held:
        over = sum(row["result"] == EXCEEDED for row in held)
        worst = max(held, key=lambda row: row["share"])
        said = f"{over} exceeded" if over else f"all {len(held)} kept"
        most = f"most used: {worst['quantity']}, {worst['share']:.0%}"
        found.append(Fact("limits", said, most, "bad" if over else "good"))
    if bonds:
        residual = f"{max(bond[RELATIVE] for bond in bonds):.1e}"
        found.append(Fact("energy residual", residual, "of the energy that passed, at most"))
    return found


def numbers(dataset: Responses) -> dict[str, dict[str, list[tuple[str, str]]]]:
    """By group and quantity of a car, the statistics, each with its interval in per cent."""
    return {
        group: {
            f"{label}, {scale.units}" if scale.unit else label: _paired(
                cells(dataset, variable, scale, tuple(STATISTICS))
            )
            for label, (variable, scale) in rows.items()
        }
        for group, rows in told_of_car(dataset).items()
    }


def _paired(texts: Sequence[str]) -> list[tuple[str, str]]:
    """Values and intervals, which stand in turn; what is not excited has no interval."""
    pairs = zip(texts[::2], texts[1::2], strict=True)
    return [(v, i if i[0] in "0123456789?" else "") if v != "-" else (i, "") for v, i in pairs]


MOST_EVENTS, FEW_EVENTS = 100, 8
"""Events that a page lists and marks, and those that it shows at once."""


def happened(dataset: Responses) -> list[Event]:
    """The gravest events."""
    return gravest(events(dataset))[:MOST_EVENTS]


def parameters(dataset: Responses) -> list[dict[str, Any]]:
    """Instance, name, value [SI], and of numbers out of the parameter files unit, basis, source."""
    blocks = layout_of(dataset).blocks
    rows = []
    for full, value in Provenance.of(dataset).parameters.items():
        instance, _, name = full.partition(".")
        entry, changed = _entry(blocks.get(instance), name, value)
        rows.append(
            {
                "instance": instance,
                "name": name,
                "value": f"{value:.6g}" if isinstance(value, float) else str(value),
                "published": f"{entry.value:.6g} {entry.unit}".removesuffix(" 1") if entry else "",
                "basis": entry.basis if entry else ("changed" if changed else ""),
                "source": entry.source if entry else "",
            }
        )
    return rows


def fmus(dataset: Responses) -> list[tuple[str, str, str]]:
    """Instance, file and sha256 of every FMU."""
    return [
        (name, str(given.get("file", "")), str(given.get("sha256", "")))
        for name, given in Provenance.of(dataset).fmus.items()
    ]


def _moves(dataset: Responses) -> bool:
    rails = [str(name) for name in dataset.data_vars if ".rail_" in str(name)]
    return any(bool(np.any(rail.values)) for _, rail in each(dataset, rails))


def _entry(block: str | None, name: str, value: object) -> tuple[Entry | None, bool]:
    """The published number that a value is, by the parameter set that has it; or that none is."""
    known = False
    for given in PARAMETER_SETS:
        entry = parameter_set(given).entry(name, block) if block else None
        if entry is None or block is None or name not in parameter_units(block):
            continue  # an FMU in the block's place may have more parameters than it
        known = True
        if isinstance(value, (int, float)):
            published = entry.to(parameter_units(block)[name])
            if np.isclose(published, value, rtol=1e-9):
                return entry, False
    return None, known
