"""Compiled code is found by what it was made of; where there is none, there is plain Python."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

from orchestrator import simulate
from orchestrator.compiled import compiler, library
from orchestrator.compiled.library import ENTRIES, PACKAGE, PRODUCT, STAMP
from support.coupled_models import oscillator


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The product's library in a folder of its own."""
    folder = tmp_path_factory.mktemp("built")
    library.build_into(folder)
    return folder


@pytest.fixture
def nothing_found(monkeypatch):
    """As in a process that has not looked for the library yet."""
    library.product.cache_clear()
    kept = {name: dict(entry.__dict__) for name, entry in ENTRIES.items()}
    for entry in ENTRIES.values():
        entry.__dict__.pop("library", None)
    yield
    library.product.cache_clear()
    for name, entry in ENTRIES.items():
        entry.__dict__.clear()
        entry.__dict__.update(kept.get(name, {}))


def test_every_source_of_a_number_counts(built):
    """Those that constants come from, too."""
    name, *sources = (built / STAMP).read_text().split()
    assert {
        "masters/loop/explicit.py", "masters/loop/unknowns.py", "slaves/abi.py", "slaves/status.py",
        "slaves/adapted/records.py", "slaves/isolated/protocol.py", "compiled/translate.py",
    } <= {*sources}  # fmt: skip
    assert (built / name).exists()


def test_another_source_is_another_library(monkeypatch, built):
    name, *sources = (built / STAMP).read_text().split()
    assert library._name(sources, compiler.host()) == name
    read = library.Path.read_bytes
    changed = PACKAGE / "slaves/adapted/records.py"
    monkeypatch.setattr(
        library.Path, "read_bytes", lambda path: read(path) + b"#" * (path == changed)
    )
    assert library._name(sources, compiler.host()) != name


def test_a_damaged_library_is_built_again(built, monkeypatch, nothing_found, tmp_path, capfd):
    shutil.copytree(built, tmp_path / "built")
    (damaged,) = (tmp_path / "built").glob(f"loops-*{compiler.host().suffix}")
    damaged.write_bytes(damaged.read_bytes()[:2000])
    monkeypatch.setattr(library, "BUILT", tmp_path / "built")
    assert library.product() is not None
    assert "compiling the macro loops, once" in capfd.readouterr().err


def test_without_compiler_the_run_is_in_plain_python_and_says_so(
    monkeypatch, nothing_found, tmp_path, capfd
):
    compiled = simulate(oscillator(), duration=1.0, step=0.1)
    library.product.cache_clear()
    for entry in ENTRIES.values():
        entry.__dict__.pop("library", None)

    def none(target):
        raise compiler.CompileError("there is no C compiler: install one")

    monkeypatch.setattr(compiler, "_compiler", none)
    monkeypatch.setattr(library, "BUILT", tmp_path / "none")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    plain = simulate(oscillator(), duration=1.0, step=0.1)
    said = capfd.readouterr().err
    assert "in plain Python" in said and "install one" in said
    for name in compiled.dataset:
        assert plain.dataset[name].values.tobytes() == compiled.dataset[name].values.tobytes()


def test_all_loops_of_the_product_are_in_its_library(built):
    """A new master's module is to be named in PRODUCT."""
    missing = [
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if any(
            f"\n{mark}" in path.read_text()
            for mark in ("@macro_loop", "@c_function", "@adaptors", "FORMATTED = Written(")
        )
        and ".".join([PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts])
        not in PRODUCT
    ]
    assert missing == []


def test_a_run_imports_no_compiler():
    code = (
        "import sys, numpy\n"
        "from orchestrator.masters.loop import explicit, held, repeated\n"
        "from orchestrator.slaves.adapted import adaptors\n"
        "assert held.advance.bound\n"
        "print([n for n in ('numba', 'llvmlite', 'ziglang', 'casadi') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
@pytest.mark.parametrize("target", compiler.PLATFORMS.values(), ids=lambda target: target.zig)
def test_the_loops_compile_for_every_platform(target, tmp_path):
    path = library.build_into(tmp_path, target)
    magic = {".so": b"\x7fELF", ".dll": b"MZ", ".dylib": b"\xcf\xfa\xed\xfe"}
    assert path.read_bytes().startswith(magic[target.suffix])
