"""The parameters that are estimated: what they are called, where they begin, and their ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from orchestrator import Quantity, UnitError, Variable, choices, conversion, describe, in_unit

from ..car.hopper import layout_of
from ..errors import TracktrainError

if TYPE_CHECKING:
    from orchestrator import System

    from ..car.spreads import Uncertain

RANGE_EXAMPLE = "truck.warp.stiffness=2e6:6e6 N.m/rad"
PRIOR_EXAMPLE = "carbody.body_mass=91e3 +- 2e3 kg"

CLOCK_SCALE = 0.01
"""Of the offset between the clocks of run and measurement [s]."""


@dataclass(frozen=True)
class Follower:
    """A parameter "instance.parameter" [SI] that is `factor` times another one."""

    target: str
    factor: float
    unit: str


@dataclass(frozen=True)
class Chosen:
    """A parameter to estimate [SI].

    name: as it was asked for. parameter: without its block or instance. targets: what has it, as
    "instance.parameter"; none is the offset of the clocks. low, high: its range. centre, deviation:
    its prior, 0 for none. why: what the range or the prior is based on.
    followers: what is in proportion to it.
    """

    name: str
    parameter: str
    targets: tuple[str, ...]
    unit: str
    start: float
    low: float = -np.inf
    high: float = np.inf
    centre: float = 0.0
    deviation: float = 0.0
    why: str = ""
    followers: tuple[Follower, ...] = ()

    @property
    def scale(self) -> float:
        """The size by which it is measured in the fit."""
        if not self.targets:
            return CLOCK_SCALE
        if self.start:
            return abs(self.start)
        width = self.high - self.low
        return self.deviation or (width / 2 if np.isfinite(width) else 1.0)

    def at_bound(self, value: float, close: float) -> str:
        """The bound that a value is at: "low", "high" or nothing."""
        if value - self.low < close * self.scale:
            return "low"
        return "high" if self.high - value < close * self.scale else ""


def chosen_parameters(
    names: Sequence[str],
    ranges: Sequence[str],
    priors: Sequence[str],
    system: System,
    numbers: Sequence[Uncertain],
) -> list[Chosen]:
    """Parameters of a car by name: "block.parameter", "instance.parameter", or "parameter" of all.

    ranges: texts `NAME=LOW:HIGH UNIT`. priors: texts `NAME=VALUE +- DEVIATION UNIT`. numbers: of
    the car, whose ranges and deviations count where none is given. They begin with the values of
    the system. Raises TracktrainError for a name, a unit or a value that does
    not fit.
    """
    if not names:
        raise TracktrainError(
            "no parameter is to be estimated; name one, or several, by --parameter"
        )
    found: dict[str, Chosen] = {}
    for name in names:
        if name in found:
            raise TracktrainError(f"the parameter {name} is named twice; name it once")
        found[name] = _named(name, system)
    taken = [target for one in found.values() for target in one.targets]
    if twice := next((target for target in taken if taken.count(target) > 1), None):
        raise TracktrainError(f"{twice} belongs to two of the parameters; name it once")
    units = {name: one.unit for name, one in found.items()}
    bounds = {name: given for name, given in (_range(text, units) for text in ranges)}
    known = {name: given for name, given in (_prior(text, units) for text in priors)}
    spreads = {number.name: number for number in numbers}
    limited = [_limited(one, bounds.get(name), known.get(name)) for name, one in found.items()]
    return [
        _as_known(
            one, number, one.name in bounds, one.name in known, _followers(number, system, taken)
        )
        if (number := spreads.get(one.parameter))
        else one
        for one in limited
    ]


def with_values(system: System, chosen: Sequence[Chosen], values: Sequence[float]) -> System:
    """The system with values [SI] of the parameters."""
    for one, value in zip(chosen, values, strict=True):
        for target in one.targets:
            system = system.with_value(target, float(value))
        for follower in one.followers:
            system = system.with_value(follower.target, follower.factor * float(value))
    return system


def _followers(number: Uncertain, system: System, taken: Sequence[str]) -> tuple[Follower, ...]:
    """What is in proportion to a number, in every instance; taken: what is estimated itself."""
    found = []
    for name, factor in number.followers.items():
        for instance in system.components:
            variable = _parameters(system, instance).get(name)
            if variable is not None and f"{instance}.{name}" not in taken:
                found.append(Follower(f"{instance}.{name}", factor, variable.unit or "1"))
    return tuple(found)


def _as_known(
    one: Chosen, number: Uncertain, ranged: bool, told: bool, followers: tuple[Follower, ...]
) -> Chosen:
    """The parameter with range, deviation and followers of the car's parameter file.

    ranged, told: whether range or prior were given.
    """
    spread = number.spread
    one = replace(one, followers=followers)
    if not ranged and spread.low is not None and spread.high is not None:
        low, high = max(one.low, spread.low), min(one.high, spread.high)
        if low <= one.start <= high:
            return replace(one, low=low, high=high, why=spread.reason)
    if not told and not ranged and spread.deviation is not None:
        return replace(one, centre=spread.value, deviation=spread.deviation, why=spread.reason)
    return one


def _named(name: str, system: System) -> Chosen:
    blocks = layout_of(system).blocks
    first, _, rest = name.partition(".")
    if first in blocks.values():
        instances, parameter = [i for i, block in blocks.items() if block == first], rest
    elif first in system.components:
        instances, parameter = [first], rest
    else:
        instances, parameter = list(system.components), name
    variables = {
        instance: found
        for instance in instances
        if (found := _parameters(system, instance)) and parameter in found
    }
    if not variables:
        known = {n for instance in instances for n in _parameters(system, instance)}
        if parameter == name and "." in name and first not in known:
            known = {f"{b}.{n}" for i, b in blocks.items() for n in _parameters(system, i)}
        raise TracktrainError(
            f"the car has no parameter '{name}' that can be estimated; "
            f"{choices(parameter, sorted(known))}"
        )
    targets = tuple(f"{instance}.{parameter}" for instance in variables)
    variable = next(iter(variables.values()))[parameter]
    unit = variable.unit or "1"
    starts = {t: _value(system, t, variable) for t in targets}
    if len(set(starts.values())) > 1:
        said = ", ".join(f"{t} = {value:g}" for t, value in starts.items())
        raise TracktrainError(f"{name} is not one number here ({said} {unit}); name them apart")
    low, high = variable.minimum, variable.maximum
    return Chosen(
        name,
        parameter,
        targets,
        unit,
        next(iter(starts.values())),
        -np.inf if low is None else low,
        np.inf if high is None else high,
    )


def _parameters(system: System, instance: str) -> Mapping[str, Variable]:
    """The numbers of an instance that can be estimated: all but options and initial values."""
    variables = describe(Path(str(system.components[instance].fmu))).variables
    return {
        name: v
        for name, v in variables.items()
        if v.causality == "parameter"
        and v.kind == "real"
        and not name.startswith("initial.")
        and name != "micro_step"
    }


def _value(system: System, target: str, variable: Variable) -> float:
    instance, _, parameter = target.partition(".")
    given = system.components[instance].parameters.get(parameter, variable.start or 0.0)
    return in_unit(float(str(given)) if _is_number(given) else given, variable.unit or "1", target)


def _is_number(given: object) -> bool:
    try:
        float(str(given))
    except ValueError:
        return False
    return True


def _range(text: str, units: Mapping[str, str]) -> tuple[str, tuple[float, float]]:
    name, right = _split(text, units, "--range", RANGE_EXAMPLE)
    low, colon, high = right.partition(":")
    if not colon:
        raise _unreadable("--range", text, RANGE_EXAMPLE)
    try:
        top = Quantity.parsed(high)
        bottom = Quantity.parsed(low)
    except UnitError:
        raise _unreadable("--range", text, RANGE_EXAMPLE) from None
    unit = top.unit or bottom.unit
    bounds = _si(bottom.value, bottom.unit or unit, name, units), _si(top.value, unit, name, units)
    if not bounds[0] < bounds[1]:
        raise TracktrainError(
            f"the range '{text}' is empty: {low.strip()} is not below {high.strip()}"
        )
    return name, bounds


def _prior(text: str, units: Mapping[str, str]) -> tuple[str, tuple[float, float]]:
    name, right = _split(text, units, "--prior", PRIOR_EXAMPLE)
    value, sign, deviation = right.replace("±", "+-").partition("+-")
    try:
        width, centre = Quantity.parsed(deviation), Quantity.parsed(value)
    except UnitError:
        raise _unreadable("--prior", text, PRIOR_EXAMPLE) from None
    unit = width.unit or centre.unit
    found = _si(centre.value, centre.unit or unit, name, units), _si(width.value, unit, name, units)
    if not sign or not found[1] > 0:
        raise TracktrainError(
            f"the deviation in '{text}' must be above zero, as in '{PRIOR_EXAMPLE}'"
        )
    return name, found


def _split(text: str, units: Mapping[str, str], option: str, example: str) -> tuple[str, str]:
    name, equals, right = (part.strip() for part in text.partition("="))
    if not equals or not right:
        raise _unreadable(option, text, example)
    if name not in units:
        raise TracktrainError(
            f"{option} '{text}' is of no parameter that is estimated; {choices(name, units)}"
        )
    return name, right


def _unreadable(option: str, text: str, example: str) -> TracktrainError:
    return TracktrainError(f"'{text}' cannot be read; write {option} '{example}'")


def _si(value: float, unit: str, name: str, units: Mapping[str, str]) -> float:
    """A value in the parameter's unit; raises TracktrainError without a unit that fits."""
    wanted = units[name]
    if wanted == "1" and not unit:
        return value
    if not unit and value:
        raise TracktrainError(f"{name} needs a unit, such as {wanted}")
    try:
        found = conversion(unit or wanted, wanted)
    except UnitError as error:
        raise TracktrainError(f"{name}: {error}") from None
    if found is None:
        raise TracktrainError(f"{name} is in {wanted}, and {unit} measures another thing")
    return value * found[0]


def _limited(
    one: Chosen, bounds: tuple[float, float] | None, prior: tuple[float, float] | None
) -> Chosen:
    """The parameter within its range, the stricter of what it may be and what was given."""
    low, high, why = one.low, one.high, one.why
    if bounds is not None:
        for bound in bounds:
            if not one.low <= bound <= one.high:
                raise TracktrainError(
                    f"the range of {one.name} reaches {bound:g} {one.unit}; the model takes "
                    f"{one.low:g} to {one.high:g}"
                )
        low, high, why = *bounds, "given"
    if not low <= one.start <= high:
        raise TracktrainError(
            f"{one.name} is {one.start:g} {one.unit}, outside of its range {low:g} to {high:g}; "
            "begin inside of it by --set, or widen --range"
        )
    centre, deviation = prior or (0.0, 0.0)
    if not one.start and not deviation and not np.isfinite(high - low):
        raise TracktrainError(
            f"{one.name} begins at 0, which says nothing of its size; give its --range or --prior"
        )
    return Chosen(
        one.name, one.parameter, one.targets, one.unit, one.start, low, high, centre, deviation, why
    )
