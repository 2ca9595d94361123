"""Connections, checked: both ends found, arrays matched, types and units that fit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..errors import CouplingError, choices
from ..fmu.arrays import MOST, element_names, shaped
from ..fmu.description import Description, Variable
from ..system.system import Connection, split
from ..system.transformation import IDENTITY, Table, Transformation
from .ports import DRIVES, MEASURED, Fit, Problem, fit


@dataclass(frozen=True, eq=False)
class Link:
    """A connected input: input = gain * output + offset, the transformation included."""

    source: int
    output: Variable
    target: int
    input: Variable
    gain: float = 1.0
    offset: float = 0.0
    transformation: Transformation = IDENTITY


def find_links(
    connections: Iterable[Connection],
    names: list[str],
    descriptions: list[Description],
    notes: list[str],
) -> tuple[list[Link], list[Link]]:
    """Links of numbers, by target, and links of texts; raises CouplingError for what does not fit.

    notes: takes one for each connection that is converted.
    """
    numbers = {name: n for n, name in enumerate(names)}
    links: dict[tuple[int, str], Link] = {}
    for connection in connections:
        for one in _elements(connection, numbers, descriptions):
            link = _link(one, numbers, descriptions)
            place = (link.target, link.input.name)
            if previous := links.get(place):
                raise CouplingError(
                    f"{one.target} is driven twice: by {names[previous.source]}."
                    f"{previous.output.name} and by {one.source}; leave one connection out"
                )
            if (link.gain, link.offset) != (1.0, 0.0):
                shift = f" {link.offset:+g}" if link.offset else ""
                done = "converted" if link.transformation == IDENTITY else "transformed"
                notes.append(
                    f"{names[link.source]}.{link.output.label} drives "
                    f"{names[link.target]}.{link.input.label}: {done}, times {link.gain:g}{shift}"
                )
            links[place] = link
    ordered = sorted(links.values(), key=lambda link: link.target)
    texts = [link for link in ordered if link.input.textual]
    return [link for link in ordered if not link.input.textual], texts


def _elements(
    connection: Connection, numbers: Mapping[str, int], descriptions: list[Description]
) -> Iterator[Connection]:
    """The connection, or one for each pair of elements of two arrays."""
    ends = (connection.source, connection.target)
    shapes = [_shape(end, numbers, descriptions) for end in ends]
    if shapes == [None, None]:
        yield connection
    elif shapes[0] == shapes[1] and shapes[0] is not None:
        pairs = zip(*(element_names(end, shapes[0]) for end in ends), strict=True)
        yield from (replace(connection, source=a, target=b) for a, b in pairs)
    else:
        said = [
            f"{end} is {'one variable' if shape is None else f'an array of {shaped(shape)}'}"
            for end, shape in zip(ends, shapes, strict=True)
        ]
        advice = "connect their elements"
        if None in shapes:
            whole, shape = next((e, s) for e, s in zip(ends, shapes, strict=True) if s is not None)
            advice = f"connect an element, such as {element_names(whole, shape)[0]}"
        raise CouplingError(
            f"{connection.target} cannot be driven by {connection.source}: {' and '.join(said)}; "
            f"{advice}"
        )


def _shape(
    end: str, numbers: Mapping[str, int], descriptions: list[Description]
) -> tuple[int, ...] | None:
    instance, name = split(end)
    if instance not in numbers:
        return None
    return descriptions[numbers[instance]].arrays.get(name)


def _link(
    connection: Connection, numbers: Mapping[str, int], descriptions: list[Description]
) -> Link:
    source, output = _port(connection.source, "output", numbers, descriptions)
    target, port = _port(connection.target, "input", numbers, descriptions)
    found = fit(output, descriptions[source], port, descriptions[target])
    if found.problem is Problem.KIND:
        raise CouplingError(
            f"{connection.target} ({port.type}) cannot be driven by {connection.source} "
            f"({output.type}): {port.kind} inputs take "
            f"{' and '.join(sorted(a for a, b in DRIVES if b == port.kind))} outputs"
        )
    gain, offset = _conversion(connection, output, port, found, descriptions[source])
    if not (math.isfinite(gain) and math.isfinite(offset)):
        wrong = f"adds {offset:g}" if math.isfinite(gain) else f"multiplies by {gain:g}"
        raise CouplingError(
            f"the connection from {connection.source} to {connection.target} {wrong}; give a "
            "finite factor and offset"
        )
    return Link(source, output, target, port, gain, offset, connection.transformation)


def _port(
    name: str, causality: str, numbers: Mapping[str, int], descriptions: list[Description]
) -> tuple[int, Variable]:
    instance, variable = split(name)
    if instance not in numbers:
        raise CouplingError(
            f"there is no instance '{instance}' for the connection's end '{name}'; "
            f"{choices(instance, numbers)}"
        )
    index = numbers[instance]
    description = descriptions[index]
    found = description.find(variable)
    if found is not None and found.causality == causality:
        _check_type(f"{instance}.{found.label}", found, causality)
        return index, found
    ports = [v.name for v in description.variables.values() if v.causality == causality]
    if found is None:
        raise CouplingError(
            f"{instance} ({description.label}) has no {causality} '{variable}'; "
            f"{choices(variable, ports)}"
        )
    article = "an" if found.causality[0] in "aeiou" else "a"
    raise CouplingError(
        f"{instance}.{found.label} cannot {_verb(causality)}: it is {article} {found.causality}, "
        f"not an {causality}; {choices(variable, ports)}"
    )


def _check_type(label: str, found: Variable, causality: str) -> None:
    if found.clocked and found.kind == "clock":
        why = "it is a clock that ticks by itself, or the FMU has no event mode"
    elif found.clocked:
        why = "it belongs to a clock, and the FMU has no event mode in which that could tick"
    elif found.textual and found.clocks:
        why = f"it is of type {found.type} and belongs to a clock, which is for numbers only"
    elif found.shape:
        why = f"it is an array of {shaped(found.shape)}, and at most {MOST} elements are coupled"
    else:
        return
    raise CouplingError(f"{label} cannot {_verb(causality)}: {why}")


def _verb(causality: str) -> str:
    return "drive an input" if causality == "output" else "be driven"


def _conversion(
    connection: Connection, output: Variable, port: Variable, units: Fit, giving: Description
) -> tuple[float, float]:
    """Gain and offset from the output to the input: first the units', then the connection's."""
    after = connection.transformation
    if isinstance(after, Table):
        return _by_table(connection, after, output, port)
    if after != IDENTITY and output.kind not in MEASURED:
        raise CouplingError(
            f"{connection.target} is driven by {connection.source} through a linear "
            f"transformation, and both are of type {output.type}; give a map of its values"
        )
    if output.kind == "enumeration":
        return _by_item(connection, output, port)
    if connection.suppress_unit_conversion or output.kind not in MEASURED:
        return after.factor, after.offset
    if units.problem is not None:
        raise CouplingError(_unit_problem(connection, output, port, units, giving))
    return after.factor * units.gain, after(units.offset)


def _unit_problem(
    connection: Connection, output: Variable, port: Variable, units: Fit, giving: Description
) -> str:
    ends = (
        f"{connection.target} [{port.unit}] cannot be driven by {connection.source} [{output.unit}]"
    )
    if units.problem is Problem.UNKNOWN_UNIT:
        return f"{ends}: {units.detail}; define it in the FMU's UnitDefinitions"
    if units.problem is Problem.DIFFERENCE:
        return f"{ends}: {units.detail}; suppress the unit conversion, and say what is meant"
    instance = connection.source.partition(".")[0]
    fitting = [f"{instance}.{v.name}" for v in giving.outputs if v.unit == port.unit]
    return f"{ends}; outputs in {port.unit}: {', '.join(fitting) if fitting else 'none'}"


def _by_table(
    connection: Connection, table: Table, output: Variable, port: Variable
) -> tuple[float, float]:
    """Gain and offset of a map of values, which must be on a line, as two always are."""
    ends = (
        f"{connection.target} is driven by {connection.source} through a map of kind {table.kind}"
    )
    if table.kind.lower() != output.kind:
        advice = "a linear transformation" if output.kind in MEASURED else "one of that"
        raise CouplingError(f"{ends}, and it is of type {output.type}; give {advice}")
    every = {"Boolean": (False, True), "Enumeration": (*output.items,)}.get(table.kind, ())
    sources = dict.fromkeys((*(source for source, _ in table.entries), *every))
    pairs = [(_number(source, output), _number(table(source), port)) for source in sources]
    if any(number is None for pair in pairs for number in pair):
        raise CouplingError(
            f"{ends}, which has items that they do not have: {_items(output)} and {_items(port)}"
        )
    line = _line([(float(a or 0), float(b or 0)) for a, b in pairs])
    if line is None:
        raise CouplingError(f"{ends}, whose numbers are not on a line; at most two can be free")
    return line


def _number(value: bool | int | str, variable: Variable) -> int | None:
    return variable.items.get(value) if isinstance(value, str) else int(value)


def _by_item(connection: Connection, output: Variable, port: Variable) -> tuple[float, float]:
    """Gain and offset from an item's number at the source to that at the target.

    Items go by name; where the two have no name in common, by number.
    """
    if not output.items or not port.items:
        return 1.0, 0.0
    common = output.items.keys() & port.items.keys()
    if output.items.keys() <= port.items.keys():
        line = _line([(number, port.items[name]) for name, number in output.items.items()])
        if line is not None:
            return line
    elif not common and {*output.items.values()} <= {*port.items.values()}:
        return 1.0, 0.0
    raise CouplingError(
        f"{connection.target} cannot be driven by {connection.source}: their items do not match, "
        f"{_items(output)} and {_items(port)}"
    )


def _line(pairs: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    """Gain and offset of the line through all pairs of numbers; None if they are not on one."""
    if not pairs:
        return 1.0, 0.0
    (first, start), (last, end) = min(pairs), max(pairs)
    gain = (end - start) / (last - first) if last != first else 1.0
    offset = start - gain * first
    fits = all(gain * number + offset == other for number, other in pairs)
    return (gain, offset) if fits else None


def _items(variable: Variable) -> str:
    return ", ".join(f"{name} = {number}" for name, number in variable.items.items())
