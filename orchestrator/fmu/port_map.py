"""Another FMU's variables under the names, signs and units that a system has for them.

A map is a short TOML file, each line one of the system's names and what it is in the FMU,

    y = "lateral"
    force_y = { name = "Fy", sign = -1, unit = "kN" }
    "left.creep_x" = { name = "slip[1]", factor = 0.01, offset = 0.0 }

or a parameter map of the SSP standard (.ssm), whose sources are the system's names.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace

from ..errors import CouplingError, UnitError, choices
from .arrays import element_names, shaped, with_lanes
from .description import Description, Lane, Limit, Tangent, Variable
from .units import Unit


@dataclass(frozen=True)
class Port:
    """A variable of another FMU: the system's value = factor * the FMU's + offset, in `unit`.

    unit: None for the one that the FMU says.
    """

    name: str
    factor: float = 1.0
    offset: float = 0.0
    unit: str | None = None


@dataclass(frozen=True)
class PortMap:
    """By the system's name of a variable, what it is in the FMU.

    rates: outputs that the FMU does not have, by the outputs whose rates they are. They are
    differentiated over the communication points, by backward differences of second order.
    """

    ports: Mapping[str, Port] = field(default_factory=dict)
    rates: Mapping[str, str] = field(default_factory=dict)

    def applied(self, description: Description) -> Description:
        """The FMU as the system sees it; raises CouplingError for what it does not have."""
        ports = dict(self._each(description))
        for name, port in ports.items():
            _check_scale(name, port)
        taken = {_known(p.name, name, description): name for name, p in reversed(ports.items())}
        driven: dict[str, str] = {}
        for name, port in ports.items():
            variable = description.variables[_known(port.name, name, description)]
            if variable.causality == "input" and (other := driven.get(variable.name)):
                raise CouplingError(
                    f"the port map takes {port.name} of {description.label} for two ports, "
                    f"{other} and {name}; leave one out"
                )
            driven[variable.name] = name
        variables: dict[str, Variable] = {}
        for variable in description.variables.values():
            if variable.name not in taken and variable.name not in ports:
                variables[variable.name] = variable
        for name, port in ports.items():
            variable = description.variables[_known(port.name, name, description)]
            variables[name] = _seen(variable, name, port)
        for name, source in self.rates.items():
            if source not in variables:
                raise CouplingError(
                    f"{description.label} cannot give {name} as the rate of {source}, which it "
                    f"does not have; {choices(source, variables)}"
                )
            variables[name] = _rate(name, variables[source])
        factor = {name: port.factor for name, port in ports.items()}
        tangents = tuple(
            Tangent(*(taken.get(end, end) for end in (t.input, t.output, t.partial)))
            for t in description.tangents
        )
        for t in tangents:
            gain = factor.get(t.input, 1.0) / factor.get(t.output, 1.0)
            if gain != 1.0 and t.partial not in factor:
                variables[t.partial] = _scaled(variables[t.partial], gain, 0.0)
        mapped = {v.name: _renamed(v, taken, factor) for v in variables.values()}
        whole = {port.name: name for name, port in self.ports.items()}
        result = replace(
            description,
            variables=mapped,
            tangents=tangents,
            optional=frozenset(taken.get(name, name) for name in description.optional),
            limits=_limits(description, taken, ports),
            arrays={
                whole.get(name, name): shape
                for name, shape in description.arrays.items()
                if name in whole or name not in ports
            },
            aliases={name: taken.get(main, main) for name, main in description.aliases.items()},
        )
        changed = any(v.lane is not None for v in mapped.values())
        return with_lanes(result) if changed else result

    def fitted(self, own: Description, other: Description, needed: Collection[str]) -> PortMap:
        """The map with values in the units of `own`, whose place `other` takes.

        Variables of `other` that say no unit are taken to be in that of `own`. Outputs among the
        `needed` that `own` declares to be rates, and that `other` has not, are differentiated.
        Raises CouplingError.
        """
        ports = {name: _in_unit(name, p, own, other) for name, p in self._each(other, own)}
        ports |= self.unitless(own, other)
        have = replace(self, ports=ports).applied(other).variables
        rates = dict(self.rates)
        for variable in own.outputs:
            source = variable.derivative_of
            wanted = variable.name in needed and variable.name not in have
            if wanted and source is not None and source in have:
                rates[variable.name] = source
        return PortMap(ports, rates)

    def unitless(self, own: Description, other: Description) -> dict[str, Port]:
        """By name, the numbers of `other` that say no unit where `own` has one, in that unit.

        Without those that the map names, which may say it, and without the elements of arrays of
        FMI 3.0 that cannot say any, since theirs are unlike.
        """
        mapped = {end for name, port in self._each(other, own) for end in (name, port.name)}
        whole = other.arrays if other.fmi_version.startswith("3") else {}
        for name, shape in whole.items():
            elements = [e for e in element_names(name, shape) if e in own.variables]
            if len({own.variables[e].unit for e in elements}) > 1:
                mapped |= {*elements}
        return {
            name: Port(name, unit=variable.unit)
            for name, variable in own.variables.items()
            if variable.unit not in (None, "", "1") and name not in mapped
            for found in (other.variables.get(name),)
            if found is not None and found.unit is None and found.kind == "real"
        }

    def _each(
        self, other: Description, own: Description | None = None
    ) -> Iterator[tuple[str, Port]]:
        """The entries, those of whole arrays element by element."""
        for name, port in self.ports.items():
            shape = other.arrays.get(port.name)
            if shape is None or port.name in other.variables:
                yield name, port
                continue
            expected = own.arrays.get(name, ()) if own is not None else shape
            if expected != shape:
                what = f"an array of {shaped(expected)}" if expected else "one variable"
                raise CouplingError(
                    f"the port map takes {port.name} of {other.label}, an array of "
                    f"{shaped(shape)}, for {name}, which is {what}; name their elements"
                )
            pairs = zip(element_names(name, shape), element_names(port.name, shape), strict=True)
            yield from ((one, replace(port, name=another)) for one, another in pairs)


def _limits(
    description: Description, taken: Mapping[str, str], ports: Mapping[str, Port]
) -> tuple[Limit, ...] | None:
    """What the FMU says that it holds for, by the names and in the units of the system."""
    if description.limits is None:
        return None
    found: list[Limit] = []
    for limit in description.limits:
        own = tuple(name for name in limit.outputs if name not in taken)
        found += [replace(limit, outputs=own)] if own else []
        for name in (taken[output] for output in limit.outputs if output in taken):
            port = ports[name]
            least, largest = sorted(
                port.factor * end + port.offset for end in (limit.least, limit.largest)
            )
            unit = port.unit or limit.unit
            found.append(replace(limit, outputs=(name,), least=least, largest=largest, unit=unit))
    return tuple(found)


def _check_scale(name: str, port: Port) -> None:
    finite = math.isfinite(port.factor) and math.isfinite(port.offset)
    if not finite or port.factor == 0.0:
        raise CouplingError(
            f"the port map takes {port.name} for {name} times {port.factor:g}, plus "
            f"{port.offset:g}; give a finite offset, and a finite factor that is not 0"
        )


def _known(name: str, ours: str, description: Description) -> str:
    found = description.find(name)
    if found is None:
        raise CouplingError(
            f"the port map says that {ours} is {name}, which {description.label} does not have; "
            f"{choices(name, description.variables)}"
        )
    return found.name


def _seen(variable: Variable, name: str, port: Port) -> Variable:
    seen = replace(variable, name=name, unit=port.unit or variable.unit)
    return _scaled(seen, port.factor, port.offset)


def _scaled(variable: Variable, factor: float, offset: float) -> Variable:
    """The variable with its value, start and limits transformed."""
    if (factor, offset) == (1.0, 0.0):
        return variable
    if variable.kind not in ("real", "integer"):
        raise CouplingError(
            f"{variable.name} is of type {variable.type}, which a port map cannot scale; leave out "
            "sign, factor and offset"
        )
    ends = (variable.minimum, variable.maximum)
    low, high = (None if end is None else factor * end + offset for end in ends)
    if factor < 0.0:
        low, high = high, low
    start = variable.start
    lane = variable.lane or Lane(variable.reference)
    return replace(
        variable,
        start=None if start is None else repr(factor * float(start) + offset),
        minimum=low,
        maximum=high,
        lane=replace(lane, gain=factor * lane.gain, offset=factor * lane.offset + offset),
    )


def _rate(name: str, source: Variable) -> Variable:
    """A variable that is the rate of another one."""
    unit = source.unit
    if unit:
        unit = f"{unit}2" if unit.endswith("/s") else f"{'1' if unit == '1' else unit}/s"
    return Variable(
        name=name,
        reference=0,
        type=source.type,
        causality="output",
        unit=unit,
        description=f"rate of {source.name}, differentiated",
        derivative_of=source.name,
        lane=Lane(0, difference_of=source.name),
    )


def _renamed(variable: Variable, taken: Mapping[str, str], factor: Mapping[str, float]) -> Variable:
    """What a variable says of others, by the names that these have now."""
    rated = variable.derivative_of
    if rated is not None and not (variable.lane and variable.lane.difference_of):
        rated = taken.get(rated, rated)
        if factor.get(rated, 1.0) != factor.get(variable.name, 1.0):
            rated = None  # not any more: one was turned round and the other was not
    depends = variable.dependencies
    if depends is not None:
        depends = frozenset(taken.get(name, name) for name in depends)
    return replace(variable, derivative_of=rated, dependencies=depends)


def _in_unit(name: str, port: Port, own: Description, other: Description) -> Port:
    """The port in the unit that its name has in `own`."""
    expected, theirs = own.find(name), other.variables[_known(port.name, name, other)]
    unit = port.unit or theirs.unit
    if expected is None or expected.unit is None:
        return replace(port, unit=unit)
    if unit is None:
        return replace(port, unit=expected.unit)
    try:
        given = Unit(unit, other.units, theirs.difference or None)
        found = given.to(Unit(expected.unit, own.units, expected.difference or None))
    except UnitError as error:
        raise CouplingError(f"the port map's {name} = {port.name}: {error}") from None
    if found is None:
        raise CouplingError(
            f"the port map's {name} [{expected.unit}] cannot be {port.name} [{unit}]: the units "
            "measure different things"
        )
    gain, offset = found
    return Port(port.name, gain * port.factor, gain * port.offset + offset, expected.unit)
