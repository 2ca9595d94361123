"""What a sweep goes over: names, and values written as ranges or lists with a unit."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from orchestrator import choices, is_pattern, picked

from ..car.changes import with_settings
from ..car.hopper import CARS, TRACKS, hopper_car, instances
from ..errors import TracktrainError
from ..options.car import DURATION_UNITS, SPEED_KIND, STEP_KIND, is_track_file
from ..options.chosen import CONES, STRAIGHT
from ..options.master import MASTERS
from ..options.profiles import RADIUS
from ..options.types import Quantity

if TYPE_CHECKING:
    from orchestrator import System

Given = str | float | Path | Sequence[Any]

KINDS = {
    "speed": SPEED_KIND,
    "duration": Quantity("duration", "s", DURATION_UNITS, "8s"),
    "step": STEP_KIND,
    "right_radius": RADIUS,
}
QUANTITIES = {name: kind.unit for name, kind in KINDS.items()}
"""Options with a unit, and the one that a run takes them in."""

NAMED = {"car": CARS, "track": TRACKS, "master": MASTERS}
"""Options that are one of some names; a track is also a file."""

FILES = ("layout", "wheel", "rail", "right_wheel", "right_rail")
"""Options that are files; a wheel and a rail are also names of shapes."""

WITHOUT = {"layout": STRAIGHT, "wheel": CONES}
"""Their values for no file."""

NUMBER_THEN_UNIT = re.compile(
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf)(?!\w))\s*(?P<unit>.*?)\s*",
    re.IGNORECASE,
)
"""A value of a range or a list, which may be a whole number."""

TEXTS = (*NAMED, *FILES)

OPTIONS = (*QUANTITIES, "seed", *TEXTS)

MOST = 1_000_000
"""Values of a range; more are a slip of the pen."""

EXAMPLE = (
    "speed=20:140:5ft/s, seed=1:50, car=loaded,empty, wheel=new.csv,worn.csv or "
    "instance.parameter=1:5:1mm"
)


class SweepError(TracktrainError, ValueError):
    """A sweep that cannot be made as it was asked for."""


@dataclass(frozen=True)
class Axis:
    """A name of `OPTIONS` or "instance.parameter", and its values in a unit."""

    name: str
    values: tuple[float | int | str, ...]
    unit: str = ""

    @property
    def label(self) -> str:
        """Name and unit, as heading of a column."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def text(self, value: float | int | str) -> str:
        """A value with its unit."""
        return f"{value} {self.unit}" if self.unit else str(value)

    @property
    def digest(self) -> str:
        """The axis in a few words."""
        shown = [str(value) for value in self.values]
        if len(shown) > 6:
            shown = [*shown[:3], "...", shown[-1]]
        return f"{self.name}={','.join(shown)}{f' {self.unit}' if self.unit else ''}"


def read_axis(text: str) -> Axis:
    """An axis as `name=start:stop:step unit` or `name=a,b,c unit`; raises SweepError."""
    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise SweepError(f"'{text}' cannot be swept over; write it as {EXAMPLE}")
    return make_axis(name.strip(), values.strip())


def make_axis(name: str, given: Given) -> Axis:
    """An axis from text as above, from one value, or from a sequence; raises SweepError.

    Numbers without a unit are in the one that the option or the parameter has.
    """
    if isinstance(given, str):
        ranged = ":" in given and name not in TEXTS
        values, unit = _range(name, given) if ranged else _list(name, given)
    else:
        plain: Iterable[Any] = [given] if isinstance(given, float | int | Path) else given
        values, unit = tuple(_plain(value) for value in plain), ""
        if any(isinstance(value, str) for value in values):
            values, unit = _list(name, ",".join(map(str, values)))
        elif not isinstance(given, str):
            unit = QUANTITIES.get(name, "") or _unit_of(name)
    if not values:
        raise SweepError(f"{name} has no values to sweep over; write it as {EXAMPLE}")
    if len(set(values)) < len(values):
        raise SweepError(f"{name} has a value twice; give each once")
    axis = Axis(name, values, unit)
    _check(axis)
    return axis


def shaped(axes: Sequence[Axis], point: Sequence[Any], shape: Mapping[str, Any]) -> dict[str, Any]:
    """Options of a run, those of `chosen_car` and `master`, at a point of the grid."""
    options = dict(shape)
    for axis, value in zip(axes, point, strict=True):
        if axis.name in QUANTITIES:
            options[axis.name] = _converted(axis, value)
        elif axis.name in OPTIONS:
            options[axis.name] = Path(value) if axis.name == "layout" else value
        else:
            instance, _, parameter = axis.name.partition(".")
            changed = (instance, parameter, axis.text(value))
            options["settings"] = (*options["settings"], changed)
    return options


def _plain(value: Any) -> Any:
    """A number of numpy's as Python's own, a path as text."""
    if isinstance(value, Path):
        return str(value)
    return value.item() if hasattr(value, "item") else value


def _range(name: str, text: str) -> tuple[tuple[float | int, ...], str]:
    parts = text.split(":")
    last = NUMBER_THEN_UNIT.fullmatch(parts[-1])
    numbers = [*map(_number, parts[:-1]), _number(last["number"]) if last else None]
    if len(parts) > 3 or last is None or None in numbers:
        raise SweepError(
            f"the range {name}={text} cannot be read; write it as start:stop:step with one unit at "
            "the end, as in speed=20:140:5ft/s"
        )
    start, stop, *rest = [n for n in numbers if n is not None]
    step = rest[0] if rest else 1
    if step == 0 or (stop - start) * step < 0:
        raise SweepError(
            f"the range {name}={text} is empty: {stop} is not reached by steps of {step}"
        )
    count = math.floor((stop - start) / step + 1e-9) + 1
    if count > MOST:
        raise SweepError(f"the range {name}={text} has {count} values, more than {MOST}")
    values = [start + n * step for n in range(count)]
    rounded = [v if isinstance(v, int) else float(f"{v:.12g}") for v in values]
    return tuple(rounded), last["unit"]


def _list(name: str, text: str) -> tuple[tuple[float | int | str, ...], str]:
    """Values of a list, numbers where all are; a unit may follow each or the last."""
    parts = [part.strip() for part in text.split(",")]
    if name in TEXTS or any(not part for part in parts):
        return tuple(part for part in parts if part), ""
    found = [NUMBER_THEN_UNIT.fullmatch(part) for part in parts]
    units = {match["unit"] for match in found if match is not None and match["unit"]}
    numbers = [_number(match["number"]) for match in found if match is not None]
    known = [n for n in numbers if n is not None]
    if len(known) < len(parts):  # items of an enumeration
        return tuple(parts), ""
    if len(units) > 1:
        raise SweepError(f"{name}={text} mixes the units {' and '.join(sorted(units))}; use one")
    return tuple(known), next(iter(units), "")


def _number(text: str) -> float | int | None:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return None


def _check(axis: Axis) -> None:
    """Raise SweepError for what no run could have."""
    name = axis.name
    if name in NAMED:
        for item in map(str, axis.values):
            if item in NAMED[name]:
                continue
            if name != "track" or not is_track_file(item):
                raise SweepError(f"there is no {name} '{item}'; {choices(item, NAMED[name])}")
            _check_there(name, item)
    elif name in FILES:
        for item in map(str, axis.values):
            _check_file(name, item)
    elif name == "seed":
        if axis.unit or not all(isinstance(value, int) for value in axis.values):
            raise SweepError("a seed is a whole number, as in seed=1:50")
    elif name in QUANTITIES:
        for value in axis.values:
            if _converted(axis, value) <= 0.0:
                raise SweepError(
                    f"a {name} of {axis.text(value)} cannot be run; give one above zero"
                )
    else:
        _check_parameter(axis)


def _check_file(name: str, value: str) -> None:
    """Raise for a line or a profile that cannot be read."""
    from ..geometry.layout import read_layout
    from ..profiles.reading import profile_of

    if value == WITHOUT.get(name):
        return
    if name == "layout":
        read_layout(value)
    elif Path(value).suffix.lower() == ".fmu":
        _check_there(name, value)
    else:
        profile_of(value, kind="rail" if name.endswith("rail") else "wheel")


def _check_there(name: str, value: str) -> None:
    if not Path(value).is_file():
        raise SweepError(f"there is no file '{value}' for the axis {name}")


def _check_parameter(axis: Axis) -> None:
    instance, dot, parameter = axis.name.partition(".")
    if not dot:
        raise SweepError(
            f"'{axis.name}' cannot be swept over; {choices(axis.name, OPTIONS)}, or a parameter as "
            "instance.parameter"
        )
    if not _meant(instance):
        raise SweepError(f"there is no instance '{instance}'; {choices(instance, instances())}")
    variables = _variables(instance)
    if parameter not in variables:
        known = [n for n, v in variables.items() if v.causality == "parameter"]
        raise SweepError(f"{instance} has no parameter '{parameter}'; {choices(parameter, known)}")
    for value in axis.values:
        with_settings(_car_with(instance), [(instance, parameter, axis.text(value))])


def _converted(axis: Axis, value: Any) -> float:
    """A speed or a time [SI]; raises SweepError for what measures something else."""
    if isinstance(value, str):
        raise SweepError(f"{axis.name}={value} is no number with a unit, as in {EXAMPLE}")
    try:
        return KINDS[axis.name].convert(axis.text(value), None, None)
    except click.BadParameter as error:
        raise SweepError(error.message) from None


def _unit_of(name: str) -> str:
    instance, _, parameter = name.partition(".")
    if not _meant(instance) or parameter not in _variables(instance):
        return ""
    unit = _variables(instance)[parameter].unit
    return "" if unit in (None, "1") else str(unit)


def _meant(instance: str) -> list[str]:
    """The instances that are called so, or fit it where it is a pattern."""
    return picked(instance, instances()) if is_pattern(instance) else [*{instance} & {*instances()}]


def _variables(instance: str) -> Mapping[str, Any]:
    """Those of the instances that are meant, by name."""
    from orchestrator import describe

    own = (c for n, c in _car_with(instance).components.items() if n in _meant(instance))
    return {name: v for c in own for name, v in describe(Path(str(c.fmu))).variables.items()}


def _car_with(instance: str) -> System:
    meant = {*_meant(instance)}
    return hopper_car(next(n for n, car in CARS.items() if meant & {*car.layout.blocks}))
