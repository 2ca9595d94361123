"""Tries out a model before it becomes an FMU, so that what its description says is true."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator

from ...describe.units import base_exponents
from ...describe.variables import Values, limits
from ...model import Model
from ...python.stored import from_bytes, to_bytes
from .sources import PackError

STEP = 1e-3
"""Communication step [s] of the trial."""

SIZES = {"m": 1e-3, "rad": 1e-3, "m/s": 0.1, "rad/s": 0.1, "N": 1e4, "N.m": 1e4}
"""Usual size of an input in a unit."""

TRIALS = 8
CHANGES = (1e-3, 1.0, 1e3)
"""How far an input is moved, both ways, to see what it changes, in its usual size."""


def check(model: Model) -> None:
    """Raise PackError with all that keeps the model from being a good FMU."""
    findings = list(_declarations(model))
    if not findings:
        try:
            findings = list(_behaviour(model))
        except Exception as error:
            raise PackError(
                f"{model.name} fails when it is tried out: {type(error).__name__}: {error}"
            ) from error
    if findings:
        raise PackError("\n  ".join([f"{model.name} cannot become an FMU yet:", *findings]))


def _declarations(model: Model) -> Iterator[str]:
    variables = [*model.parameters, *model.inputs, *model.outputs]
    names = Counter(v.name for v in variables)
    yield from (f"{name} is declared {n} times" for name, n in names.items() if n > 1)
    for variable in variables:
        try:
            if "^" not in variable.unit:  # a name alone
                base_exponents(variable.unit)
        except Exception:  # pint raises many kinds
            yield (
                f"{variable.name} is in '{variable.unit}', which is no SI unit as FMI writes them; "
                "write m, rad, m/s, rad/s, kg, kg.m2, N, N.m, N/m, N.m/rad, Hz, or 1 for a number"
            )
    for parameter in model.parameters:
        low, high = limits(parameter)
        if parameter.default is None:
            yield f"the parameter {parameter.name} has no default; give one"
        elif not low <= parameter.default <= high:
            yield f"the default of {parameter.name} is not within {low:g} to {high:g}"
    outputs, inputs = ({v.name for v in group} for group in (model.outputs, model.inputs))
    for output in model.outputs:
        if output.derivative_of and output.derivative_of not in outputs:
            yield f"{output.name} is the rate of {output.derivative_of}, which is no output"
    for name, sources in model.feedthrough.items():
        if name not in outputs:
            yield f"feedthrough names {name}, which is no output"
        for source in sources:
            if source not in inputs:
                yield f"feedthrough of {name} names {source}, which is no input"


def _behaviour(model: Model) -> Iterator[str]:
    p, u = model.start_values()
    model.start(p, u)
    y = model.output(p, u)
    declared = {v.name for v in model.outputs}
    yield from (f"output() gives no {name}" for name in sorted(declared - set(y)))
    yield from (f"output() gives {n}, which is not declared" for n in sorted(set(y) - declared))
    if set(y) != declared:
        return
    model.step(p, u, 0.0, STEP)
    yield from _state(model, p, u)
    yield from _feedthrough(model, p, u)


def _state(model: Model, p: dict[str, float], u: dict[str, float]) -> Iterator[str]:
    """What differs in a step after the state was put back, as it is and from bytes."""

    def step() -> Values:
        inputs = dict(u)
        model.step(p, inputs, STEP, STEP)
        return dict(model.output(p, inputs))

    state = model.save()
    expected = step()
    model.restore(state)
    if step() != expected:
        yield "a step is another one after the state was put back; keep all of it in `self`"
    try:
        model.restore(from_bytes(to_bytes(state)))
    except TypeError as error:
        yield f"the state cannot be stored as bytes: {error}"
        model.restore(state)
    else:
        if step() != expected:
            yield "a step is another one after the state was stored as bytes"


def _feedthrough(model: Model, p: dict[str, float], u: dict[str, float]) -> Iterator[str]:
    """Move each input, at several points, and see which outputs change at once."""
    found: dict[str, set[str]] = {v.name: set() for v in model.outputs}
    rng = random.Random(1)
    size = {v.name: max(SIZES.get(v.unit, 1.0), 0.1 * abs(v.start)) for v in model.inputs}
    for _ in range(TRIALS):
        at = {name: value + size[name] * rng.uniform(-1, 1) for name, value in u.items()}
        before = model.output(p, at)
        for name in at:
            for change in (sign * c * size[name] for c in CHANGES for sign in (1, -1)):
                after = model.output(p, {**at, name: at[name] + change})
                for output, value in after.items():
                    if value != before[output]:
                        found[output].add(name)
    for output, names in found.items():
        if lacking := ", ".join(
            n for n in u if n in names - set(model.feedthrough.get(output, ()))
        ):
            yield f"{output} changes at once with {lacking}; say so in feedthrough"
