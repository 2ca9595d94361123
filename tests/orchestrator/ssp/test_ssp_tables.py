"""A table that drives an input travels in the archive, as OMSimulator has it."""

from __future__ import annotations

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from fmus.catalogue import fmu_path
from orchestrator import (
    Component,
    OrchestratorError,
    Profile,
    System,
    read_ssp,
    simulate,
    write_ssp,
)

PROFILE = Profile("speed", "ft/s", (0.0, 1.0, 2.0), (60.0, 60.0, 20.0))


@pytest.fixture
def archive(tmp_path):
    system = System({"track": Component(fmu_path("track"), {"spectrum": "fra5"})})
    return write_ssp(system.driven("track.speed", PROFILE), tmp_path / "driven.ssp")


def test_a_driven_system_is_read_back_as_it_was(archive):
    system = read_ssp(archive)
    table = system.components["track_speed"].fmu
    assert isinstance(table, Profile)
    assert (table.unit, table.times, table.values) == ("ft/s", PROFILE.times, PROFILE.values)
    original = System({"track": Component(fmu_path("track"), {"spectrum": "fra5"})})
    runs = [
        simulate(s, duration=2.0, step=0.01)
        for s in (system, original.driven("track.speed", PROFILE))
    ]
    name = "track.axle[1].rail_y_left"
    assert np.array_equal(runs[0].dataset[name], runs[1].dataset[name])


def test_the_table_is_a_component_with_plain_columns(archive):
    with zipfile.ZipFile(archive) as file:
        lines = file.read("resources/track_speed.csv").decode().splitlines()
        root = ElementTree.fromstring(file.read("SystemStructure.ssd"))
    assert lines == ["time,speed", "0.0,60.0", "1.0,60.0", "2.0,20.0"]
    (component,) = (e for e in root.iter() if e.get("name") == "track_speed")
    assert component.get("type") == "application/table"
    assert component.get("source") == "resources/track_speed.csv"


def test_a_damaged_table_is_named(archive, tmp_path):
    broken = tmp_path / "broken.ssp"
    with zipfile.ZipFile(archive) as old, zipfile.ZipFile(broken, "w") as new:
        for member in old.namelist():
            content = old.read(member)
            new.writestr(member, content.replace(b"1.0,60.0", b"3.0,60.0"))
    with pytest.raises(OrchestratorError, match=r"track_speed\.csv.*must increase"):
        read_ssp(broken)
