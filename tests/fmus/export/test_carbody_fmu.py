"""The FMU of a carbody of modal data: packaged as the blocks are, and true to itself."""

from __future__ import annotations

import csv
import zipfile
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

from fmus.carbody.modal_data import ModalData, Point
from fmus.carbody.modal_files import read_modal_data
from fmus.export.carbody import build_carbody, carbody_fmu
from fmus.export.python import build_python_carbody
from fmus.export.xml.references import FOLDER
from orchestrator import Component
from orchestrator.trust.self_test import self_test
from support.modal import random_data

POINTS = (Point("floor", 0.2, 0.4, -1.0), Point("hook", 6.5, 0.0, -1.3))


@pytest.fixture(scope="module")
def data() -> ModalData:
    return random_data(np.random.default_rng(7), count=5, points=POINTS)


@pytest.fixture(scope="module")
def fmus(data, tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("carbody")
    return {fmi: build_carbody(data, folder / f"c {fmi}.fmu", fmi) for fmi in ("2.0", "3.0")}


@pytest.fixture(params=["2.0", "3.0"])
def fmu(request, fmus) -> Path:
    return fmus[request.param]


def files(path: Path) -> Mapping[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_archive_is_valid_and_holds_what_the_blocks_hold(fmu):
    assert validate_fmu(str(fmu)) == []
    held = files(fmu)
    for place in (
        "documentation/index.html",
        "documentation/diagram.svg",
        "terminalsAndIcons/icon.png",
        "sources/buildDescription.xml",
        str(FOLDER / "fmi-ls-manifest.xml"),
    ):
        assert place in held
    terminals = ElementTree.fromstring(held["terminalsAndIcons/terminalsAndIcons.xml"])
    assert [t.get("name") for t in terminals.iter("Terminal")] == ["front", "rear", "frame"]
    page = held["documentation/index.html"].decode()
    assert "mode[5].frequency" in page and "a test" in page  # the parameters' source


def test_it_does_what_it_says_of_itself(fmu):
    assert self_test(Component(fmu)).errors == []


def test_it_meets_its_own_reference_results(fmu):
    held = files(fmu)
    names, *rows = csv.reader(held[str(FOLDER / "stimuli.csv")].decode().splitlines())
    loads = dict(zip(names[1:], map(float, rows[0][1:]), strict=True))
    names, *rows = csv.reader(held[str(FOLDER / "results.csv")].decode().splitlines())
    expected = dict(zip(names, np.array(rows, float).T, strict=True))
    watched = [n for n in expected if n.split(".")[0] in ("front", "rear", "floor", "hook", "cg")]
    found = simulate_fmu(
        str(fmu), stop_time=1.0, step_size=0.02, output_interval=0.02, start_values=loads,
        output=watched, fmi_type="CoSimulation",
    )  # fmt: skip
    for name in watched:
        largest = np.abs(expected[name]).max()
        assert np.abs(found[name] - expected[name]).max() <= 1e-8 * largest, name


def test_its_numbers_can_be_changed_where_it_runs(fmus):
    """Twice the shape at the plate, four times its elastic acceleration."""
    shape = {f"front.elastic_shape[2,{i}]": 2.0 for i in range(1, 6)}
    start = {"front.force_z": 1.0, **dict.fromkeys(shape, 0.0)}
    az = [
        simulate_fmu(
            str(fmus["2.0"]), stop_time=1e-3, step_size=1e-3, output=["front.az"],
            start_values=start | {n: k * v / 1e3 for n, v in shape.items()},
        )["front.az"][0]
        for k in (0, 1, 2)
    ]  # fmt: skip
    assert az[2] - az[0] == pytest.approx(4 * (az[1] - az[0]), rel=1e-9)


def test_arrays_of_fmi_3_have_modes_and_points_as_their_sizes(fmus):
    variables = {v.name: v for v in read_model_description(str(fmus["3.0"])).modelVariables}
    assert variables["floor.elastic_shape"].shape == (6, 5)
    assert variables["front.mode_shape"].shape == (4, 10)
    assert variables["q"].shape == (10,)


def test_its_python_flavour_computes_the_same_from_the_data_that_it_holds(fmus, data, tmp_path):
    readable = build_python_carbody(data, tmp_path / "readable.fmu")
    runs = [
        simulate_fmu(
            str(path), stop_time=0.02, step_size=1e-3, output_interval=1e-3,
            start_values={"front.force_z": 1e4, "rear.force_y": -5e3},
            output=["front.z", "hook.ay", "q[8]"], fmi_type="CoSimulation",
        )
        for path in (fmus["2.0"], readable)
    ]  # fmt: skip
    for name in ("front.z", "hook.ay", "q[8]"):
        largest = np.abs(runs[0][name]).max()
        assert np.abs(runs[1][name] - runs[0][name]).max() <= 1e-12 * largest > 0


def test_the_data_travel_with_it(fmu, data):
    again = read_modal_data(fmu)
    np.testing.assert_array_equal(again.shapes, data.shapes)
    assert again.modes == data.modes and again.outputs == ("floor", "hook")


def test_the_same_data_are_built_once(data, tmp_path, monkeypatch):
    folders = SimpleNamespace(user_cache_path=lambda _: tmp_path)
    monkeypatch.setattr("fmus.export.single.platformdirs", folders)
    first = carbody_fmu(data)
    at = first.stat().st_mtime_ns
    assert carbody_fmu(data) == first and first.stat().st_mtime_ns == at
    assert first.is_relative_to(tmp_path)
