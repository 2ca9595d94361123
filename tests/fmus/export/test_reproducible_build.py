"""The same sources give the same FMUs, byte for byte, whoever builds them and where."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile

from fmus.catalogue import fmu_path
from fmus.names import CAR, FMI_VERSIONS

BUILD = (
    "import sys; from pathlib import Path; from fmus.export import build; "
    "from fmus.names import CAR; build(Path(sys.argv[1]), CAR)"
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
    for built in (fmu_path(name, fmi) for name in CAR for fmi in FMI_VERSIONS):
        name = built.name
        with zipfile.ZipFile(built) as one, zipfile.ZipFile(out / name) as other:
            assert one.namelist() == other.namelist()
            for member in one.namelist():
                assert one.read(member) == other.read(member), f"{name}: {member}"
        assert built.read_bytes() == (out / name).read_bytes()
    assert list(scratch.iterdir()) == []
