"""Self-tests in another process: remembered by hash, and an FMU that crashes takes nothing down."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from fmus.catalogue import fmu_path
from orchestrator import Component, System, simulate
from orchestrator.trust import tested
from orchestrator.trust.self_test import CHECKS
from orchestrator.trust.tested import self_tests
from support.manners import manners
from support.mishap import KINDS, mishap
from support.native_slaves import DAMPER, archive, build_damper, description, library
from tracktrain.cli.main import main

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the tests' own FMUs need a compiler")


HIDDEN = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

class Hidden(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = 0.0
        self.memory = [0.0]
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, time, step):
        self.memory[0] += step
        self.y = self.memory[0]
        return True
"""


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    """A cache of the test's own."""
    monkeypatch.setattr(tested, "user_cache_path", lambda name: tmp_path / "cache" / name)
    return tmp_path / "cache" / "tracktrain" / "self_tests"


def command(*arguments: str) -> Result:
    result = CliRunner().invoke(main, ["fmu", "test", *arguments])
    assert "Traceback" not in result.output
    return result


def flat(result: Result) -> str:
    return " ".join(result.output.split())


def test_a_crash_is_a_finding_and_the_other_fmus_are_tested(tmp_path):
    crash = {"at": 0.0005, "kind": float(KINDS.index("crash"))}
    found = self_tests(
        {"odd": Component(mishap(tmp_path), crash), "even": Component(build_damper(tmp_path))}
    )
    assert [f.check for f in found["odd"].errors] == ["process"]
    assert found["odd"].errors[0].text == "its self-test crashed (SIGSEGV: segmentation fault)"
    assert "dependencies" in found["even"].passed


@pytest.mark.parametrize(
    ("manner", "said"),
    [
        ("NO_INSTANCE", "no_instance.fmu failed its self-test"),
        ("LEAVE", "leave.fmu failed its self-test"),
        ("STATUS", "status.fmu did not pass its self-test: not tested were surroundings,"),
    ],
)
def test_what_could_not_be_tested_has_not_passed(tmp_path, manner, said):
    file = str(manners(tmp_path, manner).file)
    result = command(file, "--set", "at=0.0", "--set", "answer=3.0")
    assert result.exit_code == 1
    assert said in flat(result)


def test_an_fmu_that_crashed_runs_in_a_process_of_its_own(tmp_path):
    """Where it may crash again, and the run keeps what it has."""
    crash = {"at": 0.0005, "kind": float(KINDS.index("crash"))}
    system = System({"odd": Component(mishap(tmp_path), crash)})
    run = simulate(system, duration=0.1, step=1e-4, self_test=True)
    assert "its process crashed in fmi2DoStep" in run.message
    assert run.time.size == 6
    assert "self-test of odd: mishap.fmu: its self-test crashed" in "\n".join(run.notes)
    assert run.verdict.level.value == "bad"


def test_a_stock_pythonfmu_that_forgets_its_hidden_state_is_found_out(tmp_path):
    (tmp_path / "hidden.py").write_text(HIDDEN)
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", "hidden.py", "--handle-state"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    found = self_tests({"hidden": Component(tmp_path / "Hidden.fmu")})["hidden"]
    assert [f.check for f in found.errors] == ["rollback"]
    said = found.errors[0].text
    assert said.startswith("a saved state does not hold everything: y is 0.004")
    assert "one step after it, and 0.007" in said


def test_a_result_is_remembered_by_the_hash_of_the_file(tmp_path, cache, monkeypatch):
    components = {"damper": Component(build_damper(tmp_path))}
    first = self_tests(components)
    (file,) = cache.iterdir()
    assert json.loads(file.read_text())["label"] == "damper.fmu"
    asked = []

    def elsewhere(components):
        asked.extend(components)
        return [first["damper"]] * len(components)

    monkeypatch.setattr(tested, "_elsewhere", elsewhere)
    assert self_tests(components) == first and not asked
    file.write_text("torn")
    assert self_tests(components) == first and len(asked) == 1
    self_tests(components, anew=True)
    assert len(asked) == 2


def test_a_copy_of_a_tested_file_is_told_by_its_own_name(tmp_path):
    first = build_damper(tmp_path)
    copies = [shutil.copy(first, tmp_path / name) for name in ("mine.fmu", "yours.fmu")]
    assert self_tests({"a": Component(first)})["a"].label == "damper.fmu"
    found = self_tests({str(i): Component(Path(copy)) for i, copy in enumerate(copies)})
    assert [test.label for test in found.values()] == ["mine.fmu", "yours.fmu"]


def test_a_wrong_value_in_one_run_is_no_finding_of_the_next():
    truck = fmu_path("truck")
    (wrong,) = self_tests({"truck": Component(truck, {"wheelset_mass": -5.0})}).values()
    assert any("wheelset_mass cannot be -5" in finding.text for finding in wrong.findings)
    (right,) = self_tests({"truck": Component(truck)}).values()
    assert right.passed == CHECKS and not any(finding.wrong for finding in right.findings)
    (still,) = self_tests({"truck": Component(truck, {"wheelset_mass": -5.0})}).values()
    assert still == right


def test_a_failed_test_is_made_again_after_a_mend_of_the_package(tmp_path, monkeypatch):
    given = {"at": 0.0005, "kind": float(KINDS.index("crash"))}
    crash = {"odd": Component(mishap(tmp_path), given)}
    found, asked = self_tests(crash), []

    def elsewhere(components):
        asked.extend(components)
        return [found["odd"]] * len(components)

    monkeypatch.setattr(tested, "_elsewhere", elsewhere)
    assert self_tests(crash) == found and not asked
    monkeypatch.setattr(tested, "_package", lambda: "mended")
    assert self_tests(crash) == found and len(asked) == 1


def test_the_command_passes_ours():
    result = command(str(fmu_path("wheelrail")))
    assert result.exit_code == 0, result.output
    said = flat(result)
    assert said.endswith("wheelrail.fmu passed its self-test")
    assert all(f"{check} passed" in said for check in CHECKS)


def test_the_command_finds_a_liar_and_names_variables_and_numbers(tmp_path):
    lies = DAMPER.replace(
        '<Unknown index="2" dependencies="1"/>', '<Unknown index="2" dependencies=""/>'
    )
    path = archive(tmp_path / "liar.fmu", description(lies), library(tmp_path))
    result = command(str(path), "--set", "c=5")
    assert result.exit_code == 1
    said = flat(result)
    assert "force goes from 0.005 to 0.004995 at once when v goes from -0.001 to -0.000999" in said
    assert "which its model description does not say (dependencies)" in said
    assert "rollback not offered" in said
    assert said.endswith("liar.fmu failed its self-test")


def test_the_command_says_what_cannot_be_read():
    result = command(str(fmu_path("wheelrail")), "--set", "conicity")
    assert result.exit_code == 2
    assert "--set 'conicity' is no assignment; write it as VARIABLE=VALUE" in result.output
    result = command("absent.fmu")
    assert result.exit_code == 2
    assert "absent.fmu" in result.output
