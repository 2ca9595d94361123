"""The rows of a run a few at a time, so that a run of any length can be looked at."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from orchestrator import Response, Responses, Signals

BYTES = 2**25
"""Bytes of all columns of a chunk."""

TOGETHER = 2**27
"""Bytes of columns that are read in one pass."""


def chunks(
    dataset: Responses, names: Collection[str], size: int | None = None
) -> Iterator[tuple[int, dict[str, NDArray[np.float64]]]]:
    """The values of these variables from the first row to the last, a chunk of rows at a time.

    Each chunk comes with the number of its first row. size: rows of a chunk; by default as many as
    the file keeps with all its columns.
    """
    if 8 * dataset.sizes["time"] * len(names) <= TOGETHER:
        together(dataset, names)
    rows = size or max(BYTES // (8 * (len(dataset.variables) + 2)), 1)
    if rows >= dataset.sizes["time"]:  # all at once: no array package is asked for its slices
        yield 0, {name: np.asarray(dataset[name].values, float) for name in names}
        return
    for first in range(0, dataset.sizes["time"], rows):
        part = slice(first, first + rows)
        yield first, {name: np.asarray(dataset[name].isel(time=part), float) for name in names}


def together(dataset: Responses, names: Collection[str]) -> None:
    """Have these variables read in one pass, and kept until others are asked for so."""
    if isinstance(dataset, Signals):
        dataset.together(names)


def each(dataset: Responses, names: Sequence[str]) -> Iterator[tuple[str, Response]]:
    """These variables one after the other, as many read in one pass as memory holds."""
    count = max(TOGETHER // (8 * max(dataset.sizes["time"], 1)), 1)
    for first in range(0, len(names), count):
        together(dataset, names[first : first + count])
        for name in names[first : first + count]:
            yield name, dataset[name]
