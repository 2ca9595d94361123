"""How the calibrated car is run: a file for `tracktrain run`, with where each number is from."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from ..options.chosen import Shape
from .chosen import Chosen
from .evidence import Array
from .fitting import LEVELS, Fitted


def settings(chosen: Sequence[Chosen], values: Array) -> dict[str, str]:
    """The values, and those of what follows them, by "instance.parameter"."""
    found = {}
    for one, value in zip(chosen, values, strict=True):
        for target in one.targets:
            found[target] = _text(value, one.unit)
        for follower in one.followers:
            found[follower.target] = _text(follower.factor * value, follower.unit)
    return found


def run_file(shape: Shape, fitted: Fitted, source: str) -> str:
    """The car with the estimates as TOML, as `tracktrain run` takes it."""
    given = {f"{instance}.{name}": value for instance, name, value in shape.settings}
    lines = [f"# Calibrated from {source}.", *(f"# {told}" for told in _told(fitted)), ""]
    lines += [f"car = {json.dumps(shape.car)}", f'speed = "{shape.speed!r} m/s"']
    lines += [f"track = {json.dumps(shape.track)}", f"seed = {shape.seed}", "", "[set]"]
    values = given | settings(fitted.chosen, fitted.values)
    return "\n".join([*lines, *(f"{json.dumps(n)} = {json.dumps(v)}" for n, v in values.items())])


def _told(fitted: Fitted) -> Iterator[str]:
    """The intervals of the estimates."""
    bounds = fitted.interval(LEVELS[-1])
    for one, value, (low, high) in zip(fitted.chosen, fitted.values, bounds, strict=True):
        if one.targets:
            yield (
                f"{one.name}: {value:.6g} {one.unit}, {100 * LEVELS[-1]:.0f} % interval {low:.6g} "
                f"to {high:.6g}"
            )


def _text(value: float, unit: str) -> str:
    return f"{value:.10g}" if unit == "1" else f"{value:.10g} {unit}"
