"""The recipes of docs/maintainers/extending.md, run as they stand there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs/maintainers/extending.md").read_text(encoding="utf-8")
RECIPES = {
    title: re.findall(r"^```\w+\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    for title, text in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)
}


def test_there_is_a_recipe_for_what_is_added_most_often():
    wanted = {"A block", "A creep law", "A master", "A sink", "A study", "A second car"}
    assert wanted == set(RECIPES)


@pytest.mark.parametrize("title", RECIPES)
def test_a_recipe_works_as_it_is_written_and_changes_two_files_at_most(title, tmp_path):
    for package in ("fmus", "orchestrator", "structures", "tracktrain"):
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    changed, tried = set(), []
    for block in RECIPES[title]:
        first, _, text = block.partition("\n")
        what, place = re.fullmatch(r"(?:# |<!-- )(\w+):\s*(\S*)(?: -->)?", first).groups()
        path = tmp_path / place
        if what == "file":
            assert not path.exists()
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
        elif what == "change":
            old, new = text.split("=>\n")
            assert path.read_text().count(old) == 1
            path.write_text(path.read_text().replace(old, new))
            changed.add(place)
        else:
            assert what == "try"
            tried.append(text)
    assert len(changed) <= 2 and len(tried) == 1
    run = subprocess.run(
        [sys.executable, "-c", tried[0]],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
