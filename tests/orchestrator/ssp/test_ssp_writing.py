"""What is written: valid by the published schemas, the same when read back, the same each time."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from orchestrator import (
    Component,
    Connection,
    Experiment,
    Linear,
    OrchestratorError,
    PowerBond,
    System,
    simulate,
)
from orchestrator.ssp import read_ssp, write_ssp
from support.coupled_models import oscillator
from support.native_slaves import build_damper, build_mass
from support.ssp_archives import problems


@pytest.fixture(scope="module")
def system(tmp_path_factory) -> System:
    """Everything that a system can say of two FMUs."""
    folder = tmp_path_factory.mktemp("fmus")
    return System(
        components={
            "damper one": Component(
                build_damper(folder), {"c": "200 lbf.s/in", "kind": "plain", "locked": False}
            ),
            "mass": Component(build_mass(folder), {"m": 3.0, "start_v": 1, "force_per_v": 0.25}),
            "slow": Component(build_damper(folder), every=3),
        },
        connections=(
            Connection("damper one.force", "mass.force", Linear(0.1, -2.0)),
            Connection("mass.v", "damper one.v", suppress_unit_conversion=True),
        ),
        bonds=(PowerBond("damper one.force", "mass.v"),),
        experiment=Experiment(1.0, 2.5, 0.01),
    )


def without_places(system: System) -> System:
    """With the FMUs' names in the place of their paths."""
    components = {
        name: replace(component, fmu=Path(component.fmu).name)
        for name, component in system.components.items()
    }
    return replace(system, components=components)


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_reading_gives_back_what_was_written(system, tmp_path, version):
    read = read_ssp(write_ssp(system, tmp_path / "pair.ssp", version=version))
    assert without_places(read) == without_places(system)
    assert read.notes == ()
    one, other = simulate(system), simulate(read)
    assert one.dataset.equals(other.dataset)
    assert [bond.name for bond in one.bonds] == [bond.name for bond in other.bonds]


def test_system_that_says_little_stays_so(system, tmp_path):
    little = System({"mass": Component(system.components["mass"].fmu, every=2)})
    assert without_places(read_ssp(write_ssp(little, tmp_path / "m.ssp"))) == without_places(little)


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_files_are_valid_by_the_published_schemas(system, tmp_path, version):
    path = write_ssp(system, tmp_path / "pair.ssp", version=version)
    kinds = {".ssd": "Description", ".ssv": "ParameterValues"}
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    checked = {
        name: problems(content, kinds[suffix], version)
        for name, content in files.items()
        if (suffix := Path(name).suffix) in kinds
    }
    assert checked == {
        "SystemStructure.ssd": [],
        "resources/damper one.ssv": [],
        "resources/mass.ssv": [],
    }


def test_the_same_system_gives_the_same_bytes(system, tmp_path):
    first = write_ssp(system, tmp_path / "pair.ssp").read_bytes()
    assert write_ssp(system, tmp_path / "other.ssp", name="pair").read_bytes() == first


def test_two_fmus_of_the_same_name_both_go_along(system, tmp_path):
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / "mass.fmu"
    other.write_bytes(Path(system.components["damper one"].fmu).read_bytes())
    both = System({"a": system.components["mass"], "b": Component(other)})
    read = read_ssp(write_ssp(both, tmp_path / "both.ssp"))
    for name, component in both.components.items():
        assert Path(read.components[name].fmu).read_bytes() == Path(component.fmu).read_bytes()


def test_values_that_the_fmus_have_anyway_can_be_left_out(system, tmp_path):
    changed = system.with_value("damper one.locked", True).with_value("mass.m", 1.0)
    read = read_ssp(write_ssp(changed, tmp_path / "pair.ssp", changes_only=True))
    assert {name: dict(c.parameters) for name, c in read.components.items()} == {
        "damper one": {"c": "200 lbf.s/in", "locked": True},
        "mass": {"start_v": 1.0, "force_per_v": 0.25},
        "slow": {},
    }


def test_what_cannot_be_written_is_refused(system, tmp_path):
    for wrong, options, message in (
        (oscillator(), {}, "one is a mock, which cannot be written; give it an FMU"),
        (system, {"version": "3.0"}, "SSP has no version '3.0'; "),
        (system.with_value("mass.m", "3 N"), {}, "mass.m cannot be '3 N': N cannot be converted"),
    ):
        with pytest.raises(OrchestratorError) as caught:
            write_ssp(wrong, tmp_path / "wrong.ssp", **options)
        assert message in str(caught.value)
    (tmp_path / "file").touch()
    with pytest.raises(OrchestratorError, match=r"pair\.ssp' cannot be written: "):
        write_ssp(system, tmp_path / "file" / "pair.ssp")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
