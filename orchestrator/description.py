"""What an FMU says about itself, as far as coupling needs it."""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from .errors import FmuError, choices
from .units import BaseUnit, Definitions


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU. `dependencies` are those of an output; None means on every input."""

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
    items: Mapping[str, int] = field(default_factory=dict)
    description: str = ""
    derivative_of: str | None = None
    dependencies: frozenset[str] | None = frozenset()

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
    """An FMU for co-simulation: its variables, what it can do, and where its binary is."""

    label: str
    variables: Mapping[str, Variable]
    interpolates_inputs: bool = False
    gives_derivatives: bool = False
    single_instance: bool = False
    tangents: tuple[Tangent, ...] = ()
    units: Definitions = field(default_factory=dict)
    fmi_version: str = "2.0"
    guid: str = ""
    model_identifier: str = ""
    binary: str = ""
    sha256: str = ""

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


def describe(path: Path) -> Description:
    """Read an FMU's description; raises FmuError if it cannot be co-simulated on this machine."""
    path = Path(path)
    try:
        stamp = path.stat()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FmuError(f"the FMU '{path}' cannot be read: {reason}") from None
    return _describe(path.resolve(), stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=64)
def _describe(path: Path, _modified: int, _size: int) -> Description:
    from fmpy import read_model_description

    if not path.is_file():
        raise FmuError(f"'{path}' is no FMU: it is a folder")
    if not zipfile.is_zipfile(path):
        raise FmuError(f"'{path}' is no FMU: it is not a zip archive")
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            if "modelDescription.xml" not in names:
                raise FmuError(f"'{path}' is no FMU: it has no modelDescription.xml")
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    except (zipfile.BadZipFile, ElementTree.ParseError, OSError) as error:
        raise FmuError(
            f"'{path}' has a modelDescription.xml that cannot be read: {error}"
        ) from None
    version = root.get("fmiVersion", "")
    if not version.startswith("2."):
        raise FmuError(f"'{path}' is an FMU of FMI {version or '?'}; only FMI 2.0 can be coupled")
    if root.find("CoSimulation") is None:
        raise FmuError(f"'{path}' offers model exchange only; an FMU for co-simulation is needed")
    try:
        read = read_model_description(str(path), validate=False)
    except Exception as error:  # fmpy raises plain exceptions
        raise FmuError(f"'{path}' has a wrong modelDescription.xml: {error}") from None
    variables = _variables(read)
    return Description(
        label=path.name,
        variables=variables,
        interpolates_inputs=read.coSimulation.canInterpolateInputs,
        gives_derivatives=read.coSimulation.providesDirectionalDerivative,
        single_instance=read.coSimulation.canBeInstantiatedOnlyOncePerProcess,
        tangents=_tangents(path, root, variables),
        units=_units(read),
        fmi_version=version,
        guid=read.guid,
        model_identifier=read.coSimulation.modelIdentifier,
        binary=_binary(path, names, read.coSimulation.modelIdentifier),
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
    )


def _variables(read: Any) -> dict[str, Variable]:
    depends = {
        unknown.variable.name: None
        if unknown.dependencies is None
        else frozenset(v.name for v in unknown.dependencies)
        for unknown in read.outputs
    }
    return {v.name: _variable(v, depends.get(v.name)) for v in read.modelVariables}


def _variable(read: Any, dependencies: frozenset[str] | None) -> Variable:
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
        items={item.name: int(item.value) for item in items},
        description=read.description or "",
        derivative_of=read.derivative.name if read.derivative is not None else None,
        dependencies=dependencies,
    )


def _units(read: Any) -> dict[str, BaseUnit]:
    return {
        unit.name: BaseUnit(
            {k: getattr(unit.baseUnit, k) for k in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")},
            unit.baseUnit.factor,
            unit.baseUnit.offset,
        )
        for unit in read.unitDefinitions
        if unit.baseUnit is not None
    }


def _tangents(path: Path, root: Any, variables: Mapping[str, Variable]) -> tuple[Tangent, ...]:
    found = root.findall("VendorAnnotations/Tool[@name='tracktrain']/Coupling/Tangent")
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


def _binary(path: Path, names: list[str], identifier: str) -> str:
    import fmpy

    file = identifier + fmpy.sharedLibraryExtension
    # On ARM the folder of FMI 2 means another processor where the tuple's folder is there as well.
    for folder in (fmpy.platform_tuple, fmpy.platform):
        if f"binaries/{folder}/{file}" in names:
            return f"binaries/{folder}/{file}"
    offered = sorted({n.split("/")[1] for n in names if n.startswith("binaries/") and n[9:]})
    raise FmuError(
        f"'{path}' has no binary for this platform ({fmpy.platform}); "
        + (f"it has: {', '.join(offered)}" if offered else "it has none at all")
    )
