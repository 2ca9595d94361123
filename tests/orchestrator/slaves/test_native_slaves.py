"""FMI 2.0 FMUs with native code: coupled, and refused where they cannot be."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tolerances
from orchestrator import Component, Connection, OrchestratorError, System, describe, simulate
from support.native_slaves import (
    DAMPER,
    MASS,
    TANGENT,
    archive,
    build_damper,
    build_mass,
    description,
    library,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("slaves")


@pytest.fixture(scope="module")
def system(folder) -> System:
    components = {
        "damper": Component(build_damper(folder), {"c": 1e3}),
        "mass": Component(build_mass(folder), {"start_v": "1 m/s"}),
    }
    connections = (Connection("damper.force", "mass.force"), Connection("mass.v", "damper.v"))
    return System(components, connections)


def refusal(system: System) -> str:
    with pytest.raises(OrchestratorError) as caught:
        simulate(system, duration=0.1, step=0.01)
    return str(caught.value)


def test_tangent_across_two_fmus_keeps_a_stiff_damper_stable(system):
    """c H / m = 100 in steps, 2 in the mass's micro steps of the midpoint rule."""
    run = simulate(system, duration=1, step=0.1)
    micro = 1e3 * 0.1 / 50
    per_step = ((1 - 0.5 * micro) / (1 + 0.5 * micro)) ** 50
    np.testing.assert_allclose(
        run.dataset["mass.v"], per_step ** np.arange(11), atol=tolerances.ROUNDING
    )
    assert run.bonds[0].relative < 1.0
    assert "1 of 2 inputs follow a tangent of their source" in run.notes
    assert run.dataset["mass.v"].attrs == {"units": "m/s", "description": "velocity"}


@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
def test_compiled_loop_and_python_give_the_same_bits(system, master):
    mild = system.with_value("damper.c", 3.0)
    runs = [
        simulate(mild, duration=0.5, step=0.01, master=master, compiled=compiled)
        for compiled in (True, False)
    ]
    assert runs[0].record.tobytes() == runs[1].record.tobytes()
    np.testing.assert_allclose(runs[0].dataset["mass.v"], np.exp(-3 * runs[0].time), atol=2e-2)


def test_values_of_every_type_arrive(system):
    changed = (
        system.with_value("damper.c", "2 N.s/mm")
        .with_value("damper.kind", "plain")
        .with_value("damper.locked", "true")
        .with_value("mass.m", "3 wagonload")
    )
    run = simulate(changed, duration=0.001, step=0.001, master="jacobi")
    assert run.dataset["damper.force"][0] == pytest.approx(-2e3 * 1e3)
    assert json.loads(run.dataset.attrs["parameters"])["mass.m"] == 240e3


def test_value_that_the_fmu_refuses_is_named_with_its_reason(system):
    assert refusal(system.with_value("mass.m", -5)) == (
        "mass (mass.fmu) refused m = -5.0 kg: mass m = -5 kg is not positive"
    )
    assert refusal(system.with_value("damper.kind", "fancy")) == (
        "damper (damper.fmu) cannot be initialized: a damper of kind 2 is not made yet"
    )
    assert refusal(system.with_value("mass.start_v", "500 km/h")) == (
        "mass.start_v cannot be 138.889 m/s: it must be at most 100 m/s"
    )


def test_error_in_a_step_is_reported_with_what_the_fmu_logged(system):
    logged = []
    run = simulate(
        system.with_value("mass.time_of_failure", 0.055),
        duration=1,
        step=0.01,
        logger=lambda *said: logged.append(said),
    )
    assert run.message == (
        "mass: fmi2DoStep returned error in the step from t = 0.05 s: out of rails after 0.05 s"
    )
    assert run.dataset.sizes["time"] == 6
    assert logged == [("mass", "error", "out of rails after 0.05 s")]


def test_description_knows_tangents_units_and_dependencies(system):
    found = describe(system.components["mass"].fmu)
    assert [(t.input, t.output, t.partial) for t in found.tangents] == [
        ("force", "v", "force_per_v")
    ]
    assert found.variables["v"].derivative_of == "x"
    assert found.rate_of("x").name == "v"
    damper = describe(system.components["damper"].fmu)
    assert damper.variables["force"].dependencies == {"v"}
    assert damper.variables["kind"].items == {"plain": 1, "fancy": 2}
    assert len(damper.sha256) == 64


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("empty.fmu", None, "is no FMU: it has no modelDescription.xml"),
        ("torn.fmu", "<fmiModelDescription", "has a modelDescription.xml that cannot be read: "),
        (
            "old.fmu",
            '<fmiModelDescription fmiVersion="1.0"/>',
            "is an FMU of FMI 1.0; FMI 2.0 and 3.0 can be coupled",
        ),
        (
            "exchange.fmu",
            '<fmiModelDescription fmiVersion="2.0"><ModelExchange/></fmiModelDescription>',
            "offers model exchange only; an FMU for co-simulation is needed",
        ),
        (
            "odd.fmu",
            description(MASS.replace('causality="output"', 'causality="outlet"')),
            "has a wrong modelDescription.xml: ",
        ),
        (
            "tangent.fmu",
            description(MASS, extra=TANGENT.replace('output="v"', 'output="w"')),
            "declares a tangent with the output 'w', which is no output of it; choose one of: x, v",
        ),
        ("bare.fmu", description(DAMPER), "has no binary for this platform ("),
    ],
)
def test_file_that_is_no_fmu_for_this(tmp_path, name, text, message):
    path = archive(tmp_path / name, text, None)
    said = refusal(System({"a": Component(path)}))
    assert said.startswith(f"'{path}' {message}")


def test_fmu_for_another_platform_says_what_it_has(folder, tmp_path):
    path = archive(tmp_path / "a.fmu", description(DAMPER), library(folder), "amiga32")
    assert refusal(System({"a": Component(path)})).endswith("; it has: amiga32")


def test_file_that_is_not_there_a_folder_or_no_archive(tmp_path):
    missing = tmp_path / "missing.fmu"
    assert refusal(System({"a": Component(missing)})) == (
        f"the FMU '{missing}' cannot be read: no such file or directory"
    )
    assert refusal(System({"a": Component(tmp_path)})) == f"'{tmp_path}' is no FMU: it is a folder"
    text = tmp_path / "text.fmu"
    text.write_text("an FMU")
    said = refusal(System({"a": Component(text)}))
    assert said == f"'{text}' is no FMU: it is not a zip archive"


def test_fmu_whose_binary_does_not_belong_to_it(folder, tmp_path):
    other = archive(tmp_path / "a.fmu", description(DAMPER, guid="other"), library(folder))
    assert refusal(System({"a": Component(other)})) == (
        "a: a.fmu cannot be instantiated: unknown GUID other"
    )
    broken = tmp_path / library(folder).name
    broken.write_text("no library")
    path = archive(tmp_path / "b.fmu", description(DAMPER), broken)
    assert refusal(System({"b": Component(path)})).startswith("b: b.fmu cannot be loaded: ")


def test_fmu_that_can_be_instantiated_only_once(folder, tmp_path):
    text = description(DAMPER).replace(
        "canInterpolateInputs", 'canBeInstantiatedOnlyOncePerProcess="true" canInterpolateInputs'
    )
    path = archive(tmp_path / "single.fmu", text, library(folder))
    simulate(System({"a": Component(path)}), duration=0.1, step=0.1)
    assert refusal(System({"a": Component(path), "b": Component(path)})) == (
        "a and b are instances of single.fmu, which says that it can be instantiated only once in "
        "a process; isolate all but one, which gives them processes of their own"
    )


def test_archive_that_reaches_outside_of_its_folder(folder, tmp_path):
    import zipfile

    path = archive(tmp_path / "a.fmu", description(DAMPER), library(folder))
    with zipfile.ZipFile(path, "a") as fmu:
        fmu.writestr("resources/../../evil.txt", "")
    said = refusal(System({"a": Component(path)}))
    assert said == f"'{path}' holds 'resources/../../evil.txt', which lies outside of the archive"
