"""FMUs with the binaries of all platforms, built on one: what each binary has and needs."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import lief
import numpy as np
import pytest
from fmpy import supported_platforms
from fmpy.validation import validate_fmu

from fmus.export import CompileError, build, compiler
from fmus.export.compiler import TARGETS, compile_library, compiler_command, host_target, targets
from fmus.names import NAMES
from support.binaries import libraries
from support.fmi3_instance import INSTANCE
from support.functions import FUNCTIONS

lief.logging.disable()
QUICK = tuple(name for name in TARGETS if not name.startswith("windows"))
"""Cold, these take seconds; zig's first build for Windows takes a minute."""


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(("carbody", "3.0", QUICK), id="carbody-3.0"),
        *(
            pytest.param(
                (block, fmi, tuple(TARGETS)), marks=pytest.mark.slow, id=f"{block}-{fmi}-all"
            )
            for block in NAMES
            for fmi in FUNCTIONS
        ),
    ],
)
def built(request, tmp_path_factory) -> tuple[str, str, Path]:
    """Block and version of an FMU for several platforms, and the FMU."""
    block, fmi, platforms = request.param
    (fmu,) = build(tmp_path_factory.mktemp(block), [block], platforms, [fmi]).values()
    return block, fmi, fmu


@pytest.fixture(scope="module")
def fmu(built) -> Path:
    return built[2]


def parsed(fmu: Path, start: str) -> dict[str, lief.Binary]:
    """LIEF's view of the libraries whose target starts so."""
    found = {name: data for name, data in libraries(fmu).items() if name.startswith(start)}
    return {name: lief.parse(list(data)) for name, data in found.items()}


def test_one_archive_holds_a_library_for_each_platform(fmu):
    assert set(libraries(fmu)) >= set(QUICK)
    processor = {
        "linux-x86_64": lief.ELF.ARCH.X86_64,
        "linux-aarch64": lief.ELF.ARCH.AARCH64,
        "windows-x86_64": lief.PE.Header.MACHINE_TYPES.AMD64,
        "macos-x86_64": lief.MachO.Header.CPU_TYPE.X86_64,
        "macos-arm64": lief.MachO.Header.CPU_TYPE.ARM64,
    }
    for name, library in parsed(fmu, "").items():
        header = library.header
        found = {getattr(header, key, None) for key in ("machine_type", "machine", "cpu_type")}
        assert processor[name] in found, name


def test_importers_know_the_platforms_and_load_the_hosts_library(built):
    _, fmi, fmu = built
    assert validate_fmu(str(fmu)) == []
    assert {"c-code", "linux64", "darwin64"} <= set(supported_platforms(str(fmu)))
    instance = INSTANCE[fmi](fmu).initialize()
    assert np.all(np.isfinite(instance.outputs()))
    instance.close()


def test_every_library_exports_the_functions_of_the_standard_and_no_others(built):
    _, fmi, fmu = built
    for name, library in parsed(fmu, "").items():
        if isinstance(library, lief.PE.Binary):
            exported = {entry.name for entry in library.get_export().entries}
        else:
            exported = {str(symbol.name) for symbol in library.exported_symbols}
        if isinstance(library, lief.MachO.Binary):
            # What the linker defines in every library of macOS.
            exported -= {"__mh_dylib_header", "___dso_handle"}
            exported = {symbol.removeprefix("_") for symbol in exported}
        assert exported == FUNCTIONS[fmi], name


def test_linux_libraries_need_glibc_2_17_at_most(fmu):
    for name, library in parsed(fmu, "linux").items():
        assert set(library.libraries) <= {"libc.so.6", "libm.so.6"}, name
        needed = [
            str(version.name)
            for file in library.symbols_version_requirement
            for version in file.get_auxiliary_symbols()
        ]
        numbers = [re.fullmatch(r"GLIBC_(\d+)\.(\d+)(\.\d+)?", version) for version in needed]
        assert numbers and all(numbers), needed
        newest = max((int(n[1]), int(n[2])) for n in numbers if n)
        assert (2, 2) <= newest <= (2, 17), name


def test_windows_library_needs_the_kernel_and_the_universal_c_runtime_only(fmu):
    for name, library in parsed(fmu, "windows").items():
        needed = {str(file.name).lower() for file in library.imports}
        foreign = {n for n in needed if not n.startswith("api-ms-win-crt-")} - {"kernel32.dll"}
        assert "kernel32.dll" in needed and not foreign, (name, foreign)


def test_mac_libraries_are_for_macos_11_and_the_arm_one_is_signed(built):
    block, _, fmu = built
    for name, library in parsed(fmu, "macos").items():
        own, *needed = (str(file.name) for file in library.libraries)
        assert own == f"@rpath/{block}.dylib"
        assert needed == ["/usr/lib/libSystem.B.dylib"]
        oldest = library.build_version or library.version_min
        assert tuple(getattr(oldest, "minos", None) or oldest.version)[:2] == (11, 0), name
    arm = parsed(fmu, "macos-arm64")["macos-arm64"]
    assert arm.has_code_signature


def test_two_builds_for_several_platforms_have_the_same_bytes(built, tmp_path):
    block, fmi, fmu = built
    (again,) = build(tmp_path, [block], libraries(fmu), [fmi]).values()
    assert again.read_bytes() == fmu.read_bytes()


def test_an_fmu_says_the_same_whatever_it_is_built_for(built, tmp_path):
    """Nor does the build of the other version beside it show."""
    block, _, fmu = built
    host = build(tmp_path, [block])[fmu.stem]
    with zipfile.ZipFile(host) as one, zipfile.ZipFile(fmu) as several:
        for name in one.namelist():
            assert several.read(name) == one.read(name), name


def test_host_and_all_stand_for_targets_and_none_comes_twice():
    assert targets(["host"]) == (host_target(),)
    assert set(targets(["all", "host", "macos-arm64"])) == set(TARGETS.values())
    assert len(targets(["all", "host"])) == len(TARGETS)


def test_unknown_target_is_refused_with_the_choices(tmp_path):
    with pytest.raises(CompileError) as refusal:
        build(tmp_path, ["wheelrail"], ["host", "beos"])
    assert str(refusal.value) == (
        "there is no target 'beos'; choose from host, all, linux-x86_64, linux-aarch64, "
        "windows-x86_64, macos-x86_64, macos-arm64"
    )


def test_host_that_is_not_supported_is_named_with_what_is(monkeypatch):
    monkeypatch.setattr(compiler.platform, "machine", lambda: "riscv64")
    monkeypatch.setattr(compiler.platform, "system", lambda: "Linux")
    with pytest.raises(CompileError, match="for Linux riscv64; supported are: linux-x86_64, "):
        targets(["host"])


def test_without_zig_only_the_host_can_be_built_for(monkeypatch):
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(compiler.shutil, "which", lambda name: f"/bin/{name}")
    assert compiler_command(host_target()) == ["/bin/cc", "-s"]
    other = next(target for target in TARGETS.values() if target != host_target())
    with pytest.raises(CompileError) as refusal:
        compiler_command(other)
    assert f"no compiler for {other.name}: a C compiler called cc" in str(refusal.value)
    assert "pip install 'tracktrain[build]'" in str(refusal.value)


def test_without_any_compiler_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(compiler.shutil, "which", lambda name: None)
    with pytest.raises(CompileError, match=r"install ziglang|tracktrain\[build\]'`\), or a C com"):
        compiler_command(host_target())


def test_failed_compilation_quotes_the_compiler(tmp_path):
    source = tmp_path / "broken.c"
    source.write_text("int f(void) { return undeclared_name; }\n")
    with pytest.raises(CompileError) as failure:
        compile_library([source], tmp_path / "broken.so", TARGETS["linux-aarch64"])
    assert "compiling for linux-aarch64 failed" in str(failure.value)
    assert "undeclared_name" in str(failure.value)
