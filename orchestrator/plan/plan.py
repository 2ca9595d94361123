"""From a system and its FMUs' descriptions to what a master needs: checked, ordered, numbered."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import CouplingError, listed
from ..fmu.description import CO_SIMULATION, Description, Variable
from ..fmu.given import several
from ..fmu.read import describe
from ..notes import Detail
from ..system.system import Component, System, Value
from .bonds import Bond, find_bonds
from .connections import Link, find_links
from .kept import late_notes, recorded, with_asked
from .order import Batch, Loop, Port, evaluation_order
from .start_values import resolve


@dataclass
class Plan:
    """A checked system: instances by number, links by target, outputs by column of the record.

    columns: the outputs that are read, grouped by instance; those of an instance in the order in
    which they become final. first_column: where each instance's begin, and the end.
    steady: for each instance the number of leading columns that depend on its states only.
    text_links: connections of texts, and texts: outputs that are recorded; masters know neither.
    batches: feedthrough outputs in the order in which they are to be read again; `loops` among
    them are gone through until they agree.
    """

    names: list[str]
    descriptions: list[Description]
    links: list[Link]
    columns: list[tuple[int, Variable]]
    first_column: list[int]
    steady: list[int]
    batches: list[Batch]
    loops: list[Loop]
    values: list[list[tuple[Variable, Value]]]
    open_inputs: list[tuple[int, Variable]]
    recorded: list[int]
    bonds: list[Bond]
    every: list[int]
    text_links: list[Link] = field(default_factory=list)
    texts: list[tuple[int, Variable]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.column_of = {(i, v.name): n for n, (i, v) in enumerate(self.columns)}
        self.link_of = {(link.target, link.input.name): link for link in self.links}
        self._links_to: list[list[Link]] = [[] for _ in self.names]
        for link in self.links:
            self._links_to[link.target].append(link)

    def name(self, instance: int, variable: Variable) -> str:
        """ "instance.variable" of a variable."""
        return f"{self.names[instance]}.{variable.name}"

    def links_of(self, instance: int) -> list[Link]:
        return self._links_to[instance]

    @property
    def looped(self) -> frozenset[int]:
        """Instances that an algebraic loop goes through."""
        return frozenset(b.instance for p in self.loops for b in self.batches[p.first : p.last])


def make_plan(
    system: System,
    record: str | Sequence[str] | None = None,
    interface: str = CO_SIMULATION,
    isolated: Collection[str] = (),
) -> Plan:
    """Check a system and number its parts; raises OrchestratorError for what does not fit.

    record: name or pattern of the outputs to keep (`*`, `?`), or several; None keeps all.
    interface: for which the FMUs are to run. isolated: instances in processes of their own.
    """
    names = _instances(system)
    record = None if record is None else several(record, "record")
    descriptions = [
        component_description(name, c, interface) for name, c in system.components.items()
    ]
    notes = [*system.notes, *late_notes(system, descriptions)]
    descriptions = with_asked(record, names, descriptions)
    _check_single_instances(names, descriptions, isolated)
    every = [_every(name, component.every) for name, component in system.components.items()]
    links, text_links = find_links(system.connections, names, descriptions, notes)
    driven = {(link.target, link.input.name): link for link in [*links, *text_links]}
    values = _values(system, descriptions, driven)
    open_inputs = [
        (i, v)
        for i, d in enumerate(descriptions)
        for v in d.inputs
        if (i, v.name) not in driven and v.name not in d.partials
    ]
    _note_open_inputs(notes, names, descriptions, open_inputs, values)
    outputs = [(i, v) for i, d in enumerate(descriptions) for v in d.outputs if v.coupled]
    texts = [
        (i, v)
        for i, d in enumerate(descriptions)
        for v in d.outputs
        if v.textual and not (v.clocks or v.shape)
    ]
    wanted = recorded(record, names, [*outputs, *texts], open_inputs)

    def is_wanted(port: tuple[int, Variable]) -> bool:
        return f"{names[port[0]]}.{port[1].name}" in wanted

    read = _read(outputs, links, descriptions, names, wanted)
    batches, loops = evaluation_order(*feedthrough(read, links, descriptions))
    _note_loops(notes, names, batches, loops)
    columns, first_column, steady = _columns(len(names), read, batches)
    return Plan(
        names=names,
        descriptions=descriptions,
        links=links,
        columns=columns,
        first_column=first_column,
        steady=steady,
        batches=batches,
        loops=loops,
        values=values,
        open_inputs=[port for port in open_inputs if port[1].coupled and is_wanted(port)],
        recorded=[n for n, port in enumerate(columns) if is_wanted(port)],
        bonds=_bonds(system, names, links, descriptions, every, notes),
        every=every,
        text_links=text_links,
        texts=[port for port in texts if is_wanted(port)],
        notes=notes,
    )


def feedthrough(
    ports: Iterable[tuple[int, Variable]], links: Iterable[Link], descriptions: list[Description]
) -> tuple[list[Port], dict[Port, frozenset[str]], dict[Port, Port]]:
    """Outputs, the inputs that they depend on, and what drives these, for `evaluation_order`."""
    read = list(ports)
    every = {i: frozenset(v.name for v in descriptions[i].inputs if not v.held) for i, _ in read}
    depends = {(i, v.name): every[i] if v.dependencies is None else v.dependencies for i, v in read}
    driver = {(k.target, k.input.name): (k.source, k.output.name) for k in links}
    return [(i, v.name) for i, v in read], depends, driver


def _instances(system: System) -> list[str]:
    names = list(system.components)
    if not names:
        raise CouplingError("the system has no components")
    for name in names:
        if not name or "." in name:
            raise CouplingError(f"'{name}' cannot name an instance: it is empty or has a dot")
    return names


def _values(
    system: System, descriptions: list[Description], driven: Mapping[Port, Link]
) -> list[list[tuple[Variable, Value]]]:
    """By instance, the variables that are given values, which nothing drives."""
    values = [
        [pair for n, v in c.parameters.items() for pair in resolve(name, d, n, v)]
        for (name, c), d in zip(system.components.items(), descriptions, strict=True)
    ]
    names = list(system.components)
    for instance, given in enumerate(values):
        for variable, _ in given:
            if link := driven.get((instance, variable.name)):
                raise CouplingError(
                    f"{names[instance]}.{variable.name} cannot be given a value: it is driven by "
                    f"{names[link.source]}.{link.output.name}"
                )
    return values


def _bonds(
    system: System,
    names: list[str],
    links: list[Link],
    descriptions: list[Description],
    every: list[int],
    notes: list[str],
) -> list[Bond]:
    """The bonds of which an energy residual can be told."""
    bonds = find_bonds(names, links, descriptions, system.bonds)
    measured = [b for b in bonds if every[b.force.target] == every[b.velocity.target] == 1]
    if len(measured) < len(bonds):
        unmeasured = ", ".join(bond.name for bond in bonds if bond not in measured)
        notes.append(f"no energy residual, since one side steps seldom: {unmeasured}")
    return measured


def component_description(
    name: str, component: Component, interface: str = CO_SIMULATION
) -> Description:
    """What an FMU says of itself, its arrays as large as the component's values make them."""
    if not isinstance(component.fmu, Path):
        if component.ports is not None:
            raise CouplingError(f"{name} is a mock, which takes no port map; name its ports so")
        return component.fmu.description
    found = describe(component.fmu, interface=interface)
    sizes: dict[str, int] = {}
    for parameter, value in component.parameters.items():
        variable = found.find(parameter)
        if variable is None or variable.causality != "structuralParameter":
            continue
        if variable.kind == "integer":  # of another type it is no size
            sizes |= {v.name: int(str(n)) for v, n in resolve(name, found, parameter, value)}
    described = describe(component.fmu, sizes, interface) if sizes else found
    if component.ports:
        described = component.ports.applied(described)
    return described if component.reads_any_time else described.as_of_steps()


def _check_single_instances(
    names: list[str], descriptions: list[Description], isolated: Collection[str]
) -> None:
    here = {n: d for n, d in zip(names, descriptions, strict=True) if n not in isolated}
    for description in here.values():
        if not description.single_instance:
            continue
        same = [n for n, d in here.items() if d.sha256 == description.sha256]
        if len(same) > 1:
            raise CouplingError(
                f"{' and '.join(same)} are instances of {description.label}, which says that it "
                "can be instantiated only once in a process; isolate all but one, which gives "
                "them processes of their own"
            )


def _every(name: str, every: object) -> int:
    if not isinstance(every, int) or every < 1:
        raise CouplingError(
            f"{name} cannot step every {every} macro steps; give a whole number of at least 1"
        )
    return every


def _note_open_inputs(
    notes: list[str],
    names: list[str],
    descriptions: list[Description],
    open_inputs: list[tuple[int, Variable]],
    values: list[list[tuple[Variable, Value]]],
) -> None:
    """Name the inputs that keep their FMU's start, though it does not call them optional."""
    given = [
        {v.name for v, _ in pairs} | d.optional
        for pairs, d in zip(values, descriptions, strict=True)
    ]
    shown = []
    for instance, variable in open_inputs:
        if variable.name not in given[instance]:
            unit = f" {variable.unit}" if variable.unit else ""
            shown.append(f"{names[instance]}.{variable.name} = {variable.start}{unit}")
    if shown:
        notes.append(f"inputs that nothing drives: {', '.join(shown)}")


def _note_loops(
    notes: list[str], names: list[str], batches: list[Batch], loops: list[Loop]
) -> None:
    for loop in loops:
        inside = [
            f"{names[b.instance]}.{o}" for b in batches[loop.first : loop.last] for o in b.outputs
        ]
        shown = listed(inside, 12)
        notes.append(Detail(f"algebraic loop, solved at every communication point: {shown}"))


def _read(
    outputs: list[tuple[int, Variable]],
    links: list[Link],
    descriptions: list[Description],
    names: list[str],
    wanted: frozenset[str],
) -> list[tuple[int, Variable]]:
    """The outputs that are read: connected, recorded, or the rate of one that is connected."""
    needed = {(link.source, link.output.name) for link in links}
    for instance, name in list(needed):
        for _ in range(2):  # the rate, and the rate of the rate
            if rate := descriptions[instance].rate_of(name):
                name = rate.name
                needed.add((instance, name))
    return [(i, v) for i, v in outputs if f"{names[i]}.{v.name}" in wanted or (i, v.name) in needed]


def _columns(
    count: int, read: list[tuple[int, Variable]], batches: list[Batch]
) -> tuple[list[tuple[int, Variable]], list[int], list[int]]:
    final = {(b.instance, name): n for n, b in enumerate(batches) for name in b.outputs}
    columns: list[tuple[int, Variable]] = []
    first, steady = [0], []
    read_of: list[list[tuple[int, Variable]]] = [[] for _ in range(count)]
    for port in read:
        read_of[port[0]].append(port)
    for own in read_of:
        own.sort(key=lambda port: final.get((port[0], port[1].name), -1))
        steady.append(sum((i, v.name) not in final for i, v in own))
        columns += own
        first.append(len(columns))
    return columns, first, steady


def columns_of(plan: Plan, batch: Batch) -> tuple[int, int]:
    """First and one past the last column of a batch's outputs."""
    numbers = [plan.column_of[batch.instance, name] for name in batch.outputs]
    return min(numbers), max(numbers) + 1


def start_values(plan: Plan) -> Mapping[str, Value]:
    """The values that were given, by full name."""
    return {
        f"{plan.names[i]}.{variable.name}": value
        for i, given in enumerate(plan.values)
        for variable, value in given
    }
