"""Arrays and numbers of every type as masters see them: one variable for each element.

Elements are numbered from 1 in FMI's order, the last index running fastest: `q[3]`, `m[2,1]`.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from math import prod

from ..errors import FmuError
from .description import Description, Lane, Variable

MOST = 100_000
"""Elements of an array above which it stays whole, and is neither coupled nor given values."""

_ELEMENT = re.compile(r"(.+)\[(\d+(?:,\d+)*)\]")


def element_names(name: str, shape: tuple[int, ...]) -> list[str]:
    """Names of an array's elements, in FMI's order."""
    places = product(*(range(1, size + 1) for size in shape))
    return [f"{name}[{','.join(map(str, place))}]" for place in places]


def shaped(shape: tuple[int, ...]) -> str:
    """ "8", "2 x 3"."""
    return " x ".join(map(str, shape))


def taken_apart(description: Description, sizes: Mapping[str, int]) -> Description:
    """A description whose variables are the elements of the FMU's arrays, each with its lane.

    sizes: values of structural parameters. Where an FMI 2.0 FMU has numbers of type Real only
    among its inputs and outputs, they are set and read by its own functions, without lanes.
    """
    dimensions = {size for v in description.variables.values() for size in v.dimensions}
    given = {
        v.name: int(float(v.start or 0))
        for v in description.variables.values()
        if v.name in dimensions
    } | dict(sizes)
    variables: dict[str, Variable] = {}
    arrays: dict[str, tuple[int, ...]] = {}
    for variable in description.variables.values():
        shape = tuple(
            given.get(size, 0) if isinstance(size, str) else size for size in variable.dimensions
        )
        if not shape or prod(shape) > MOST:
            variables[variable.name] = replace(variable, shape=shape)
            continue
        arrays[variable.name] = shape
        starts = _starts(variable, prod(shape), shape == variable.shape)
        for n, name in enumerate(element_names(variable.name, shape)):
            if name in description.variables:
                raise FmuError(
                    f"'{description.label}' has an array {variable.name} and a variable {name}; "
                    "one of the two needs another name"
                )
            variables[name] = replace(
                variable,
                name=name,
                start=starts[n],
                shape=(),
                dimensions=(),
                starts=(),
                lane=Lane(variable.reference, n, prod(shape)),
            )
    if arrays:
        variables = {v.name: v for v in _with_elements(variables.values(), arrays)}
    else:
        arrays = _named_arrays(variables)
    whole = replace(description, variables=variables, arrays=arrays)
    return whole if _is_plain(whole) else with_lanes(whole)


def reading(description: Description, names: Collection[str]) -> Description:
    """A description with other variables as outputs, too."""
    if not names:
        return description
    wider = description.with_outputs(names)
    lanes = any(v.lane for v in description.variables.values())
    return wider if lanes or _is_plain(wider) else with_lanes(wider)


def with_lanes(description: Description) -> Description:
    """A description in which every number has a lane, and is numbered by it."""
    variables: dict[str, Variable] = {}
    for variable in description.variables.values():
        if variable.coupled:
            lane = variable.lane or Lane(variable.reference)
            variable = replace(variable, lane=lane, reference=len(variables))
        variables[variable.name] = variable
    return replace(description, variables=variables)


def _is_plain(description: Description) -> bool:
    ports = [v for v in (*description.inputs, *description.outputs) if v.coupled]
    return description.fmi_version.startswith("2.") and all(v.type == "Real" for v in ports)


def _starts(variable: Variable, size: int, unchanged: bool) -> list[str | None]:
    """A start for each element: one may stand for all, and none fits an array of another size."""
    if len(variable.starts) == 1:
        return [variable.starts[0]] * size
    if len(variable.starts) == size and unchanged:
        return list(variable.starts)
    return [None] * size


def _with_elements(
    variables: Iterable[Variable], arrays: Mapping[str, tuple[int, ...]]
) -> Iterator[Variable]:
    """What is said of whole arrays, said of their elements."""
    elements = {name: element_names(name, shape) for name, shape in arrays.items()}
    for variable in variables:
        rated, lane = variable.derivative_of, variable.lane
        if rated is not None and rated in elements:
            inside = lane is not None and lane.size == len(elements[rated])
            rated = elements[rated][lane.element] if lane is not None and inside else None
        depends = variable.dependencies
        if depends is not None:
            depends = frozenset(n for name in depends for n in elements.get(name, [name]))
        yield replace(variable, derivative_of=rated, dependencies=depends)


def _named_arrays(variables: Mapping[str, Variable]) -> dict[str, tuple[int, ...]]:
    """Arrays that stand element by element in a description, as FMI 2.0 has to say it."""
    places: dict[str, list[tuple[int, ...]]] = {}
    for name, variable in variables.items():
        if variable.causality in ("input", "output") and (match := _ELEMENT.fullmatch(name)):
            places.setdefault(match[1], []).append(tuple(map(int, match[2].split(","))))
    found = {}
    for name, given in places.items():
        if len({len(place) for place in given}) == 1 and name not in variables:
            shape = tuple(map(max, zip(*given, strict=True)))
            if sorted(given) == list(product(*(range(1, size + 1) for size in shape))):
                found[name] = shape
    return found
