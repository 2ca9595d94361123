"""Reference results in an FMU, as FMI's layered standard for related files (FMI-LS-REF) has it.

Version 1.0.0-alpha.1; the experiment is written in the format that it refers to, of the Modelica
Association (ma-hs-experiments).
"""

from __future__ import annotations

import hashlib
from pathlib import PurePosixPath
from xml.etree.ElementTree import Element, SubElement

from ...describe.experiment import STEP, Reference
from . import document

FOLDER = PurePosixPath("extra/org.fmi-standard.fmi-ls-ref")
MANIFEST = "{http://fmi-standard.org/fmi-ls-manifest}fmi-ls-"
PARAMETER_SET = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"


def references(experiment: Reference) -> dict[str, bytes]:
    """The files by their place in the archive."""
    related = {
        "experiment.exp": (
            _experiment(experiment).encode(),
            "application/x-ma-hs-experiments",
            "experiment/validation",
            "An experiment with known results",
        )
    }
    for name, role, text in (
        ("stimuli.csv", "testcase", "Inputs over time, linear between two rows, SI"),
        ("results.csv", "result", "Outputs that are to be met, SI"),
    ):
        related[name] = (experiment.tables[name.removesuffix(".csv")], "text/csv", role, text)
    if experiment.parameters:
        related["parameters.ssv"] = (
            _parameter_set(experiment).encode(),
            "application/x-ssp-parameter-set",
            "parameter",
            "Parameters of the experiment",
        )
    files = {str(FOLDER / name): content for name, (content, *_) in related.items()}
    files[str(FOLDER / "fmi-ls-manifest.xml")] = _manifest(related).encode()
    files["documentation/fmi-ls-ref.txt"] = _explanation(experiment).encode()
    return files


def _manifest(related: dict[str, tuple[bytes, str, str, str]]) -> str:
    root = Element(
        "fmiReferences",
        {
            f"{MANIFEST}name": FOLDER.name,
            f"{MANIFEST}version": "1.0.0-alpha.1",
            f"{MANIFEST}description": "Layered Standard providing information on related files "
            "included in an FMU.",
        },
    )
    for name, (content, kind, role, text) in related.items():
        SubElement(
            root,
            "Related",
            type=kind,
            source=name,
            role=role,
            description=text,
            checksum=hashlib.sha3_256(content).hexdigest(),
        )
    return document(root)


def _experiment(experiment: Reference) -> str:
    """One experiment for each interface: the same inputs and results, met to other tolerances."""
    root = Element("Experiments", name=f"{experiment.name} reference")
    for interface, tolerance in experiment.tolerances.items():
        element = SubElement(
            root,
            "Experiment",
            name=f"{experiment.name}, {interface}",
            description=experiment.method,
            tolerance=repr(tolerance),
        )
        settings = {"startTime": "0", "stopTime": "1", "stepSize": repr(STEP)}
        SubElement(element, "TransientSimulation", settings)
        if experiment.parameters:
            SubElement(element, "Parameters", source="parameters.ssv")
        SubElement(element, "Stimuli", source="stimuli.csv")
        SubElement(element, "References", source="results.csv")
    return document(root)


def _parameter_set(experiment: Reference) -> str:
    root = Element(f"{{{PARAMETER_SET}}}ParameterSet", version="1.0", name=experiment.name)
    parameters = SubElement(root, f"{{{PARAMETER_SET}}}Parameters")
    for name, value in experiment.parameters.items():
        parameter = SubElement(parameters, f"{{{PARAMETER_SET}}}Parameter", name=name)
        SubElement(parameter, f"{{{PARAMETER_SET}}}Real", value=repr(value))
    return document(root)


def _explanation(experiment: Reference) -> str:
    changed = ", ".join(f"{name} = {value:g}" for name, value in experiment.parameters.items())
    met = " and ".join(f"{t:g} in {interface}" for interface, t in experiment.tolerances.items())
    return f"""Reference results of the {experiment.name}
{"=" * (25 + len(experiment.name))}

In {FOLDER}:
  experiment.exp   what to run, for tools that know the format
  stimuli.csv      inputs over time [s], SI; an input without a column keeps its start value
  results.csv      outputs over time [s], SI

From 0 to 1 s in steps of {STEP:g} s{f", with {changed}" if changed else ""}. {experiment.method}

Each column is met when its largest difference from results.csv, over its largest value, is below
{met}. Model exchange: with the default experiment's tolerance.
"""
