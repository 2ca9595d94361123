"""The wheels: of every platform from one machine, each with its libraries and no others."""

from __future__ import annotations

import io
import os
import runpy
import subprocess
import sys
import zipfile

import pytest

from fmus.catalogue import _stamp, source_hash
from fmus.export.compiler import TARGETS
from fmus.names import NAMES, SUFFIX
from orchestrator.compiled.compiler import PLATFORMS
from support.source_tree import ROOT

TAGS = runpy.run_path(str(ROOT / "hatch_build.py"))["TAGS"]


def test_loops_and_fmus_are_built_for_the_same_platforms():
    fmus = {(t.system, t.machine.lower()): (t.zig, t.suffix) for t in TARGETS.values()}
    names = {"linux": "Linux", "win32": "Windows", "darwin": "Darwin"}
    loops = {(names[s], machine): (p.zig, p.suffix) for (s, machine), p in PLATFORMS.items()}
    assert fmus == loops
    assert set(TAGS) == set(TARGETS)


@pytest.mark.slow
def test_the_source_distribution_builds_the_wheel_of_another_platform(tmp_path):
    target = TARGETS["windows-x86_64"]
    environment = {**os.environ, "TRACKTRAIN_TARGET": target.name}
    built = subprocess.run(
        [sys.executable, "-m", "build", "--no-isolation", "--outdir", tmp_path, ROOT],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    assert len([*tmp_path.glob("*.tar.gz")]) == 1
    (wheel,) = tmp_path.glob("*-py3-none-win_amd64.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        assert not [name for name in names if name.endswith((".so", ".dylib"))]
        assert len([n for n in names if n.startswith("orchestrator/") and n.endswith(".dll")]) == 1
        stamp = archive.read("fmus/built/sources.sha256").decode()
        assert stamp == _stamp("Windows", "AMD64") and source_hash() in stamp
        for name in NAMES:
            for fmi, suffix in SUFFIX.items():
                data = archive.read(f"fmus/built/{name}{suffix}.fmu")
                inside = zipfile.ZipFile(io.BytesIO(data)).namelist()
                binaries = [n for n in inside if n.startswith("binaries/")]
                assert binaries == [f"binaries/{target.folder(fmi)}/{name}.dll"]
