"""A run's values by name, as its dataset has them, without the time that xarray takes to load.

What tells of a run asks for a `Responses`: a dataset of xarray is one, and `Signals` is one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from ..errors import ResultsError
from .checking import check_rows
from .classic import HeaderError
from .columns import content
from .netcdf import NAME

Array = NDArray[np.float64]
TIME = "time"


class Response(Protocol):
    """A variable over `time` [s], as a DataArray of xarray is one."""

    @property
    def values(self) -> Any: ...
    @property
    def attrs(self) -> Any: ...
    @property
    def size(self) -> int: ...
    def __getitem__(self, key: Any) -> Response: ...
    def __abs__(self) -> Self: ...
    def isel(self, *, time: slice) -> Self: ...


class Responses(Protocol):
    """Variables by "instance.variable", as a Dataset of xarray has them."""

    @property
    def attrs(self) -> Any: ...
    @property
    def data_vars(self) -> Collection[Any]: ...
    @property
    def variables(self) -> Collection[Any]: ...
    @property
    def sizes(self) -> Mapping[Any, int]: ...
    def __contains__(self, key: object) -> bool: ...
    def __getitem__(self, key: str) -> Response: ...
    def isel(self, *, time: slice) -> Self: ...


@dataclass(frozen=True)
class Signal:
    """One variable of `Signals`; values are read each time that they are asked for.

    read: gives the values of a stretch of rows.
    """

    read: Callable[[range], Array]
    attrs: Mapping[str, Any]
    rows: range
    time: Signal | None = None

    @classmethod
    def of(cls, values: Array, time: Array) -> Signal:
        """Of values at times [s]."""
        rows = range(len(values))
        times = cls(lambda own: time[own.start : own.stop], {}, rows)
        return cls(lambda own: values[own.start : own.stop], {}, rows, times)

    @property
    def values(self) -> Array:
        return self.read(self.rows)

    @property
    def size(self) -> int:
        return len(self.rows)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.array(self.values, dtype) if copy else np.asarray(self.values, dtype)

    def __getitem__(self, key: Any) -> Signal:
        """Those rows of a slice; of "time" their times."""
        if key == TIME:
            return self.time or self
        return self.isel(time=key)

    def __abs__(self) -> Self:
        return type(self)(lambda own: np.abs(self.read(own)), self.attrs, self.rows, self.time)

    def isel(self, *, time: slice) -> Self:
        """These rows on end."""
        own = self.time.isel(time=time) if self.time else None
        return type(self)(self.read, self.attrs, self.rows[time], own)


@dataclass(frozen=True)
class Signals:
    """The variables of a run. columns: one of each, `time` among them.

    gather: has columns ready by their numbers, read together.
    """

    columns: Mapping[str, Signal]
    attrs: Mapping[str, Any]
    gather: Callable[[Collection[int]], None] = lambda _: None

    @classmethod
    def of_rows(
        cls,
        read: Callable[[int, int, int], Array],
        count: int,
        variables: Mapping[str, Mapping[str, Any]],
        attributes: Mapping[str, Any],
        gather: Callable[[Collection[int]], None] = lambda _: None,
    ) -> Signals:
        """Of rows whose first number is the time.

        read: the values of a variable, by its number, from a row to the one before another.
        """
        columns: dict[str, Signal] = {}
        for number, (name, said) in enumerate(variables.items()):
            columns[name] = Signal(
                lambda rows, number=number: read(number, rows.start, rows.stop),  # type: ignore[misc]
                said,
                range(count),
                columns.get(TIME),
            )
        return cls(columns, attributes, gather)

    @classmethod
    def of_file(cls, path: Path) -> Signals:
        """Of results.nc, whose rows need no check; raises OSError, HeaderError."""
        stream = path.open("rb")  # what was opened is read, whatever takes its place
        rows, variables, attributes = content(stream)
        return cls.of_rows(rows.column, rows.count, variables, attributes, rows.gather)

    def together(self, names: Collection[str]) -> None:
        """Have these variables ready, and no others, in one pass through a large file.

        Else each of them takes a pass of its own. What there is not is left out.
        """
        self.gather([number for number, name in enumerate(self.columns) if name in names])

    @property
    def data_vars(self) -> Collection[str]:
        return [name for name in self.columns if name != TIME]

    @property
    def variables(self) -> Collection[str]:
        return self.columns.keys()

    @property
    def sizes(self) -> Mapping[str, int]:
        return {TIME: self.columns[TIME].size}

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __getitem__(self, name: str) -> Signal:
        return self.columns[name]

    def isel(self, *, time: slice) -> Self:
        """The same of these rows on end."""
        left = {name: column.isel(time=time) for name, column in self.columns.items()}
        return type(self)(left, self.attrs, self.gather)


def open_signals(place: Path | str) -> Signals:
    """Those of results.nc, or of the one in a folder, every row checked.

    Raises ResultsError where there is none, and DamageError where it is not what the run wrote.
    """
    path = Path(place)
    path = path / NAME if path.is_dir() else path
    check_rows(path)
    try:
        return Signals.of_file(path)
    except (OSError, HeaderError) as error:
        raise ResultsError(f"'{path}' cannot be read: {error}") from None
