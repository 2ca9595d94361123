"""From a system to an archive of the SSP standard."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from ..description import Description, Variable, describe
from ..errors import SspError, UnitError, choices
from ..mock import Mock
from ..system import Component, Connection, Experiment, System, Value, split
from ..transformation import IDENTITY, Linear, Transformation
from ..units import BaseUnit, Definitions, base_unit, quantity
from ..values import resolve
from .package import DEFAULT
from .reader import OSP, OWN
from .structure import TYPES
from .xml import NAMESPACES

VERSIONS = ("1.0", "2.0")
CONNECTORS = ("input", "output")
DATE = (1980, 1, 1, 0, 0, 0)
"""That of all members: the same system gives the same bytes."""


def write_ssp(
    system: System,
    path: Path | str,
    *,
    name: str | None = None,
    version: str = "1.0",
    changes_only: bool = False,
) -> Path:
    """Write a system as an archive: its FMUs, values, connections, experiment and power bonds.

    name: of the system; the file's by default. version: "1.0" or "2.0". changes_only: leave out
    values that the FMUs start with anyway. Raises OrchestratorError.
    """
    path = Path(path)
    if version not in VERSIONS:
        raise SspError(f"SSP has no version '{version}'; {choices(version, VERSIONS)}")
    archive = _Archive(version, name or path.stem, changes_only)
    members = archive.members(system)
    try:
        with zipfile.ZipFile(path, "w") as file:
            for member, content in members.items():
                info = zipfile.ZipInfo(member, DATE)
                if isinstance(content, Path):  # an FMU, compressed already
                    file.writestr(info, content.read_bytes())
                else:
                    file.writestr(info, content, zipfile.ZIP_DEFLATED)
    except OSError as error:
        path.unlink(missing_ok=True)
        reason = (error.strerror or str(error)).lower()
        raise SspError(f"'{path}' cannot be written: {reason}") from None
    return path


@dataclass
class _Units:
    """Units that a file refers to and therefore defines."""

    defined: dict[str, BaseUnit] = field(default_factory=dict)

    def attribute(self, unit: str | None, definitions: Definitions) -> dict[str, str]:
        """The attribute that refers to a unit; none for what SSP cannot define."""
        try:
            found = base_unit(unit, definitions) if unit else None
        except UnitError:
            return {}
        if unit is None or found is None:
            return {}
        self.defined[unit] = found
        return {"unit": unit}

    def write(self, parent: Element) -> None:
        if self.defined:
            units = SubElement(parent, f"{parent.tag.partition(':')[0]}:Units")
            for name, unit in sorted(self.defined.items()):
                exponents = {k: str(n) for k, n in unit.exponents.items() if n}
                scale = {"factor": repr(unit.factor)} if unit.factor != 1.0 else {}
                if unit.offset:
                    scale["offset"] = repr(unit.offset)
                one = SubElement(units, "ssc:Unit", name=name)
                SubElement(one, "ssc:BaseUnit", exponents | scale)


@dataclass
class _Archive:
    version: str
    name: str
    changes_only: bool
    units: _Units = field(default_factory=_Units)
    enumerations: dict[tuple[tuple[str, int], ...], str] = field(default_factory=dict)

    def members(self, system: System) -> dict[str, bytes | Path]:
        """Content of each member; files are given by their paths."""
        fmus = _places(system.components)
        files: dict[str, bytes | Path] = {place: path for path, place in fmus.items()}
        root = self._root("ssd:SystemStructureDescription", self.name)
        whole = SubElement(root, "ssd:System", name=self.name)
        elements = SubElement(whole, "ssd:Elements")
        for instance, component in system.components.items():
            values = self._parameter_set(instance, component)
            place = f"resources/{instance}.ssv" if values else None
            if place and values:
                files[place] = values
            fmu = fmus[_fmu(instance, component)]
            self._component(elements, instance, component, fmu, place)
        _connect(whole, system.connections)
        if system.bonds is not None:
            bonds = _annotation(whole, OWN, "PowerBonds")
            for bond in system.bonds:
                SubElement(bonds, "PowerBond", force=bond.force, velocity=bond.velocity)
        self._enumerations(root)
        self.units.write(root)
        _experiment(root, system.experiment)
        return {DEFAULT: _text(root), **files}

    def _root(self, tag: str, name: str) -> Element:
        return Element(tag, version=self.version, name=name, generationTool="tracktrain")

    def _component(
        self, parent: Element, instance: str, component: Component, fmu: str, values: str | None
    ) -> None:
        description = describe(_fmu(instance, component))
        node = SubElement(parent, "ssd:Component", name=instance, source=quote(fmu))
        ports = [v for v in description.variables.values() if v.causality in CONNECTORS]
        if ports:
            connectors = SubElement(node, "ssd:Connectors")
            for port in ports:
                connector = SubElement(
                    connectors, "ssd:Connector", name=port.name, kind=port.causality
                )
                self._type(connector, port, description.units)
        if values:
            bindings = SubElement(node, "ssd:ParameterBindings")
            SubElement(bindings, "ssd:ParameterBinding", source=quote(values))

    def _type(self, connector: Element, port: Variable, definitions: Definitions) -> None:
        kind = port.type if self.version != "1.0" else TYPES[port.type]
        attributes = {}
        if TYPES[port.type] == "Real":
            attributes = self.units.attribute(port.unit, definitions)
        elif kind == "Enumeration":
            items = tuple(port.items.items())
            number = len(self.enumerations) + 1
            attributes = {"name": self.enumerations.setdefault(items, f"enumeration_{number}")}
        SubElement(connector, f"ssc:{kind}", attributes)

    def _enumerations(self, root: Element) -> None:
        if self.enumerations:
            parent = SubElement(root, "ssd:Enumerations")
            for items, name in self.enumerations.items():
                node = SubElement(parent, "ssc:Enumeration", name=name)
                for item, value in items:
                    SubElement(node, "ssc:Item", name=item, value=str(value))

    def _parameter_set(self, instance: str, component: Component) -> bytes | None:
        """A component's values; all sets have the system's name, by which ecos asks for them."""
        description = describe(_fmu(instance, component))
        root, units = self._root("ssv:ParameterSet", self.name), _Units()
        parameters = SubElement(root, "ssv:Parameters")
        for name, value in component.parameters.items():
            resolved = resolve(instance, description, name, value)
            whole = len(resolved) == 1 and not isinstance(value, list | tuple)
            for variable, fitting in resolved:
                if self.changes_only and _is_start(instance, description, variable, fitting):
                    continue
                called = name if whole else variable.name
                parameter = SubElement(parameters, "ssv:Parameter", name=called)
                kind, text, unit = _spelled(variable, value if whole else fitting, fitting)
                attributes = units.attribute(unit, description.units) if kind == "Real" else {}
                if unit and not attributes and unit != variable.unit:
                    text = repr(fitting)
                SubElement(parameter, f"ssv:{kind}", {"value": text, **attributes})
        units.write(root)
        return _text(root) if len(parameters) else None


def _is_start(instance: str, description: Description, variable: Variable, value: Value) -> bool:
    """Whether a variable has the value anyway."""
    start = variable.start
    if start is None:
        return False
    [(_, usual)] = resolve(instance, description, variable.name, start)
    return usual == value


def _spelled(variable: Variable, given: Value, fitting: Value) -> tuple[str, str, str | None]:
    """Type, text and unit of a value as it was given; `fitting` is what its variable gets."""
    kind = TYPES[variable.type]
    if kind == "Real" and isinstance(given, str):
        _, unit = quantity(given)
        return kind, given.strip().removesuffix(unit).strip(), unit or variable.unit
    if kind == "Real":
        return kind, repr(float(str(fitting))), variable.unit
    if kind == "Enumeration":
        names = {number: name for name, number in variable.items.items()}
        return kind, names[int(str(fitting))], None
    return kind, str(fitting).lower() if kind == "Boolean" else str(fitting), None


def _fmu(instance: str, component: Component) -> Path:
    if isinstance(component.fmu, Mock):
        raise SspError(f"{instance} is a mock, which cannot be written; give it an FMU")
    return Path(component.fmu).resolve()


def _places(components: Mapping[str, Component]) -> dict[Path, str]:
    """Where each FMU stands in the archive; of two with the same name one is numbered."""
    places: dict[Path, str] = {}
    for instance, component in components.items():
        path = _fmu(instance, component)
        place, number = f"resources/{path.name}", 2
        while path not in places and place in places.values():
            place, number = f"resources/{path.stem}_{number}{path.suffix}", number + 1
        places.setdefault(path, place)
    return places


def _connect(whole: Element, connections: Iterable[Connection]) -> None:
    connections = tuple(connections)
    if not connections:
        return
    parent = SubElement(whole, "ssd:Connections")
    for connection in connections:
        (start, output), (end, port) = split(connection.source), split(connection.target)
        ends = {"startElement": start, "startConnector": output}
        ends |= {"endElement": end, "endConnector": port}
        if connection.suppress_unit_conversion:
            ends["suppressUnitConversion"] = "true"
        _transform(SubElement(parent, "ssd:Connection", ends), connection.transformation)


def _transform(parent: Element, transformation: Transformation) -> None:
    if transformation == IDENTITY:
        return
    if isinstance(transformation, Linear):
        factor, offset = repr(transformation.factor), repr(transformation.offset)
        SubElement(parent, "ssc:LinearTransformation", factor=factor, offset=offset)
        return
    table = SubElement(parent, f"ssc:{transformation.kind}MappingTransformation")
    for source, target in transformation.entries:
        ends = [str(end).lower() if isinstance(end, bool) else str(end) for end in (source, target)]
        SubElement(table, "ssc:MapEntry", source=ends[0], target=ends[1])


def _experiment(root: Element, experiment: Experiment) -> None:
    times = {"startTime": experiment.start, "stopTime": experiment.stop}
    given = {name: repr(float(time)) for name, time in times.items() if time is not None}
    if given or experiment.step is not None:
        node = SubElement(root, "ssd:DefaultExperiment", given)
        if experiment.step is not None:
            algorithm = _annotation(node, OSP, "osp:Algorithm")
            step = repr(float(experiment.step))
            SubElement(algorithm, "osp:FixedStepAlgorithm", baseStepSize=step)


def _annotation(parent: Element, kind: str, tag: str) -> Element:
    annotations = SubElement(parent, "ssd:Annotations")
    return SubElement(SubElement(annotations, "ssc:Annotation", type=kind), tag)


def _text(root: Element) -> bytes:
    """The document, with the prefixes that the standard uses: some readers know no others."""
    used = {tag.partition(":")[0] for node in root.iter() if ":" in (tag := node.tag)}
    for prefix in sorted(used):
        root.set(f"xmlns:{prefix}", NAMESPACES[prefix])
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
