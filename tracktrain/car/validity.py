"""Where a run left what the laws of its blocks hold for: since when, how far, and what helps."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .hopper import layout_of

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Limit:
    """The largest value of a block's outputs that its laws hold for, and what lies beyond.

    outputs: a pattern of their names. share: value over the limit, else the value itself counts.
    """

    block: str
    outputs: str
    largest: float
    beyond: str
    remedy: str
    share: bool = True


LIMITS = (
    Limit(
        "wheelrail",
        r"(left|right)\.saturation",
        1.0 + 1e-6,
        "creep forces above dry friction",
        "take a creep law with a limit, as in --set wheelset_11.creep_law=polach for each wheelset",
    ),
    Limit(
        "wheelrail",
        "floor_ratio",
        1.0,
        "a speed under the floor of the creepages",
        "results there are those of the floor; end the run before, or lower speed_floor",
    ),
    Limit(
        "truck",
        "lift_(left|right)",
        0.0,
        "lifted wheels",
        "they come down without a blow, and `linear` creep forces do not know it; take a law that "
        "knows the load",
        share=False,
    ),
    Limit(
        "truck",
        r"strain_ratio\[\d\]",
        1.0,
        "strains beyond those that Table 4-5 was measured for",
        "forces there are extrapolated; give parameters of your truck",
    ),
)
"""All limits of the blocks, the gravest first."""


@dataclass(frozen=True)
class Departure:
    """Outputs that went beyond a limit: the first one and when [s], the worst and its value."""

    limit: Limit
    first: str
    time: float
    worst: str
    value: float
    unit: str
    count: int

    def __str__(self) -> str:
        times = "times" if self.limit.share else self.unit
        others = f" (and {self.count - 1} more)" if self.count > 1 else ""
        return (
            f"outside the model: {self.limit.beyond}, from t = {self.time:.3g} s ({self.first}"
            f"{others}), at most {self.value:.3g} {times} ({self.worst}); {self.limit.remedy}"
        )


def departures(dataset: xr.Dataset) -> list[Departure]:
    """What a run of the car went beyond, by kind; empty where it stayed inside."""
    layout = layout_of(dataset)
    found = (
        _departure(dataset, limit, list(_outputs(dataset, limit, layout.instances(limit.block))))
        for limit in LIMITS
    )
    return [departure for departure in found if departure is not None]


def _outputs(dataset: xr.Dataset, limit: Limit, instances: tuple[str, ...]) -> Iterator[str]:
    for name in map(str, dataset.data_vars):
        instance, _, output = name.partition(".")
        if instance in instances and re.fullmatch(limit.outputs, output):
            yield name


def _departure(dataset: xr.Dataset, limit: Limit, names: list[str]) -> Departure | None:
    beyond = {name: dataset[name].values > limit.largest for name in names}
    places = {name: int(where.argmax()) for name, where in beyond.items() if where.any()}
    if not places:
        return None
    first = min(places, key=places.__getitem__)
    worst = max(places, key=lambda name: float(dataset[name].values.max()))
    return Departure(
        limit,
        first,
        float(dataset.time[places[first]]),
        worst,
        float(dataset[worst].values.max()),
        str(dataset[worst].attrs.get("units", "")),
        len(places),
    )
