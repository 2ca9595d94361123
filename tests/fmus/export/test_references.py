"""Reference results in the FMUs: met by the FMU, kept as they were computed, described truly."""

from __future__ import annotations

import csv
import hashlib
import zipfile
from collections.abc import Iterable
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import simulate_fmu

from fmus.catalogue import fmu_path
from fmus.describe.experiment import read
from fmus.export.xml.references import FOLDER, MANIFEST
from fmus.reference import EXPERIMENTS


def members(block: str, fmi: str = "2.0") -> dict[str, bytes]:
    with zipfile.ZipFile(fmu_path(block, fmi)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def columns(text: bytes) -> dict[str, np.ndarray]:
    names, *rows = csv.reader(text.decode().splitlines())
    return dict(zip(names, np.array(rows, float).T, strict=True))


def variables(description: bytes, names: Iterable[str]) -> dict[str, tuple]:
    """The variable of each name, or the array that it is an element of and its place there."""
    there = {e.get("name") for e in ElementTree.fromstring(description).iter() if e.get("name")}
    found: dict[str, tuple] = {}
    for name in names:
        array, _, index = name.removesuffix("]").rpartition("[")
        found[name] = (name,) if name in {*there, "time"} else (array, int(index) - 1)
    return found


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_the_fmu_meets_what_its_own_archive_asks_for(block_name, fmi, interface):
    """From the archive alone, as a tool finds it."""
    files = members(block_name, fmi)
    experiments = ElementTree.fromstring(files[str(FOLDER / "experiment.exp")])
    experiment = experiments[["CoSimulation", "ModelExchange"].index(interface)]
    times = experiment.find("TransientSimulation").attrib
    source = {e.tag: files[str(FOLDER / e.get("source"))] for e in experiment if e.get("source")}
    parameters = {}
    if "Parameters" in source:
        for parameter in ElementTree.fromstring(source["Parameters"]).iterfind(".//{*}Parameter"):
            parameters[parameter.get("name")] = float(parameter[0].get("value"))
    stimuli, expected = columns(source["Stimuli"]), columns(source["References"])
    place = variables(files["modelDescription.xml"], expected)
    found = simulate_fmu(
        str(fmu_path(block_name, fmi)),
        stop_time=float(times["stopTime"]),
        step_size=float(times["stepSize"]),
        output_interval=float(times["stepSize"]),
        start_values=parameters,
        input=np.array(list(zip(*stimuli.values(), strict=True)), [(n, float) for n in stimuli]),
        output=sorted({place[name][0] for name in expected if name != "time"}),
        fmi_type=interface,
    )
    rows = [np.abs(found["time"] - time).argmin() for time in expected["time"]]
    tolerance = float(experiment.get("tolerance"))
    for name, values in expected.items():
        variable, *element = place[name]
        met = np.array(found[variable])[(rows, *element)]
        assert np.abs(met - values).max() <= tolerance * np.abs(values).max(), name


def test_every_output_has_a_reference_and_most_of_them_move(block_name):
    results = read(EXPERIMENTS[block_name].folder / "results.csv")
    with zipfile.ZipFile(fmu_path(block_name)) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    outputs = {v.get("name") for v in root.iter("ScalarVariable") if v.get("causality") == "output"}
    assert outputs == results.keys() - {"time"}
    # the report's rails do not rise
    shown = [values for name, values in results.items() if "rail_az" not in name]
    assert sum(np.ptp(values) > 0 for values in shown) > 0.5 * len(shown)


@pytest.mark.parametrize(
    "block",
    [pytest.param(n, marks=[pytest.mark.slow] if "truck" in n else []) for n in EXPERIMENTS],
)
def test_the_tables_are_what_is_computed(block):
    for name, table in EXPERIMENTS[block].tables().items():
        kept = read(EXPERIMENTS[block].folder / f"{name}.csv")
        assert kept.keys() == table.keys()
        for column, values in table.items():
            scale = max(np.abs(values).max(), 1e-300)
            assert np.abs(kept[column] - values).max() < 1e-9 * scale, column


def test_the_manifest_names_every_file_with_its_checksum(block_name):
    files = members(block_name)
    here = {name for name in files if name.startswith(f"{FOLDER}/")}
    root = ElementTree.fromstring(files[str(FOLDER / "fmi-ls-manifest.xml")])
    assert root.get(f"{MANIFEST}name") == FOLDER.name
    related = {str(FOLDER / e.get("source", "")): e for e in root.iterfind("Related")}
    assert related.keys() == here - {str(FOLDER / "fmi-ls-manifest.xml")}
    for name, element in related.items():
        assert hashlib.sha3_256(files[name]).hexdigest() == element.get("checksum")
        assert len(files[name]) < 100_000
    assert "documentation/fmi-ls-ref.txt" in files
