"""The tutorials of docs/tutorials, run block by block as they stand there."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "tutorials"
BLOCK = re.compile(r"^```(\w+) ?([\w.]*)\n(.*?)^```", re.DOTALL | re.MULTILINE)


@pytest.mark.slow
@pytest.mark.parametrize("tutorial", sorted(p.stem for p in FOLDER.glob("*.md")))
def test_a_tutorial_works_as_it_is_written(tutorial, tmp_path):
    command = tmp_path / "bin" / "tracktrain"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m tracktrain "$@"\n')
    command.chmod(0o755)
    place = tmp_path / "work"
    place.mkdir()
    paths = [str(command.parent), str(Path(sys.executable).parent), os.environ["PATH"]]
    environment = {**os.environ, "PATH": os.pathsep.join(paths), "PYTHONPATH": _packages()}
    text = (FOLDER / f"{tutorial}.md").read_text(encoding="utf-8")
    done = 0
    for language, name, block in BLOCK.findall(text):
        if language not in ("sh", "python"):
            continue
        if language == "python":
            script = place / (name or f"block_{done}.py")
            script.write_text(block, encoding="utf-8")
            block = f"python {script.name}"
        run = subprocess.run(
            ["sh", "-e", "-c", block],
            cwd=place,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert run.returncode == 0, f"{block}\n{run.stdout}\n{run.stderr}"
        done += 1
    assert done >= 2


def _packages() -> str:
    """Where the packages are that the tests work with."""
    import tracktrain

    return str(Path(tracktrain.__file__).parents[1])
