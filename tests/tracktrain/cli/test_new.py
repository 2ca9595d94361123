"""`tracktrain new` and `tracktrain fmu pack`: from a name to a car with one's own model."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from support.archive_checks import findings
from support.templates import STARTS
from tracktrain.cli.main import main


def invoke(*arguments: object) -> str:
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 0, result.output
    return result.output


def refusal(*arguments: object) -> str:
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 2
    assert "Traceback" not in result.output
    return result.output


@pytest.mark.parametrize("block", STARTS)
def test_a_new_model_becomes_an_fmu_that_the_car_runs_with(tmp_path: Path, block: str) -> None:
    name, instance = STARTS[block]
    said = invoke("new", block, name, "--out", tmp_path)
    project = tmp_path / name
    assert {p.name for p in project.iterdir()} == {"README.md", f"{name}.py", f"test_{name}.py"}
    assert f"next: tracktrain fmu pack {project}" in said
    for path in project.iterdir():
        assert not any(word in path.read_text() for word in ("my_model", "MyModel", "BLOCK"))

    assert invoke("fmu", "pack", project, "--out", tmp_path).startswith(str(tmp_path / name))
    fmu = tmp_path / f"{name}.fmu"
    assert findings(fmu) == []
    verdict = " ".join(invoke("fmu", "check", fmu, "--as", block).split())
    assert f"{name}.fmu can stand in for the block {block}" in verdict
    out = tmp_path / "out"
    invoke("run", "--swap", f"{instance}={fmu}", "--duration", "0.2s", "--out", out, "--quiet")
    assert (out / "results.nc").exists()


def test_the_projects_own_tests_pass(tmp_path: Path) -> None:
    for block, (name, _) in STARTS.items():
        invoke("new", block, name, "--out", tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "."],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_a_folder_that_is_there_stays_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "my_creep").mkdir()
    message = refusal("new", "wheelrail", "my_creep", "--out", tmp_path)
    assert "my_creep' exists already; choose another name or another --out" in message
    assert list((tmp_path / "my_creep").iterdir()) == []


def test_an_unknown_block_is_answered_with_the_choices(tmp_path: Path) -> None:
    message = refusal("new", "wheel", "my_creep", "--out", tmp_path)
    assert "there is no block 'wheel'; did you mean wheelrail? choose one of: carbody" in message


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("my-creep", "is no name of a Python module"),
        ("2creep", "is no name of a Python module"),
        ("class", "is no name of a Python module"),
        ("MyCreep", "a model cannot be called 'MyCreep'"),
        ("test_creep", "a model cannot be called 'test_creep'"),
        ("numpy", "there is a Python module 'numpy' already"),
    ],
)
def test_a_name_that_python_cannot_use_is_refused(tmp_path: Path, name: str, reason: str) -> None:
    message = refusal("new", "wheelrail", name, "--out", tmp_path)
    assert reason in message
    assert "write a name such as my_creep" in message
    assert list(tmp_path.iterdir()) == []


def test_packing_what_is_not_there_says_what_to_name(tmp_path: Path) -> None:
    message = refusal("fmu", "pack", tmp_path / "nothing")
    assert "there is no model" in message
    assert "tracktrain new makes" in message
