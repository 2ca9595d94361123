"""The sources in an FMU: importers that compile them get the same block, to the last bit."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.model_description import read_build_description

from fmus.catalogue import fmu_path
from fmus.export.compiler import LANGUAGE
from fmus.names import CAR
from support.fmi3_instance import INSTANCE
from support.functions import FUNCTIONS
from support.hosted import HOST, Hosted, step
from support.tools import need

STEPS = 200
FOLDER = {"2.0": fmpy.platform, "3.0": fmpy.platform_tuple}


def source_files(fmu: Path) -> list[str]:
    """Names of what an importer compiles, from an archive or its folder."""
    (configuration,) = read_build_description(str(fmu))
    (files,) = configuration.sourceFileSets
    return files.sourceFiles


def unpacked(fmu: Path, folder: Path) -> Path:
    """The archive in a folder, without its binaries."""
    fmpy.extract(str(fmu), str(folder))
    shutil.rmtree(folder / "binaries")
    return folder


def packed(folder: Path) -> Path:
    archive = shutil.make_archive(str(folder.parent / "compiled"), "zip", folder)
    return Path(archive).rename(folder.parent / "compiled.fmu")


def outputs(fmu: Path, fmi: str) -> np.ndarray:
    """Outputs [step, output] while the inputs change at random."""
    instance = INSTANCE[fmi](fmu).initialize()
    rng = np.random.default_rng(1980)
    sizes = {"m": 2e-3, "rad": 1e-3, "m/s": 0.05, "rad/s": 0.02, "N": 1e4, "N.m": 5e3}
    inputs = [v for v in instance.variables.values() if v.causality == "input"]
    rows = []
    for k in range(STEPS):
        values = {
            v.name: float(v.start) + sizes.get(v.unit, 0.0) * rng.uniform(-1, 1) for v in inputs
        }
        instance.set(values)
        instance.slave.doStep(k * 1e-3, 1e-3)
        rows.append(instance.outputs())
    instance.close()
    return np.array(rows)


def cc(*arguments: object, folder: Path) -> str:
    """What the host's compiler says."""
    need(shutil.which("cc"), "a C compiler called cc")
    done = subprocess.run(
        ["cc", *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stderr


def test_the_build_description_lists_all_c_files_once(block_name, fmi):
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        there = {name for name in archive.namelist() if name.startswith("sources/")}
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
    listed = source_files(fmu_path(block_name, fmi))
    assert sorted(f"sources/{name}" for name in listed) == sorted(
        name for name in there if name.endswith(".c")
    )
    for files in description.iterfind("*/SourceFiles"):
        assert sorted(f.get("name", "") for f in files) == sorted(listed)


@pytest.mark.slow
def test_fmpy_compile_gives_the_same_bits(block_name, fmi, tmp_path):
    need(shutil.which("cc") and shutil.which("cmake"), "cmake and a C compiler")
    folder = unpacked(fmu_path(block_name, fmi), tmp_path / "fmu")
    build_platform_binary(folder)
    assert np.array_equal(outputs(packed(folder), fmi), outputs(fmu_path(block_name, fmi), fmi))


def test_the_hosts_compiler_finds_nothing_and_gives_the_same_bits(block_name, fmi, tmp_path):
    folder = unpacked(fmu_path(block_name, fmi), tmp_path / "fmu")
    library = folder / "binaries" / FOLDER[fmi] / f"{block_name}{fmpy.sharedLibraryExtension}"
    library.parent.mkdir(parents=True)
    flags = (f"-std={LANGUAGE.lower()}", "-O1", "-Wall", "-Wextra", "-fPIC", "-shared")
    said = cc(*flags, *source_files(folder), "-o", library, "-lm", folder=folder / "sources")
    assert said == ""
    assert np.array_equal(outputs(packed(folder), fmi), outputs(fmu_path(block_name, fmi), fmi))


LINKED = [*((block, "2.0") for block in CAR), ("truck", "3.0")]


@pytest.mark.slow
def test_several_fmus_are_linked_into_one_program_and_give_the_same_bits(tmp_path):
    """By the prefixes of FMI's headers, the same for a block's FMUs of both versions."""
    objects = []
    for block, fmi in LINKED:
        folder = unpacked(fmu_path(block, fmi), tmp_path / f"{block}{fmi[0]}") / "sources"
        prefix = f"-DFMI{fmi[0]}_FUNCTION_PREFIX={block}_"
        cc("-std=c99", "-O1", "-c", prefix, *source_files(folder.parent), folder=folder)
        objects += folder.glob("*.o")
    cc(HOST, *objects, "-rdynamic", "-w", "-ldl", "-lm", "-o", "linked", folder=tmp_path)
    cc(HOST, "-w", "-ldl", "-o", "loaded", folder=tmp_path)
    linked, loaded = [], []
    for block, fmi in LINKED:
        name = f"{block}{fmi[0]}"
        library = Path(fmpy.extract(str(fmu_path(block, fmi)), str(tmp_path / f"{name}-whole")))
        library /= f"binaries/{FOLDER[fmi]}/{block}{fmpy.sharedLibraryExtension}"
        linked.append(Hosted(fmu_path(block, fmi), tmp_path, f"{name}-linked", "-", f"{block}_"))
        loaded.append(Hosted(fmu_path(block, fmi), tmp_path, f"{name}-loaded", str(library)))
    step(["./linked"], linked, tmp_path)
    step(["./loaded"], loaded, tmp_path)
    for one, other in zip(linked, loaded, strict=True):
        assert np.ptp(one.outputs(), axis=0).max() > 0.0
        assert np.array_equal(one.outputs(), other.outputs())


def test_a_prefix_is_that_of_every_name_that_the_linker_sees(block_name, fmi, tmp_path):
    need(shutil.which("nm"), "nm, of the binutils")
    folder = unpacked(fmu_path(block_name, fmi), tmp_path / "fmu") / "sources"
    prefix = f"-DFMI{fmi[0]}_FUNCTION_PREFIX=own_"
    cc("-std=c99", "-O0", "-c", prefix, *source_files(folder.parent), folder=folder)
    command = ["nm", "--extern-only", "--defined-only", "--format=posix", *folder.glob("*.o")]
    listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    names = {line.split()[0] for line in listed.splitlines() if " " in line}
    assert {f"own_{name}" for name in FUNCTIONS[fmi]} <= names
    assert {name for name in names if not name.startswith("own_")} == set()
