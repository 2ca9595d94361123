"""A script in a Python process of its own, in which only some packages can be imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

TESTS = str(Path(__file__).parents[1])
"""The path by which a script finds `support`."""

BARRIER = """
import sys
class Barrier:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {hidden!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}} (hidden by the test)", name=name)
sys.meta_path.insert(0, Barrier())
"""


def run_script(script: str, folder: Path, hidden: tuple[str, ...] = (), path: str = "") -> str:
    """What the script prints. hidden: packages that it shall not find. path: its PYTHONPATH."""
    text = BARRIER.format(hidden=hidden) + script
    done = subprocess.run(
        [sys.executable, "-c", text],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
