"""The tree of systems and components that a description means, nested files included."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..errors import choices
from ..fmu.arrays import element_names, shaped
from ..fmu.description import Description, Variable
from ..fmu.read import describe
from ..fmu.types import TYPES
from ..system.profile import TIME, Profile, read_profile
from .package import Document
from .xml import Node

FMU = "application/x-fmu-sharedlibrary"
SSD = "application/x-ssp-definition"
SSP = "application/x-ssp-package"
SSB = "application/x-ssp-signal-dictionary"
TABLE = "application/table"
"""A component that is a table over time, as OMSimulator writes and reads it."""

DEEPEST = 32
"""Systems nested deeper than this contain themselves."""

CAUSALITIES = {"input", "output", "parameter", "calculatedParameter", "structuralParameter"}


@dataclass(frozen=True)
class Connector:
    """A connector as it is declared; the unit is None where it is left to what is behind it.

    sizes: of an array, with None for what is not said or depends on a parameter.
    """

    kind: str
    type: str | None = None
    unit: str | None = None
    sizes: tuple[int | None, ...] = ()


@dataclass(frozen=True)
class Binding:
    """A ParameterBinding and the description that it stands in."""

    node: Node
    document: Document


@dataclass(frozen=True, eq=False)
class Element:
    """A component (with an FMU or a table), a system (with elements), or a dictionary."""

    name: str
    path: tuple[str, ...]
    document: Document
    connectors: Mapping[str, Connector]
    bindings: tuple[Binding, ...]
    fmu: Path | Profile | None = None
    elements: Mapping[str, Element] = field(default_factory=dict)
    connections: tuple[Node, ...] = ()
    annotations: tuple[Node, ...] = ()

    @property
    def label(self) -> str:
        """As messages name it."""
        return f"component '{'.'.join(self.path)}'" if self.fmu else f"system '{self.name}'"

    @property
    def description(self) -> Description:
        """That of its FMU or table."""
        assert self.fmu is not None
        return describe(self.fmu) if isinstance(self.fmu, Path) else self.fmu.description

    @property
    def file(self) -> Path | None:
        """Its FMU; None for a table or a system."""
        return self.fmu if isinstance(self.fmu, Path) else None

    def components(self) -> Iterator[Element]:
        """All components below, or itself."""
        if self.fmu:
            yield self
        for element in self.elements.values():
            yield from element.components()


def is_variable(description: Description, name: str) -> bool:
    """Whether an FMU has a variable, an alias of one or an array of that name."""
    return description.find(name) is not None or name in description.arrays


def variable_of(description: Description, name: str) -> Variable:
    """An FMU's variable of that name; of an array the first element."""
    found = description.find(name)
    return found or description.variables[element_names(name, description.arrays[name])[0]]


def read_structure(document: Document) -> Element:
    """The root system with all below it; raises SspError for what cannot be represented."""
    system = document.node.find("System")
    if system is None:
        document.node.fail("it has no <System>")
    return _system(system, document, (), {})


Dictionaries = Mapping[str, Element]
"""Signal dictionaries that a system sees, its own before those of the systems around it."""


def _system(
    node: Node,
    document: Document,
    path: tuple[str, ...],
    around: Dictionaries,
    name: str | None = None,
    more: tuple[Binding, ...] = (),
) -> Element:
    """A System element; `more` are bindings of a component that stands for it."""
    if len(path) > DEEPEST:
        document.node.fail(f"the system '{node.get('name')}' is nested in itself, without end")
    seen = {**around, **read_dictionaries(node, document)}
    elements: dict[str, Element] = {}
    for group in node.all("Elements"):
        for child in group:
            inner = child.need("name")
            if inner in elements:
                document.node.fail(f"the system '{node.get('name')}' has two elements '{inner}'")
            made = {"Component": _component, "System": _system}.get(child.tag, _dictionary)
            elements[inner] = made(child, document, (*path, inner), seen)
    return Element(
        name=name or node.need("name"),
        path=path,
        document=document,
        connectors=_connectors(node),
        bindings=_bindings(node, document) + more,
        elements=elements,
        connections=tuple(node.all("Connections", "Connection")),
        annotations=tuple(node.all("Annotations", "Annotation")),
    )


def _dictionary(
    node: Node, document: Document, path: tuple[str, ...], around: Dictionaries
) -> Element:
    """The dictionary that a SignalDictionaryReference means: one for all that refer to it."""
    if node.tag != "SignalDictionaryReference":
        document.node.fail(f"<{node.tag}> is no element of a system that SSP knows")
    name, label = node.need("dictionary"), f"the signal dictionary reference '{'.'.join(path)}'"
    if name not in around:
        document.node.fail(f"{label} refers to '{name}'; {choices(name, around)}")
    for connector in _connectors(node):
        if connector not in around[name].connectors:
            document.node.fail(
                f"{label} has a connector '{connector}', which is no entry of '{name}'; "
                f"{choices(connector, around[name].connectors)}"
            )
    return around[name]


def _component(
    node: Node, document: Document, path: tuple[str, ...], around: Dictionaries
) -> Element:
    name, label = path[-1], f"the component '{'.'.join(path)}'"
    if not node.has("source"):
        document.node.fail(f"{label} has no source: a design without an implementation")
    kind, source = node.get("type", FMU), node.get("source")
    if source.startswith("#"):
        return _reference(node, document, path, around)
    place, fragment = document.place(source, label)
    if kind in (SSD, SSP) or (not node.has("type") and place.suffix.lower() in (".ssd", ".ssp")):
        nested = document.inner(place, fragment or None)
        system = nested.node.find("System")
        if system is None:
            nested.node.fail("it has no <System>")
        return _system(system, nested, path, around, name, _bindings(node, document))
    if kind not in (FMU, TABLE):
        document.node.fail(f"{label} is of type '{kind}'; {choices(kind, (FMU, SSD, SSP, TABLE))}")
    implementation = node.get("implementation", "any")
    if implementation not in ("any", "CoSimulation"):
        document.node.fail(f"{label} is to run as {implementation}; only CoSimulation can be run")
    made = place if kind == FMU else _table(node, place, label)
    element = Element(
        name, path, document, _connectors(node), _bindings(node, document), made,
        annotations=tuple(node.all("Annotations", "Annotation")),
    )  # fmt: skip
    for connector in element.connectors:
        _check_connector(element, connector)
    return element


def _table(node: Node, place: Path, label: str) -> Profile:
    """The column over time that the component's one connector means, in the connector's unit."""
    connectors = _connectors(node)
    if len(connectors) != 1:
        node.fail(f"{label} is a table with {len(connectors)} connectors; one output can be read")
    ((name, connector),) = connectors.items()
    return read_profile(place, name, units={TIME: "s", name: connector.unit or "1"})


def _reference(
    node: Node, document: Document, path: tuple[str, ...], around: Dictionaries
) -> Element:
    """A component that stands for a system of the same file."""
    wanted = node.get("source")[1:]
    systems = [
        Node(e, document.label) for e in document.node.element.iter() if e.tag.endswith("}System")
    ]
    named = {system.get("id"): system for system in systems if system.has("id")}
    if wanted not in named:
        document.node.fail(
            f"the component '{'.'.join(path)}' refers to the system '#{wanted}'; "
            f"{choices(wanted, named)}"
        )
    return _system(named[wanted], document, path, around, path[-1], _bindings(node, document))


def _bindings(node: Node, document: Document) -> tuple[Binding, ...]:
    return tuple(Binding(b, document) for b in node.all("ParameterBindings", "ParameterBinding"))


def _connectors(node: Node) -> Mapping[str, Connector]:
    return {
        connector.need("name"): _connector(connector, connector.need("kind"))
        for connector in node.all("Connectors", "Connector")
    }


def _connector(node: Node, kind: str) -> Connector:
    typed = next((child for child in node if child.tag in TYPES), None)
    sizes = tuple(
        dimension.whole("size") if dimension.has("size") else None
        for dimension in node.all("Dimension")
    )
    if typed is None:
        return Connector(kind, sizes=sizes)
    return Connector(kind, typed.tag, typed.get("unit") or None, sizes)


def read_dictionaries(system: Node, document: Document) -> Dictionaries:
    """A system's signal dictionaries by name, their entries being connectors of either kind."""
    found = {}
    for node in system.all("SignalDictionaries", "SignalDictionary"):
        name = node.need("name")
        label = f"the signal dictionary '{name}'"
        if node.get("type", SSB) != SSB:
            document.node.fail(f"{label} is of type '{node.get('type')}'; {SSB} can be read")
        root = document.part(node, node, "SignalDictionary", label)
        entries = {
            entry.need("name"): _connector(entry, "inout") for entry in root.all("DictionaryEntry")
        }
        found[name] = Element(name, (name,), replace(document, node=root), entries, ())
    return found


def _check_connector(element: Element, name: str) -> None:
    """Raise SspError unless a component's connector is what its FMU says."""
    declared, description = element.connectors[name], element.description
    fail, label = element.document.node.fail, f"the connector '{name}' of the {element.label}"
    if not is_variable(description, name):
        fail(
            f"{label} is no variable of '{description.label}'; "
            f"{choices(name, description.variables)}"
        )
    variable = variable_of(description, name)
    if declared.kind in CAUSALITIES and declared.kind != variable.causality:
        fail(f"{label} is declared {declared.kind}, but is {variable.causality} of its FMU")
    if declared.type and TYPES[declared.type].ssp != TYPES[variable.type].ssp:
        fail(f"{label} is declared {declared.type}, but is {variable.type} in its FMU")
    shape = description.arrays.get(name, ())
    fits = len(shape) == len(declared.sizes) and all(
        size in (None, actual) for size, actual in zip(declared.sizes, shape, strict=True)
    )
    if declared.sizes and not fits and not _is_sizable(description):
        said = shaped(tuple(size or 0 for size in declared.sizes))
        actual = f"an array of {shaped(shape)}" if shape else "no array"
        fail(f"{label} is declared an array of {said}, but is {actual} in its FMU")


def _is_sizable(description: Description) -> bool:
    """Whether sizes of an FMU's arrays depend on its parameters."""
    return any(v.causality == "structuralParameter" for v in description.variables.values())
