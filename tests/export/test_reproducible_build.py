"""The same sources give the same FMUs, byte for byte, whoever builds them and where."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile

from fmus.catalogue import NAMES, fmu_path

BUILD = (
    "import sys; from pathlib import Path; from fmus.export import build; build(Path(sys.argv[1]))"
)


def test_another_process_seed_and_folder_give_the_same_bytes(tmp_path):
    """All of an archive's members, so that a difference says where it is, and their order."""
    scratch = tmp_path / "a folder for temporary files"
    scratch.mkdir()
    out = tmp_path / "out"
    subprocess.run(
        [sys.executable, "-c", BUILD, out],
        env={**os.environ, "PYTHONHASHSEED": "1980", "TMPDIR": str(scratch), "TZ": "Asia/Tokyo"},
        check=True,
    )
    for name in NAMES:
        with zipfile.ZipFile(fmu_path(name)) as one, zipfile.ZipFile(out / f"{name}.fmu") as other:
            assert one.namelist() == other.namelist()
            for member in one.namelist():
                assert one.read(member) == other.read(member), f"{name}: {member}"
        assert fmu_path(name).read_bytes() == (out / f"{name}.fmu").read_bytes()
    assert list(scratch.iterdir()) == []
