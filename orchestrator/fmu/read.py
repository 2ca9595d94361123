"""Reads an FMU file of any version, and describes it for one of its interfaces."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import fmpy

from ..errors import FmuError, choices
from .archive import check_file, open_archive
from .arrays import taken_apart
from .check import first_problem
from .clocks import clocks_of, with_clocks
from .description import CO_SIMULATION, MODEL_EXCHANGE, Description, Limit, Tangent, Variable
from .units import definitions

DESCRIPTION = "modelDescription.xml"

FAILURES = ("logStatusWarning", "logStatusDiscard", "logStatusError", "logStatusFatal")

_INTERFACES = {
    CO_SIMULATION: "CoSimulation",
    MODEL_EXCHANGE: "ModelExchange",
    "scheduled execution": "ScheduledExecution",
}


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
        # On ARM the folder of FMI 2 means another processor where the tuple's folder is there, too.
        folders = (fmpy.platform_tuple, fmpy.platform)
        file = identifier + fmpy.sharedLibraryExtension
        places = (f"binaries/{folder}/{file}" for folder in folders)
        return next((place for place in places if place in self.members), "")

    @cached_property
    def model(self) -> Any:
        """The model description as fmpy reads it; raises FmuError."""
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
        if problem := first_problem(self.root):
            raise self.wrong(problem)
        try:
            alone = _in_an_archive(ElementTree.tostring(self.root))
            return fmpy.read_model_description(alone, validate=False)
        except Exception as error:  # fmpy raises plain exceptions
            raise self.wrong(error) from None

    def wrong(self, problem: str | Exception) -> FmuError:
        """What to raise where the description is wrong; of an exception, what the schema says."""
        if isinstance(problem, Exception):
            try:
                with open_archive(self.path) as archive:
                    fmpy.read_model_description(_in_an_archive(archive.read(DESCRIPTION)))
            except Exception as found:
                problem = str(next(iter(getattr(found, "problems", [])), problem))
        return FmuError(f"'{self.path}' has a wrong modelDescription.xml: {problem}")


def describe(
    path: Path, sizes: Mapping[str, int] | None = None, interface: str = CO_SIMULATION
) -> Description:
    """Read an FMU's description; raises FmuError if this machine cannot run it that way.

    sizes: values of structural parameters, where they are not those of the start.
    """
    path = Path(path)
    check_file(path, "FMU")
    stamp = path.stat()
    given = tuple(sorted((sizes or {}).items()))
    return _describe(path.resolve(), stamp.st_mtime_ns, stamp.st_size, given, interface)


def open_fmu(path: Path) -> Contents:
    """Open an FMU of any version, for whatever machine; raises FmuError for what is no FMU."""
    path = Path(path)
    check_file(path, "FMU")
    stamp = path.stat()
    return _contents(path, path.resolve(), stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=16)
def _contents(path: Path, _place: Path, _modified: int, _size: int) -> Contents:
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
    try:
        return _survey(contents, interface)
    except FmuError:
        raise
    except Exception as error:  # of what neither the check nor fmpy looked at
        raise contents.wrong(error) from None


def _survey(contents: Contents, interface: str) -> Description:
    interfaces = contents.interfaces
    said = interfaces.get(interface) or next(iter(interfaces.values()), {})
    has_events = _is_true(said, "hasEventMode")
    clocks = clocks_of(contents.root)
    variables = with_clocks(_variables(contents), clocks if has_events else ())
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
        optional=frozenset(e.get("input") for e in _annotated(contents.root, "Coupling/Optional")),
        limits=_limits(contents.path, contents.root, variables),
        units=definitions(model),
        fmi_version=contents.version,
        guid=model.guid or "",
        model_identifier=identifier,
        binary=contents.binary(identifier),
        sha256=_sha256(contents.path),
        failure_categories=tuple(c.name for c in model.logCategories or () if c.name in FAILURES),
        aliases={v.name: v.alias.name for v in model.modelVariables if v.alias is not None},
        has_events=has_events,
        returns_early=_is_true(said, "mightReturnEarlyFromDoStep"),
        clocks=clocks,
        tolerance=_tolerance(contents.root),
    )


@lru_cache(maxsize=64)
def _describe(
    path: Path, _modified: int, _size: int, sizes: tuple[tuple[str, int], ...], interface: str
) -> Description:
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
        raise FmuError(f"'{path}' {_without_binary(contents, description.model_identifier)}")
    return description


def _without_binary(contents: Contents, identifier: str) -> str:
    """Why there is no binary for this machine."""
    wanted = identifier + fmpy.sharedLibraryExtension
    for folder in (fmpy.platform_tuple, fmpy.platform):
        inside = [
            name.rpartition("/")[2]
            for name in contents.members
            if name.rpartition("/")[0] == f"binaries/{folder}" and not name.endswith("/")
        ]
        if inside:
            return (
                f"has no {wanted} in binaries/{folder}, which is what its model identifier "
                f"'{identifier}' calls for; there is {', '.join(inside)}"
            )
    offered = ", ".join(contents.platforms)
    return f"has no binary for this platform ({fmpy.platform}); " + (
        f"it has: {offered}" if offered else "it has none at all"
    )


def _in_an_archive(description: bytes) -> io.BytesIO:
    """A description in an archive that has nothing else, as fmpy reads it."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(DESCRIPTION, description)
    return stream


def _sha256(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _tolerance(root: ElementTree.Element) -> float | None:
    """The tolerance that the default experiment asks for, where it is one."""
    said = root.find("DefaultExperiment")
    try:
        found = float("" if said is None else said.get("tolerance", ""))
    except ValueError:
        return None
    return found if 0.0 < found < float("inf") else None


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
    # Nor whether a variable is a difference, but of its type.
    differences = {
        element.get("name"): _is_true(said, "relativeQuantity")
        for element in contents.root.iterfind("ModelVariables/*")
        for said in (element.attrib, *(inner.attrib for inner in element))
        if "relativeQuantity" in said
    }
    fmi3 = contents.version.startswith("3.")
    called = {v.valueReference: v.name for v in reversed(read.modelVariables)}
    variables = {}
    for v in read.modelVariables:
        if v.alias is None:
            variable = _variable(v, depends.get(v.name), called)
            of_type = v.declaredType is not None and v.declaredType.relativeQuantity
            difference = differences.get(v.name, of_type)
            variable = replace(variable, difference=difference)
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
        unit=attribute("unit") or None,
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
        clocks=tuple(clock.valueReference for clock in read.clocks or ()),
    )


def _limits(path: Path, root: Any, variables: Mapping[str, Variable]) -> tuple[Limit, ...] | None:
    """What the annotation `Range` says that the FMU's laws hold for; None without one."""
    ranges = _annotated(root, "Range")
    if not ranges:
        return None
    limits = []
    for e in ranges[0].findall("Limit"):
        outputs = tuple(e.get("outputs", "").split())
        for name in outputs:
            if not {name, name.partition("[")[0]} & variables.keys():
                available = [v.name for v in variables.values() if v.causality == "output"]
                raise FmuError(
                    f"'{path}' states a range of '{name}', which is no variable of it; "
                    f"{choices(name, available)}"
                )
        texts = {name: e.get(name, "") for name in ("unit", "beyond", "remedy", "source")}
        ends = (_end(path, e.get("min", "-inf")), _end(path, e.get("max", "inf")))
        allowed = _end(path, e.get("allowed", "0"))
        limits.append(Limit(outputs, *ends, **texts, void=e.get("void") == "true", allowed=allowed))
    return tuple(limits)


def _end(path: Path, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise FmuError(f"'{path}' states a range with '{text}', no number") from None


def _annotated(root: Any, place: str) -> list[Any]:
    """What stands at a place in the FMU's annotations for this tool."""
    return [
        *root.findall(f"VendorAnnotations/Tool[@name='tracktrain']/{place}"),
        *root.findall(f"Annotations/Annotation[@type='tracktrain']/{place}"),
    ]


def _tangents(path: Path, root: Any, variables: Mapping[str, Variable]) -> tuple[Tangent, ...]:
    found = _annotated(root, "Coupling/Tangent")
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
