"""Connections followed across the borders of systems, from one FMU to another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..errors import CouplingError, UnitError, choices
from ..fmu.units import Unit
from ..system.system import Connection
from ..system.transformation import IDENTITY, Linear, Transformation, composed
from .mapping import transformation
from .structure import Element, is_variable, variable_of
from .xml import Node

GIVES = {"output", "calculatedParameter", "constant", "local"}
TAKES = {"input", "parameter", "structuralParameter"}


@dataclass(frozen=True)
class Port:
    """A connector: of a system, or of a component and thereby a variable of its FMU."""

    owner: Element
    name: str

    @property
    def label(self) -> str:
        return ".".join((*self.owner.path, self.name))

    @property
    def unit(self) -> Unit | None:
        """The unit as declared here, else as the FMU has it."""
        declared = self.owner.connectors.get(self.name)
        if declared and declared.unit:
            own = self.own_unit
            return Unit(declared.unit, self.owner.document.units, own.difference if own else None)
        return self.own_unit

    @property
    def own_unit(self) -> Unit | None:
        """The unit that the FMU itself gives."""
        if self.owner.fmu is None:
            return None
        description = self.owner.description
        return description.unit_of(variable_of(description, self.name))

    @property
    def kind(self) -> str | None:
        """As declared, else as the FMU has it; None if there is no such connector."""
        if declared := self.owner.connectors.get(self.name):
            return declared.kind
        if self.owner.fmu and is_variable(self.owner.description, self.name):
            return variable_of(self.owner.description, self.name).causality
        return None


@dataclass(frozen=True)
class Hop:
    """One Connection element, in the direction in which values flow."""

    source: Port
    target: Port
    transformation: Transformation
    suppress_unit_conversion: bool
    node: Node


@dataclass(frozen=True)
class Network:
    """The hops of a system and of all systems in it, by their ends."""

    into: Mapping[Port, Hop]
    out_of: Mapping[Port, Sequence[Hop]]

    def chain(self, target: Port) -> list[Hop]:
        """The hops that lead to a port, from the far end on; raises SspError for a circle."""
        hops: list[Hop] = []
        while hop := self.into.get(target):
            if hop in hops:
                hop.node.fail(f"the connections to {hop.target.label} run in a circle")
            hops.insert(0, hop)
            target = hop.source
        return hops


def read_network(root: Element) -> Network:
    """All connections, directed; raises SspError for ends that do not fit or are driven twice."""
    into: dict[Port, Hop] = {}
    out_of: dict[Port, list[Hop]] = {}
    for hop in _hops(root):
        if previous := into.get(hop.target):
            hop.node.fail(
                f"{hop.target.label} is driven twice: by {previous.source.label} and by "
                f"{hop.source.label}"
            )
        into[hop.target] = hop
        out_of.setdefault(hop.source, []).append(hop)
    return Network(into, out_of)


def _hops(system: Element) -> Iterator[Hop]:
    for node in system.connections:
        for indices in ("startIndices", "endIndices"):
            if node.has(indices):
                system.document.node.fail(
                    f"the connection of {node.get('startConnector')} and "
                    f"{node.get('endConnector')} has {indices}: SSP does not say whether "
                    "elements are numbered from 0 or from 1; connect whole arrays"
                )
        start, end = _end(system, node, "start"), _end(system, node, "end")
        source, target = (start, end) if _flows_on(system, start, end) else (end, start)
        yield Hop(
            source,
            target,
            transformation(node),
            node.flag("suppressUnitConversion"),
            system.document.node,
        )
    for element in system.elements.values():
        yield from _hops(element)


def _end(system: Element, node: Node, which: str) -> Port:
    owner, connector = system, node.need(f"{which}Connector")
    if name := node.get(f"{which}Element"):  # some tools write "" for the system itself
        if name not in system.elements:
            system.document.node.fail(
                f"a connection of the {system.label} {which}s at the element '{name}'; "
                f"{choices(name, system.elements)}"
            )
        owner = system.elements[name]
    port = Port(owner, connector)
    if port.kind is None:
        known = owner.description.variables if owner.fmu else owner.connectors
        system.document.node.fail(
            f"a connection of the {system.label} {which}s at the connector '{connector}' of the "
            f"{owner.label}; {choices(connector, known)}"
        )
    return port


def _flows_on(system: Element, start: Port, end: Port) -> bool:
    """Whether values flow from start to end; raises SspError if both give or both take."""
    first, second = _gives(system, start), _gives(system, end)
    if first is not None and first == second:
        both = "give values" if first else "take values"
        system.document.node.fail(
            f"{start.label} ({start.kind}) and {end.label} ({end.kind}) cannot be connected: "
            f"both {both}"
        )
    return first is not False and second is not True


def _gives(system: Element, port: Port) -> bool | None:
    """Whether a port gives values, as seen inside of the system; None if it may do either."""
    if port.kind not in GIVES | TAKES:
        return None
    return (port.kind in GIVES) != (port.owner is system)


def connections(root: Element, network: Network, names: Mapping[Element, str]) -> list[Connection]:
    """Connections from FMU to FMU, instances being called by `names`; raises SspError."""
    found = []
    for target in network.into:
        if target.owner.fmu is None:
            continue
        hops = network.chain(target)
        if hops[0].source.owner.fmu is None:
            continue  # comes from outside, or from a connector that nothing leads to
        source = hops[0].source
        kinds = {source.kind, target.kind}
        if kinds & {"parameter", "calculatedParameter", "structuralParameter", "constant"}:
            hops[0].node.fail(
                f"{source.label} ({source.kind}) is connected to {target.label} ({target.kind}): "
                "parameters are not carried from FMU to FMU; give the value in a parameter set"
            )
        start, end = (f"{names[port.owner]}.{port.name}" for port in (source, target))
        found.append(Connection(start, end, *_in_one(hops)))
    return found


def _in_one(hops: Sequence[Hop]) -> tuple[Transformation, bool]:
    """Transformation of a chain of hops, and whether it stands for the units' conversion, too."""
    source, target = hops[0].source, hops[-1].target
    total = along([step_to(hop) for hop in hops], source.unit)
    as_fmus_say = all(_as_its_fmu_says(port, hops[0].node) for port in (source, target))
    if as_fmus_say and len(hops) == 1:
        return hops[0].transformation, hops[0].suppress_unit_conversion
    plain = not any(h.suppress_unit_conversion or h.transformation != IDENTITY for h in hops)
    if as_fmus_say and plain and (source.unit is None) == (target.unit is None):
        return IDENTITY, False
    return total, True


def _as_its_fmu_says(port: Port, node: Node) -> bool:
    """Whether a connector's unit is its FMU's; raises SspError if it contradicts that."""
    declared, own = port.unit, port.own_unit
    if declared is None or own is None:
        return declared is None
    if declared.name != own.name:
        found = Step(own, IDENTITY, False, port.label, node).conversion(declared)
        if found is None or not found.is_close_to(IDENTITY):
            node.fail(f"{port.label} is declared in {declared.name}, but in {own.name} by its FMU")
    return True


@dataclass(frozen=True)
class Step:
    """What happens on the way to something in `unit`; `label` and `node` are for messages.

    inward: it leads into a system, whose connector without a unit has that of what is behind it.
    """

    unit: Unit | None
    transformation: Transformation
    suppress_unit_conversion: bool
    label: str
    node: Node
    inward: bool = False

    def conversion(self, given: Unit | None) -> Linear | None:
        """From the unit that a value comes in; None if that measures something else."""
        if self.suppress_unit_conversion or self.unit is None or given is None:
            return IDENTITY
        try:
            found = given.to(self.unit)
        except UnitError as error:
            self.node.fail(f"{self.label}: {error}")
        return None if found is None else Linear(*found)


def step_to(hop: Hop) -> Step:
    """A hop as a step to its target."""
    return Step(
        hop.target.unit,
        hop.transformation,
        hop.suppress_unit_conversion,
        f"{hop.source.label} drives {hop.target.label}",
        hop.node,
        inward=hop.target.kind in TAKES,
    )


def along(steps: Sequence[Step], unit: Unit | None) -> Transformation:
    """All that happens along the way to a value that begins in `unit`; raises SspError."""
    parts: list[Transformation] = []
    for step in _with_units(steps):
        converted = step.conversion(unit)
        if converted is None:
            assert unit is not None and step.unit is not None
            step.node.fail(f"{step.label}: {unit.name} cannot be converted to {step.unit.name}")
        parts += [converted, step.transformation]
        if step.unit and step.unit.difference is None and unit is not None:
            unit = replace(step.unit, difference=unit.difference)
        else:
            unit = step.unit or (None if step.suppress_unit_conversion else unit)
    try:
        return composed(parts)
    except CouplingError as error:
        steps[0].node.fail(f"{steps[0].label}: {error}")


def _with_units(steps: Sequence[Step]) -> list[Step]:
    """The steps, those into a system with the unit that is behind its connector."""
    found: list[Step] = []
    behind: Unit | None = None
    for step in reversed(steps):
        if step.unit is None and step.inward:
            step = replace(step, unit=behind)
        behind = None if step.suppress_unit_conversion else step.unit
        found.insert(0, step)
    return found
