"""What an FMU says about itself, as far as coupling needs it."""

from __future__ import annotations

import hashlib
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from .archive import open_archive
from .errors import FmuError, choices
from .units import Definitions, definitions

DESCRIPTION = "modelDescription.xml"

FAILURES = ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal")

CO_SIMULATION, MODEL_EXCHANGE = "co-simulation", "model exchange"

_INTERFACES = {
    CO_SIMULATION: "CoSimulation",
    MODEL_EXCHANGE: "ModelExchange",
    "scheduled execution": "ScheduledExecution",
}

KINDS = {
    "Real": "real",
    "Float64": "real",
    "Float32": "real",
    "Boolean": "boolean",
    "Enumeration": "enumeration",
    "String": "string",
    "Binary": "binary",
    "Clock": "clock",
}
"""Kind of each type; all others are integers."""


@dataclass(frozen=True)
class Lane:
    """Where a variable's number is in an FMU: element of `value_reference`, which has `size`.

    The variable's value is gain * the FMU's + offset. difference_of: name of the variable whose
    rate it is, where the FMU does not have it.
    """

    value_reference: int
    element: int = 0
    size: int = 1
    gain: float = 1.0
    offset: float = 0.0
    difference_of: str = ""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU. `dependencies`: inputs that an output depends on; None means all.

    reference: by which it is set and read; a number of its own where it has a `lane`, else the
    value reference. dimensions: sizes, or names of the structural parameters that give them; an
    array that is coupled is taken apart into variables without. starts: those of an array.
    interpolated: an input that may vary over a step.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str = "continuous"
    initial: str | None = None
    unit: str | None = None
    start: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float = 0.0
    items: Mapping[str, int] = field(default_factory=dict)
    description: str = ""
    derivative_of: str | None = None
    dependencies: frozenset[str] | None = frozenset()
    shape: tuple[int, ...] = ()
    dimensions: tuple[int | str, ...] = ()
    starts: tuple[str, ...] = ()
    interpolated: bool = True
    clocked: bool = False
    lane: Lane | None = None

    @property
    def kind(self) -> str:
        """What it is whatever its size in memory; one of `KINDS`, or "integer"."""
        return KINDS.get(self.type, "integer")

    @property
    def coupled(self) -> bool:
        """Whether it is a number that masters can exchange."""
        numeric = self.kind not in ("string", "binary", "clock")
        return numeric and not self.shape and not self.clocked

    @property
    def value_reference(self) -> int:
        """By which the FMU knows it."""
        return self.lane.value_reference if self.lane else self.reference

    @property
    def label(self) -> str:
        """Name and unit, as messages show it."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass(frozen=True)
class Tangent:
    """The input `partial` is the derivative of `input` with respect to the FMU's own `output`."""

    input: str
    output: str
    partial: str


@dataclass(frozen=True)
class Description:
    """An FMU for one of its interfaces: its variables, what it can do, and where its binary is.

    failure_categories: those of the standard's log categories for what goes wrong that it has.
    arrays: shapes of those that were taken apart into elements. aliases: other names of variables.
    has_events: it has the event mode of FMI 3.0. returns_early: it may end a step early.
    input_order: the highest derivative of an input that is taken; of a file it is 1.
    needs_tool: it runs in the tool that it is from.
    """

    label: str
    variables: Mapping[str, Variable]
    interpolates_inputs: bool = False
    input_order: int = 1
    saves_state: bool = False
    variable_step: bool = False
    gives_derivatives: bool = False
    single_instance: bool = False
    needs_tool: bool = False
    serializes_state: bool = False
    tangents: tuple[Tangent, ...] = ()
    units: Definitions = field(default_factory=dict)
    fmi_version: str = "2.0"
    guid: str = ""
    model_identifier: str = ""
    binary: str = ""
    sha256: str = ""
    failure_categories: tuple[str, ...] = ()
    arrays: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    aliases: Mapping[str, str] = field(default_factory=dict)
    has_events: bool = False
    returns_early: bool = False

    def find(self, name: str) -> Variable | None:
        """The variable of a name, which may be an alias."""
        return self.variables.get(name) or self.variables.get(self.aliases.get(name, ""))

    def interpolates(self, variable: Variable) -> bool:
        """Whether an input can be led along a line over a step."""
        continuous = variable.kind == "real" and variable.interpolated
        return self.interpolates_inputs and continuous

    @property
    def inputs(self) -> list[Variable]:
        return [v for v in self.variables.values() if v.causality == "input"]

    @property
    def outputs(self) -> list[Variable]:
        return [v for v in self.variables.values() if v.causality == "output"]

    @property
    def partials(self) -> frozenset[str]:
        """Inputs that take a partial derivative; unconnected they stay at their start."""
        return frozenset(tangent.partial for tangent in self.tangents)

    def rate_of(self, output: str) -> Variable | None:
        """The output that is declared to be the time derivative of `output`."""
        return next((v for v in self.outputs if v.derivative_of == output), None)


@dataclass(frozen=True)
class Contents:
    """An FMU file of any version of FMI: its members and its model description."""

    path: Path
    members: tuple[str, ...]
    root: ElementTree.Element

    @property
    def version(self) -> str:
        return self.root.get("fmiVersion", "")

    @property
    def interfaces(self) -> dict[str, Mapping[str, str]]:
        """What each interface that the FMU offers says of itself, by the interface's name."""
        if self.version.startswith("1."):  # which has the capabilities further down
            implementation = self.root.find("Implementation")
            if implementation is None:
                return {MODEL_EXCHANGE: self.root.attrib}
            said = implementation.find(".//Capabilities")
            return {CO_SIMULATION: self.root.attrib | ({} if said is None else said.attrib)}
        found = {name: self.root.find(tag) for name, tag in _INTERFACES.items()}
        return {name: element.attrib for name, element in found.items() if element is not None}

    @property
    def platforms(self) -> list[str]:
        """Folders with binaries, as FMI names platforms."""
        inside = (name.split("/") for name in self.members if name.startswith("binaries/"))
        return sorted({parts[1] for parts in inside if len(parts) > 2 and parts[2]})

    def binary(self, identifier: str) -> str:
        """Member with the shared library for this machine; empty if there is none."""
        import fmpy

        # On ARM the folder of FMI 2 means another processor where the tuple's folder is there, too.
        folders = (fmpy.platform_tuple, fmpy.platform)
        file = identifier + fmpy.sharedLibraryExtension
        places = (f"binaries/{folder}/{file}" for folder in folders)
        return next((place for place in places if place in self.members), "")

    @cached_property
    def model(self) -> Any:
        """The model description as fmpy reads it; raises FmuError."""
        from fmpy import read_model_description

        if self.root.tag != "fmiModelDescription":
            raise FmuError(
                f"'{self.path}' has a wrong modelDescription.xml: it begins with "
                f"'{self.root.tag}', not with 'fmiModelDescription'"
            )
        if self.version not in ("1.0", "2.0") and not self.version.startswith("3."):
            raise FmuError(
                f"'{self.path}' is an FMU of FMI {self.version or '?'}; FMI 1.0, 2.0 and 3.0 can "
                "be read"
            )
        try:
            return read_model_description(str(self.path), validate=False)
        except Exception as error:  # fmpy raises plain exceptions
            problem = _first_problem(self.path, error)
            raise FmuError(f"'{self.path}' has a wrong modelDescription.xml: {problem}") from None


def describe(
    path: Path, sizes: Mapping[str, int] | None = None, interface: str = CO_SIMULATION
) -> Description:
    """Read an FMU's description; raises FmuError if this machine cannot run it that way.

    sizes: values of structural parameters, where they are not those of the start.
    """
    path = Path(path)
    stamp = _stat(path)
    given = tuple(sorted((sizes or {}).items()))
    return _describe(path.resolve(), stamp.st_mtime_ns, stamp.st_size, given, interface)


def open_fmu(path: Path) -> Contents:
    """Open an FMU of any version, for whatever machine; raises FmuError for what is no FMU."""
    path = Path(path)
    _stat(path)
    if path.is_dir():
        raise FmuError(f"'{path}' is no FMU: it is a folder")
    if not zipfile.is_zipfile(path):
        raise FmuError(f"'{path}' is no FMU: it is not a zip archive")
    with open_archive(path) as archive:
        if DESCRIPTION not in archive.members:
            raise FmuError(f"'{path}' is no FMU: it has no {DESCRIPTION}")
        return Contents(path, archive.members, archive.xml(DESCRIPTION))


def survey(contents: Contents, interface: str = CO_SIMULATION) -> Description:
    """Description of any FMU, also of one that cannot be coupled; raises FmuError if it is wrong.

    It is that of another interface where the FMU does not offer this one. `binary` is empty if this
    machine's is missing.
    """
    interfaces = contents.interfaces
    said = interfaces.get(interface) or next(iter(interfaces.values()), {})
    variables = _variables(contents)
    identifier, model = said.get("modelIdentifier", ""), contents.model
    return Description(
        label=contents.path.name,
        variables=variables,
        interpolates_inputs=_is_true(said, "canInterpolateInputs", "providesIntermediateUpdate"),
        saves_state=_is_true(said, "canGetAndSetFMUstate", "canGetAndSetFMUState"),
        variable_step=_is_true(said, "canHandleVariableCommunicationStepSize"),
        gives_derivatives=_is_true(
            said, "providesDirectionalDerivative", "providesDirectionalDerivatives"
        ),
        single_instance=_is_true(said, "canBeInstantiatedOnlyOncePerProcess"),
        needs_tool=_is_true(said, "needsExecutionTool"),
        serializes_state=_is_true(said, "canSerializeFMUstate", "canSerializeFMUState"),
        tangents=_tangents(contents.path, contents.root, variables),
        units=definitions(model),
        fmi_version=contents.version,
        guid=model.guid or "",
        model_identifier=identifier,
        binary=contents.binary(identifier),
        sha256=hashlib.sha256(contents.path.read_bytes()).hexdigest(),
        failure_categories=tuple(c.name for c in model.logCategories or () if c.name in FAILURES),
        aliases={v.name: v.alias.name for v in model.modelVariables if v.alias is not None},
        has_events=_is_true(said, "hasEventMode"),
        returns_early=_is_true(said, "mightReturnEarlyFromDoStep"),
    )


@lru_cache(maxsize=64)
def _describe(
    path: Path, _modified: int, _size: int, sizes: tuple[tuple[str, int], ...], interface: str
) -> Description:
    import fmpy

    from .arrays import taken_apart

    contents = open_fmu(path)
    if not contents.version.startswith(("2.", "3.")):
        raise FmuError(
            f"'{path}' is an FMU of FMI {contents.version or '?'}; FMI 2.0 and 3.0 can be coupled"
        )
    if interface not in contents.interfaces:
        offered = " and ".join(contents.interfaces) or "nothing"
        raise FmuError(f"'{path}' offers {offered} only; an FMU for {interface} is needed")
    description = taken_apart(survey(contents, interface), dict(sizes))
    if not description.binary:
        offered = ", ".join(contents.platforms)
        raise FmuError(
            f"'{path}' has no binary for this platform ({fmpy.platform}); "
            + (f"it has: {offered}" if offered else "it has none at all")
        )
    return description


def _stat(path: Path) -> os.stat_result:
    try:
        return path.stat()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FmuError(f"the FMU '{path}' cannot be read: {reason}") from None


def _first_problem(path: Path, error: Exception) -> str:
    """What the schema finds wrong, which says it better than the error that it led to."""
    from fmpy import read_model_description

    try:
        read_model_description(str(path))
    except Exception as found:
        return str(next(iter(getattr(found, "problems", [])), error))
    return str(error)


def _is_true(attributes: Mapping[str, str], *names: str) -> bool:
    return any(attributes.get(name) in ("true", "1") for name in names)


def _variables(contents: Contents) -> dict[str, Variable]:
    read = contents.model
    depends = {
        unknown.variable.name: None
        if unknown.dependencies is None
        else frozenset(v.name for v in unknown.dependencies if v.causality == "input")
        for unknown in read.outputs
    }
    for element in contents.root.iterfind("ModelVariables/ScalarVariable[DirectDependency]"):
        names = element.iterfind("DirectDependency/Name")  # as FMI 1 says it
        depends[element.get("name", "")] = frozenset(name.text or "" for name in names)
    # fmpy reads the first start of a text only, and not which inputs may vary within a step.
    texts = {
        element.get("name"): tuple(start.get("value", "") for start in element.iterfind("Start"))
        for element in contents.root.iterfind("ModelVariables/String")
    }
    varying = {
        element.get("name")
        for element in contents.root.iterfind("ModelVariables/*[@intermediateUpdate]")
        if _is_true(element.attrib, "intermediateUpdate")
    }
    fmi3 = contents.version.startswith("3.")
    called = {v.valueReference: v.name for v in reversed(read.modelVariables)}
    variables = {}
    for v in read.modelVariables:
        if v.alias is None:
            variable = _variable(v, depends.get(v.name), called)
            if fmi3:
                starts = texts.get(v.name) or tuple((variable.start or "").split())
                variable = replace(
                    variable,
                    starts=starts if variable.shape else (),
                    interpolated=v.name in varying and v.variability == "continuous",
                )
            variables[v.name] = variable
    return variables


def _variable(read: Any, dependencies: frozenset[str] | None, names: Mapping[int, str]) -> Variable:
    declared = read.declaredType
    items = declared.items if declared is not None and read.type == "Enumeration" else ()

    def attribute(name: str) -> Any:
        value = getattr(read, name)
        return getattr(declared, name) if value is None and declared is not None else value

    minimum, maximum = attribute("min"), attribute("max")
    return Variable(
        name=read.name,
        reference=read.valueReference,
        type=read.type,
        causality=read.causality,
        variability=read.variability,
        initial=read.initial,
        unit=attribute("unit"),
        start=read.start,
        minimum=None if minimum is None else float(minimum),
        maximum=None if maximum is None else float(maximum),
        nominal=abs(float(attribute("nominal") or 0.0)),
        items={item.name: int(item.value) for item in items},
        description=read.description or "",
        derivative_of=read.derivative.name if read.derivative is not None else None,
        dependencies=dependencies,
        shape=read.shape or (),
        dimensions=tuple(
            names[d.valueReference] if d.start is None else int(d.start) for d in read.dimensions
        ),
        clocked=bool(read.clocks) and read.type != "Clock",
    )


def _tangents(path: Path, root: Any, variables: Mapping[str, Variable]) -> tuple[Tangent, ...]:
    found = [
        *root.findall("VendorAnnotations/Tool[@name='tracktrain']/Coupling/Tangent"),
        *root.findall("Annotations/Annotation[@type='tracktrain']/Coupling/Tangent"),
    ]
    tangents = tuple(Tangent(e.get("input"), e.get("output"), e.get("partial")) for e in found)
    for tangent in tangents:
        for role, causality in (("input", "input"), ("output", "output"), ("partial", "input")):
            name = getattr(tangent, role)
            if name not in variables or variables[name].causality != causality:
                available = [v.name for v in variables.values() if v.causality == causality]
                raise FmuError(
                    f"'{path}' declares a tangent with the {role} '{name}', which is no "
                    f"{causality} of it; {choices(str(name), available)}"
                )
    return tangents
