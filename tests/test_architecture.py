"""What the tree promises about itself."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import fmus
import orchestrator

ROOT = Path(__file__).parent.parent


def imported_modules(package: Path) -> set[str]:
    names = set()
    for path in package.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names.add((node.module or "").split(".")[0])
    return names


@pytest.mark.parametrize(
    ("package", "stranger"),
    [(orchestrator, "fmus"), (orchestrator, "tracktrain"), (fmus, "orchestrator")],
)
def test_the_two_halves_do_not_know_each_other(package, stranger):
    folder = Path(package.__file__).parent
    assert stranger not in imported_modules(folder)


def test_each_blocks_folder_has_the_same_shape():
    shape = {"__init__.py", "block.py", "experiment.py", "README.md", "reference"}
    shape |= {f"{drawing}.{kind}" for drawing in ("icon", "diagram") for kind in ("svg", "png")}
    for name in fmus.BLOCKS:
        assert shape <= {path.name for path in (ROOT / "fmus" / name).iterdir()}


def test_python_files_stay_short():
    long = {
        str(path.relative_to(ROOT)): count
        for package in ("fmus", "orchestrator", "tracktrain")
        for path in (ROOT / package).rglob("*.py")
        if (count := len(path.read_text().splitlines())) > 450
    }
    assert long == {}


def test_the_licence_in_the_fmus_is_the_projects():
    assert (ROOT / "fmus/export/license.txt").read_text() == (ROOT / "LICENSE").read_text()
