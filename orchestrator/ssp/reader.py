"""From a file of the SSP standard to a system."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from ..errors import CouplingError
from ..system.system import STEP, Experiment, PowerBond, System
from .bindings import Parameters
from .connections import GIVES, Network, Port, connections, read_network
from .package import Document, open_document
from .structure import Element, read_structure
from .xml import Node

OSP, OMS, OWN = "com.opensimulationplatform", "org.openmodelica", "tracktrain"
"""Types of annotations that are understood: of others the steps, of ours power bonds."""

STEPS = {OSP: ("FixedStepAlgorithm", "baseStepSize"), OMS: ("FixedStepMaster", "stepSize")}
"""Element and attribute of the macro step."""


def read_ssp(
    path: Path | str, variant: str | None = None, *, folder: Path | str | None = None
) -> System:
    """The system of an archive (.ssp), or of a description (.ssd) beside its FMUs.

    Nested systems are flattened: the component `truck` of a system `car` becomes the instance
    `car:truck`. variant: file name or name of the description, where an archive holds several.
    folder: where the FMUs of an archive are unpacked, to stay; without it they are there until
    the program ends. Raises OrchestratorError for what cannot be represented; what has no effect
    is said in the system's notes.
    """
    document, others = open_document(Path(path), variant, None if folder is None else Path(folder))
    root = read_structure(document)
    names, notes = _instances(root)
    if others and variant is None:
        notes.append(f"{document.label} was read; '{path}' also holds {', '.join(others)}")
    network = read_network(root)
    parameters = Parameters(network, names)
    parameters.apply(root)
    notes += [*parameters.notes, *_exposed(root, network, names)]
    experiment = _experiment(document, root)
    every = _multiples(names, experiment.step or STEP, notes)
    notes += _ignored(root)
    return System(
        components={
            name: replace(parameters.of(element), every=every[name])
            for element, name in names.items()
        },
        connections=tuple(connections(root, network, names)),
        bonds=_bonds(root),
        experiment=experiment,
        notes=tuple(notes),
    )


def system_of(given: System | Path | str) -> System:
    """A system as it is, or that of a file as `read_ssp` reads it; raises OrchestratorError."""
    if isinstance(given, System):
        return given
    if isinstance(given, Path | str):
        return read_ssp(given)
    raise CouplingError(
        f"a {type(given).__name__} is no system; give a System, or the path of an .ssp or .ssd file"
    )


def _instances(root: Element) -> tuple[dict[Element, str], list[str]]:
    """A name for each component, unique, without dots and strokes; notes of names that differ."""
    names: dict[Element, str] = {}
    notes = []
    for element in root.components():
        wanted = re.sub(r"[./]", ":", ":".join(element.path))  # NetCDF takes no strokes
        taken, name, number = set(names.values()), wanted, 2
        while name in taken:
            name, number = f"{wanted}_{number}", number + 1
        if name != ":".join(element.path):
            notes.append(f"the {element.label} is called {name}")
        names[element] = name
    return names, notes


def _exposed(root: Element, network: Network, names: Mapping[Element, str]) -> Iterator[str]:
    """A note of where the outputs of the whole system are found."""
    found = []
    for name, connector in root.connectors.items():
        hops = network.chain(Port(root, name)) if connector.kind in GIVES else []
        if hops and hops[0].source.owner.fmu:
            found.append(f"{name} is {names[hops[0].source.owner]}.{hops[0].source.name}")
    if found:
        yield f"outputs of the system '{root.name}', before transformations: {', '.join(found)}"


def _multiples(names: Mapping[Element, str], step: float, notes: list[str]) -> dict[str, int]:
    """How many macro steps each component takes at once, by the annotation that libcosim has.

    A step that is no multiple of the macro step is rounded to one, as libcosim does, and noted.
    """
    multiples = dict.fromkeys(names.values(), 1)
    for element, name in names.items():
        for annotation in element.annotations:
            hint = annotation.find("StepSizeHint") if annotation.get("type") == OSP else None
            if hint:
                asked = hint.number("value")
                if not (math.isfinite(asked) and asked > 0.0):
                    hint.fail(f"{name} cannot take steps of {asked:g} s; give a time above 0")
                multiples[name] = every = max(1, round(asked / step))
                if not math.isclose(every * step, asked, rel_tol=1e-9):
                    notes.append(
                        f"{name} asks for steps of {asked:g} s; it takes {every * step:g} s, a "
                        f"multiple of the macro step of {step:g} s"
                    )
    return multiples


def _ignored(root: Element) -> Iterator[str]:
    """Notes of what the descriptions hold that is for other tools."""
    documents = {element.document.path: element.document for element in _all(root)}
    for document in documents.values():
        found = (
            element.get("type", "")
            for element in document.node.element.iter()
            if element.tag.endswith("}Annotation")
        )
        if types := sorted({*found} - {*STEPS, OWN}):
            yield f"{document.label}: annotations that are not used: {', '.join(types)}"
        if document is not root.document and document.node.find("DefaultExperiment"):
            yield f"{document.label}: its default experiment is not used, being inside of another"


def _all(element: Element) -> Iterator[Element]:
    yield element
    for inner in element.elements.values():
        yield from _all(inner)


def _experiment(document: Document, root: Element) -> Experiment:
    """What the description says, with the step of an annotation at the experiment or the system."""
    node = document.node.find("DefaultExperiment")
    times = [
        node.number(name) if node and node.has(name) else None for name in ("startTime", "stopTime")
    ]
    start, stop = times
    if node and stop is not None and stop <= (start or 0.0):
        node.fail(f"its experiment stops at {stop:g} s, and starts at {start or 0.0:g} s")
    annotations = [*(node.all("Annotations", "Annotation") if node else ()), *root.annotations]
    steps = [
        Node(element, document.label).number(attribute)
        for annotation in annotations
        for tag, attribute in [STEPS.get(annotation.get("type"), ("", ""))]
        for element in annotation.element.iter()
        if tag and element.tag.endswith(f"}}{tag}")
    ]
    return Experiment(times[0], times[1], steps[0] if steps else None)


def _bonds(root: Element) -> tuple[PowerBond, ...] | None:
    for annotation in root.annotations:
        found = annotation.find("PowerBonds")
        if annotation.get("type") == OWN and found:
            return tuple(
                PowerBond(bond.need("force"), bond.need("velocity"))
                for bond in found.all("PowerBond")
            )
    return None
