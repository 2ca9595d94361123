"""The rows of a run under way as few points: the least and the largest value of each stretch."""

from __future__ import annotations

from threading import Lock

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
BINS = 600
"""Stretches at most, an even number: where they are full, two become one."""


class History:
    """Rows of (time, values), added by one thread and read by others; columns: of values."""

    def __init__(self, columns: int) -> None:
        self._lock = Lock()
        self._ends = np.empty((2, BINS, 1 + columns))  # least and largest of each stretch
        self._count, self._width = 0, 1
        self._open = np.empty((0, 1 + columns))
        self.rows = 0
        self.last = np.full(1 + columns, np.nan)

    def add(self, rows: Array) -> None:
        """Take rows, shape (n, 1 + columns)."""
        if not len(rows):
            return
        with self._lock:
            self.last = rows[-1].copy()
            self.rows += len(rows)
            left = np.concatenate([self._open, rows]) if len(self._open) else rows
            while len(left) >= self._width:
                if self._count == BINS:
                    self._merge()
                    continue
                count = min(len(left) // self._width, BINS - self._count)
                bins = left[: count * self._width].reshape(count, self._width, -1)
                new = slice(self._count, self._count + count)
                self._ends[0, new], self._ends[1, new] = bins.min(axis=1), bins.max(axis=1)
                self._count += count
                left = left[count * self._width :]
            self._open = left.copy()

    def curve(self, column: int) -> tuple[Array, Array]:
        """Time and values of a column, by its number from 0, up to the newest row."""
        with self._lock:
            times, ends = self._ends[:, : self._count, 0], self._ends[:, : self._count, 1 + column]
            newest = self.last[[0, 1 + column]]
            if self._width == 1:
                time, values = times[0].copy(), ends[0].copy()
            else:
                falls = np.gradient(ends.sum(axis=0)) < 0.0  # then the largest stands first
                time, values = times.T.ravel(), np.where(falls, ends[::-1], ends).T.ravel()
        return np.append(time, newest[0]), np.append(values, newest[1])

    def reach(self, column: int) -> tuple[float, float]:
        """The least and the largest value of a column."""
        with self._lock:
            ends = self._ends[:, : self._count, 1 + column]
            values = np.concatenate([ends.ravel(), self._open[:, 1 + column]])
        return (float(values.min()), float(values.max())) if len(values) else (np.nan, np.nan)

    def _merge(self) -> None:
        """Two stretches become one; what is open stays so."""
        pairs = self._ends.reshape(2, BINS // 2, 2, -1)
        half = BINS // 2
        self._ends[0, :half], self._ends[1, :half] = pairs[0].min(axis=1), pairs[1].max(axis=1)
        self._count, self._width = half, 2 * self._width
