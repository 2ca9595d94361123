"""Where a run left what its FMUs say that their laws hold for: since when, how far, what helps.

The limits are those that the FMUs state; this file has none of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, pi

import numpy as np
from numpy.typing import NDArray

from orchestrator import Limit, Provenance, Responses

from ..rows import chunks
from .hopper import layout_of

SHOWN = {"rad": ("deg", 180.0 / pi), "m": ("mm", 1e3), "1": ("", 1.0)}
"""Units in which values are shown, and how many are one of the unit."""


@dataclass
class Watch:
    """An output beside its limit: rows where it first lay beyond and lay furthest, and its value
    there, -1 where it never did; the number of rows beyond."""

    output: str
    limit: Limit
    first: int = -1
    furthest: int = -1
    excess: float = 0.0
    value: float = 0.0
    rows: int = 0

    def take(self, start: int, values: NDArray[np.float64]) -> None:
        """Look at rows that begin with this one."""
        excess = np.nan_to_num(
            np.maximum(values - self.limit.largest, self.limit.least - values), nan=-inf
        )
        self.rows += int(np.count_nonzero(excess > 0.0))
        row = int(excess.argmax())
        if excess[row] > self.excess:
            if self.first < 0:
                self.first = start + int((excess > 0.0).argmax())
            self.furthest, self.excess, self.value = start + row, excess[row], values[row]


@dataclass(frozen=True)
class Departure:
    """Outputs beyond one limit: since when [s] and where along the track [m], and which first; the
    one that went furthest, its value, and when [s]; their number; the largest share of the rows
    that one of them was beyond."""

    limit: Limit
    first: str
    row: int
    time: float
    station: float | None
    worst: str
    value: float
    worst_time: float
    count: int
    share: float

    @property
    def at_edge(self) -> bool:
        """Whether it lasted no longer than the FMU allows."""
        return self.share <= self.limit.allowed

    @property
    def where(self) -> str:
        """What left the range first, and how many others did."""
        return self.first + (f" and {self.count - 1} more" if self.count > 1 else "")

    @property
    def found(self) -> str:
        """The worst value with its unit."""
        return shown(self.value, self.limit.unit)

    @property
    def held(self) -> str:
        """What the laws hold for."""
        least, largest = self.limit.least, self.limit.largest
        if least == -largest:
            return f"±{shown(largest, self.limit.unit)}"
        ends = {"at least": least, "at most": largest}
        said = [f"{w} {shown(e, self.limit.unit)}" for w, e in ends.items() if isfinite(e)]
        return " and ".join(said)

    def __str__(self) -> str:
        if self.at_edge:
            return (
                f"{self.limit.beyond} for up to {_percent(self.share)} of the time "
                f"({_percent(self.limit.allowed)} are allowed), worst {self.found} at "
                f"{self.worst_time:.3g} s ({self.worst}); {self.limit.remedy}"
            )
        station = "" if self.station is None else f" ({self.station:.3g} m along the track)"
        return (
            f"outside the model: {self.limit.beyond}, from t = {self.time:.3g} s{station} on at "
            f"{self.where}, {_percent(self.share)} of the time; worst {self.found} at "
            f"{self.worst_time:.3g} s ({self.worst}), where its laws hold for {self.held}; "
            f"{self.limit.remedy}"
        )


@dataclass(frozen=True)
class Range:
    """What is known of a run's range: what went beyond, the gravest first; instances whose FMUs
    state none; outputs that have a limit and were not recorded."""

    departures: tuple[Departure, ...]
    silent: tuple[str, ...]
    unrecorded: tuple[str, ...]
    looked_at: int


def shown(value: float, unit: str) -> str:
    """A value in the unit in which it is shown."""
    name, factor = SHOWN.get(unit, (unit, 1.0))
    return f"{value * factor:.3g} {name}".strip()


def range_of(dataset: Responses) -> Range:
    """Where a run stands within what its FMUs state; of a run of any system."""
    provenance = Provenance.of(dataset)
    stated = provenance.ranges
    watches = [
        Watch(f"{instance}.{output}", limit)
        for instance, limits in stated.items()
        for limit in limits
        for output in limit.outputs
    ]
    there = [watch for watch in watches if watch.output in dataset]
    for start, values in chunks(dataset, sorted({watch.output for watch in there})):
        for watch in there:
            watch.take(start, values[watch.output])
    beyond: dict[str, list[Watch]] = {}
    for watch in there:
        if watch.first >= 0:
            beyond.setdefault(watch.limit.beyond, []).append(watch)
    found = (_departure(dataset, group) for group in beyond.values())
    return Range(
        tuple(sorted(found, key=lambda d: (d.at_edge, not d.limit.void, d.row))),
        tuple(name for name in provenance.fmus if name not in stated),
        tuple(dict.fromkeys(w.output for w in watches if w.output not in dataset)),
        len(there),
    )


def _departure(dataset: Responses, group: list[Watch]) -> Departure:
    first = min(group, key=lambda watch: watch.first)
    worst = max(group, key=lambda watch: watch.excess)
    distance, time = layout_of(dataset).distance, dataset["time"].values
    return Departure(
        first.limit,
        first.output,
        first.first,
        float(time[first.first]),
        float(dataset[distance].values[first.first]) if distance in dataset else None,
        worst.output,
        worst.value,
        float(time[worst.furthest]),
        len({watch.output for watch in group}),
        max(watch.rows for watch in group) / dataset.sizes["time"],
    )


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g}%" if share >= 1e-3 else "less than 0.1%"
