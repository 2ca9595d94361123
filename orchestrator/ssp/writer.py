"""From a system to an archive of the SSP standard."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote
from xml.etree.ElementTree import Element, SubElement

from ..errors import SspError, choices, plain
from ..files import whole_file
from ..fmu.arrays import element_names
from ..fmu.description import Description, Variable
from ..fmu.read import describe
from ..fmu.types import TYPES
from ..fmu.units import Definitions
from ..plan.plan import component_description
from ..system.profile import Profile, write_profile
from ..system.system import STEP, Component, Connection, Experiment, System, split
from ..system.transformation import IDENTITY, Linear, Transformation
from .package import DEFAULT
from .parameter_sets import ParameterSet, UnitsInUse, shape_of, type_in, write_dimensions
from .reader import OSP, OWN, system_of
from .structure import TABLE
from .xml import new_document, text_of

VERSIONS = ("1.0", "2.0")
CONNECTORS = ("input", "output")
WRITTEN = ("Real", "Integer", "Boolean", "String", "Enumeration")
DATE = (1980, 1, 1, 0, 0, 0)
"""That of all members: the same system gives the same bytes."""


def write_ssp(
    system: System | Path | str,
    path: Path | str,
    *,
    name: str | None = None,
    version: str | None = None,
    changes_only: bool = False,
) -> Path:
    """Write a system as an archive: its FMUs, values, connections, experiment and power bonds.

    name: of the system; the file's by default. version: "1.0", or "2.0", which has the types and
    arrays of FMI 3.0; by default the first that will do. changes_only: leave out values that the
    FMUs start with anyway. Raises OrchestratorError.
    """
    system, path = system_of(system), Path(path)
    version = version or _version(system)
    if version not in VERSIONS:
        raise SspError(f"SSP has no version '{version}'; {choices(version, VERSIONS)}")
    archive = _Archive(version, name or plain(path.stem), changes_only)
    members = archive.members(system)
    with whole_file(path) as new, zipfile.ZipFile(new, "w") as file:
        for member, content in members.items():
            info = zipfile.ZipInfo(member, DATE)
            if isinstance(content, Path):  # an FMU, compressed already
                file.writestr(info, content.read_bytes())
            else:
                file.writestr(info, content, zipfile.ZIP_DEFLATED)
    return path


def _version(system: System) -> str:
    fmus = [
        _fmu(name, component)
        for name, component in system.components.items()
        if not isinstance(component.fmu, Profile)
    ]
    return "2.0" if any(describe(fmu).fmi_version.startswith("3") for fmu in fmus) else "1.0"


@dataclass
class _Archive:
    version: str
    name: str
    changes_only: bool
    units: UnitsInUse = field(default_factory=UnitsInUse)
    enumerations: dict[tuple[tuple[str, int], ...], str] = field(default_factory=dict)

    def members(self, system: System) -> dict[str, bytes | Path]:
        """Content of each member; files are given by their paths."""
        fmus = _places(system.components)
        files: dict[str, bytes | Path] = {place: path for path, place in fmus.items()}
        root = new_document("ssd:SystemStructureDescription", self.version, self.name)
        whole = SubElement(root, "ssd:System", name=self.name)
        elements = SubElement(whole, "ssd:Elements")
        descriptions: dict[str, Description] = {}
        for instance, component in system.components.items():
            description = component_description(instance, component)
            descriptions[instance] = description
            if isinstance(component.fmu, Profile):
                files[_place_of(instance)] = write_profile(component.fmu).encode()
                self._table(elements, instance, component.fmu)
                continue
            fmu = fmus[_fmu(instance, component)]
            # All sets have the system's name, by which ecos asks for them.
            parameters = ParameterSet(self.version, self.name)
            values = parameters.write(instance, component, description, self.changes_only)
            place = f"resources/{instance}.ssv" if values else None
            if place and values:
                files[place] = values
            node = self._component(elements, instance, description, fmu, place)
            if component.every > 1:
                step = component.every * (system.experiment.step or STEP)
                _annotation(node, OSP, "osp:StepSizeHint").set("value", repr(step))
        _connect(whole, system.connections, descriptions)
        if system.bonds is not None:
            bonds = _annotation(whole, OWN, "PowerBonds")
            for bond in system.bonds:
                SubElement(bonds, "PowerBond", force=bond.force, velocity=bond.velocity)
        self._enumerations(root)
        self.units.write(root)
        _experiment(root, system.experiment)
        return {DEFAULT: text_of(root), **files}

    def _table(self, parent: Element, instance: str, profile: Profile) -> None:
        """A table as OMSimulator knows it: a CSV file whose columns are outputs."""
        source = quote(_place_of(instance))
        node = SubElement(parent, "ssd:Component", name=instance, type=TABLE, source=source)
        connectors = SubElement(node, "ssd:Connectors")
        connector = SubElement(connectors, "ssd:Connector", name=profile.name, kind="output")
        SubElement(connector, "ssc:Real", self.units.attribute(profile.unit, {}))

    def _component(
        self,
        parent: Element,
        instance: str,
        description: Description,
        fmu: str,
        values: str | None,
    ) -> Element:
        node = SubElement(parent, "ssd:Component", name=instance, source=quote(fmu))
        ports = {
            name: variable
            for name, variable in _whole_variables(description).items()
            if variable.causality in CONNECTORS and TYPES[variable.type].ssp in WRITTEN
        }
        if ports:
            connectors = SubElement(node, "ssd:Connectors")
            for name, port in ports.items():
                connector = SubElement(connectors, "ssd:Connector", name=name, kind=port.causality)
                self._type(connector, port, description.units)
                shape = shape_of(description, name)
                write_dimensions(connector, shape, self.version, f"{instance}.{name}")
        if values:
            bindings = SubElement(node, "ssd:ParameterBindings")
            SubElement(bindings, "ssd:ParameterBinding", source=quote(values))
        return node

    def _type(self, connector: Element, port: Variable, definitions: Definitions) -> None:
        kind = type_in(self.version, port)
        attributes = {}
        if TYPES[port.type].ssp == "Real":
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


def _fmu(instance: str, component: Component) -> Path:
    if component.ports is not None:
        raise SspError(
            f"{instance} is an FMU behind a port map, which cannot be written; give it an FMU with "
            "the ports' own names"
        )
    if component.file is None:
        raise SspError(f"{instance} is a mock, which cannot be written; give it an FMU")
    return component.file.resolve()


def _place_of(instance: str) -> str:
    """Where the table of an instance stands in the archive."""
    return f"resources/{instance}.csv"


def _places(components: Mapping[str, Component]) -> dict[Path, str]:
    """Where each FMU stands in the archive; of two with the same name one is numbered."""
    places: dict[Path, str] = {}
    for instance, component in components.items():
        if isinstance(component.fmu, Profile):
            continue
        path = _fmu(instance, component)
        place, number = f"resources/{path.name}", 2
        while path not in places and place in places.values():
            place, number = f"resources/{path.stem}_{number}{path.suffix}", number + 1
        places.setdefault(path, place)
    return places


def _connect(
    whole: Element, connections: Iterable[Connection], descriptions: Mapping[str, Description]
) -> None:
    connections = tuple(connections)
    if not connections:
        return
    own = {name: _whole_variables(description) for name, description in descriptions.items()}
    parent = SubElement(whole, "ssd:Connections")
    for connection in connections:
        (start, output), (end, port) = split(connection.source), split(connection.target)
        for instance, variable in ((start, output), (end, port)):
            if (
                instance in own
                and variable in descriptions[instance].variables.keys() - own[instance]
            ):
                raise SspError(
                    f"{instance}.{variable} is an element of an array; SSP does not say whether "
                    "elements are numbered from 0 or from 1; connect whole arrays"
                )
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


def _whole_variables(description: Description) -> dict[str, Variable]:
    """An FMU's own variables: arrays of FMI 3.0 whole, by their first elements."""
    if not description.fmi_version.startswith("3"):
        return dict(description.variables)
    whole: dict[str, Variable] = {}
    arrays = {e: name for name, s in description.arrays.items() for e in element_names(name, s)}
    for name, variable in description.variables.items():
        whole.setdefault(arrays.get(name, name), variable)
    return whole
