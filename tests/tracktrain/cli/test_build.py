"""`tracktrain build`: which files it writes, and for which platforms."""

from __future__ import annotations

import importlib
import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner

from fmus.export import CompileError, compiler
from fmus.export.compiler import TARGETS, host_target
from fmus.names import CAR
from tracktrain.cli.main import main

builder = importlib.import_module("fmus.export.build")  # whose name the function `build` hides


def platforms(fmu: Path) -> set[str]:
    """Folders of an archive's binaries."""
    with zipfile.ZipFile(fmu) as archive:
        return {n.split("/")[1] for n in archive.namelist() if n.startswith("binaries/")}


def without_compiling(monkeypatch: pytest.MonkeyPatch) -> None:
    def write_name(sources: object, library: Path, target: compiler.Target, flags: object) -> None:
        library.write_text(target.name)

    monkeypatch.setattr(builder, "compile_library", write_name)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((), {host_target().folder("2.0")}),
        (("--target", "host"), {host_target().folder("2.0")}),
        (("--target", "windows-x86_64"), {"win64"}),
        (
            ("--target", "linux-x86_64", "--target", "linux-aarch64"),
            {"linux64", "aarch64-linux"},
        ),
        (
            ("--target", "all"),
            {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"},
        ),
    ],
)
def test_every_block_is_built_for_the_targets_that_are_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], expected: set[str]
) -> None:
    without_compiling(monkeypatch)
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path), *arguments])
    assert result.exit_code == 0, result.stderr
    for name in CAR:
        assert platforms(tmp_path / f"{name}.fmu") == expected
        assert f"{name}.fmu  " in result.stdout


def test_python_flavor_is_written_beside_the_native_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    without_compiling(monkeypatch)
    both = ("--flavor", "native", "--flavor", "python")
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path), *both])
    assert result.exit_code == 0, result.stderr
    assert {path.stem for path in tmp_path.iterdir()} == {
        f"{name}{suffix}" for name in CAR for suffix in ("", "_fmi3", "_python")
    }
    assert platforms(tmp_path / "truck_python.fmu") == {host_target().folder("2.0")}


@pytest.mark.parametrize(
    ("arguments", "suffixes"),
    [
        ((), {"", "_fmi3"}),
        (("--fmi", "2.0"), {""}),
        (("--fmi", "3.0"), {"_fmi3"}),
        (("--fmi", "3.0", "--fmi", "2.0"), {"", "_fmi3"}),
    ],
)
def test_every_block_is_built_for_the_versions_that_are_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], suffixes: set[str]
) -> None:
    without_compiling(monkeypatch)
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path), *arguments])
    assert result.exit_code == 0, result.stderr
    expected = {f"{name}{suffix}.fmu" for name in CAR for suffix in suffixes}
    assert {path.name for path in tmp_path.iterdir()} == expected
    assert all(f"{name}  " in result.stdout for name in expected)
    if "_fmi3" in suffixes:
        assert platforms(tmp_path / "truck_fmi3.fmu") == {host_target().folder("3.0")}


def test_a_version_that_does_not_exist_is_refused_with_the_choices(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path), "--fmi", "1.0"])
    assert result.exit_code == 2
    assert "'1.0' is not one of '2.0', '3.0'" in result.stderr


def test_unknown_target_is_refused_with_the_choices(tmp_path: Path) -> None:
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path), "--target", "linux"])
    assert result.exit_code == 2
    assert result.stderr == (
        f"Error: there is no target 'linux'; choose from host, all, {', '.join(TARGETS)}\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_help_names_every_target() -> None:
    text = " ".join(CliRunner().invoke(main, ["build", "--help"]).stdout.split())
    assert all(name in text for name in ("host", "all", *TARGETS))


def test_failed_compilation_is_a_message_without_a_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise CompileError("compiling for macos-arm64 failed: zig cc\nerror: no such thing")

    monkeypatch.setattr(builder, "compile_library", fails)
    result = CliRunner().invoke(main, ["build", "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert result.stderr.endswith("zig cc\nerror: no such thing\n")
    assert list(tmp_path.iterdir()) == []
