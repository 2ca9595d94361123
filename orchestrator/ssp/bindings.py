"""Parameter bindings: from parameter sets, maps and prefixes to start values of FMUs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from ..errors import OrchestratorError, SspError
from ..plan.plan import component_description
from ..plan.start_values import resolve
from ..system.system import Component, Value
from .connections import Network, Port, Step, step_to
from .mapping import MapEntry, entries
from .parameter_sets import Given, read_parameters
from .structure import Binding, Element, is_variable

SET_TYPE = "application/x-ssp-parameter-set"
MAP_TYPE = "application/x-ssp-parameter-mapping"


@dataclass
class Parameters:
    """Start values by component, and the files that they are from; later ones replace others."""

    network: Network
    names: Mapping[Element, str]
    values: dict[Element, dict[str, tuple[Value, str]]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def apply(self, element: Element) -> None:
        """The bindings of an element and of all in it: those of outer systems count more."""
        for inner in element.elements.values():
            self.apply(inner)
        for binding in element.bindings:
            self._bind(element, binding)

    def _bind(self, element: Element, binding: Binding) -> None:
        file, values = _parameter_set(element, binding)
        prefix = binding.node.get("prefix")
        named = {prefix + given.name: given for given in values}
        unused = dict.fromkeys(named)
        for entry in _map(element, binding, named):
            if entry.source not in named:
                self.notes.append(f"{file}: there is no {entry.source} to map to {entry.target}")
                continue
            for entrance, target, further in self._targets(element, entry.target):
                unused.pop(entry.source, None)
                self._set(target, named[entry.source], [_step(entry, entrance), *further])
        if unused:
            self.notes.append(
                f"{file}: nothing in the {element.label} takes the parameters {', '.join(unused)}"
            )

    def _targets(self, element: Element, name: str) -> Iterator[tuple[Port, Port, list[Step]]]:
        """What a hierarchical name means: connectors, the FMUs' variables behind, and the ways."""
        if element.fmu:
            if is_variable(element.description, name):
                port = Port(element, name)
                yield port, port, []
            return
        if name in element.connectors:
            entrance = Port(element, name)
            for target, further in self._onward(entrance, []):
                yield entrance, target, further
        for inner in element.elements.values():
            if name.startswith(f"{inner.name}."):
                yield from self._targets(inner, name[len(inner.name) + 1 :])

    def _onward(self, port: Port, steps: list[Step]) -> Iterator[tuple[Port, list[Step]]]:
        """From a system's connector along the connections to the FMUs behind it."""
        for hop in self.network.out_of.get(port, ()):
            further = [*steps, step_to(hop)]
            if hop.target.owner.fmu:
                yield hop.target, further
            else:
                yield from self._onward(hop.target, further)

    def _set(self, target: Port, given: Given, steps: list[Step]) -> None:
        full = f"{self.names[target.owner]}.{target.name}"
        if target in self.network.into and self.network.chain(target)[0].source.owner.fmu:
            self.notes.append(f"the start value of {full} is not used: the input is driven")
            return
        given_before = self.values.setdefault(target.owner, {})
        given_before.pop(target.name, None)  # the order is that of the last word on each
        given_before[target.name] = (given.value(steps), given.node.file)

    def of(self, element: Element) -> Component:
        """A component with its values, checked; raises SspError."""
        assert element.fmu is not None
        name, found = self.names[element], self.values.get(element, {})
        values = {variable: value for variable, (value, _) in found.items()}
        component = Component(element.fmu, values)
        for variable, (value, file) in found.items():
            try:
                resolve(name, component_description(name, component), variable, value)
            except OrchestratorError as error:
                raise SspError(f"'{file}': {error}") from None
        return component


def _parameter_set(element: Element, binding: Binding) -> tuple[str, list[Given]]:
    """The values of a binding, and the file that they are from."""
    node, document = binding.node, binding.document
    wanted = f"a parameter binding of the {element.label}"
    if node.get("type", SET_TYPE) != SET_TYPE:
        document.node.fail(f"{wanted} is of type '{node.get('type')}'; {SET_TYPE} can be read")
    inline = node.find("ParameterValues")
    root = document.part(node, inline, "ParameterSet", wanted, element.file)
    return root.file, read_parameters(root)


def _step(entry: MapEntry, entrance: Port) -> Step:
    """What happens to a value before it enters a system's connector or an FMU."""
    label = f"the parameter {entry.source} sets {entrance.label}"
    return Step(
        entrance.unit,
        entry.transformation,
        entry.suppress_unit_conversion,
        label,
        entrance.owner.document.node,
    )


def _map(element: Element, binding: Binding, names: Iterable[str]) -> tuple[MapEntry, ...]:
    """The entries of a binding's map; each name goes by itself where it has no map."""
    node = binding.node.find("ParameterMapping")
    if node is None:
        return tuple(MapEntry(name, name) for name in names)
    wanted = f"a parameter map of the {element.label}"
    if node.get("type", MAP_TYPE) != MAP_TYPE:
        binding.document.node.fail(
            f"{wanted} is of type '{node.get('type')}'; {MAP_TYPE} can be read"
        )
    return entries(binding.document.part(node, node, "ParameterMapping", wanted, element.file))
