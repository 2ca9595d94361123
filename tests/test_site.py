"""The documentation as a site: it builds without a warning, and its links lead somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_site_builds_and_every_link_in_it_leads_to_a_file(tmp_path):
    command = [sys.executable, ROOT / "docs/site/build.py", "--out", tmp_path]
    built = subprocess.run(command, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    pages = list(tmp_path.rglob("*.html"))
    assert {p.stem for p in pages} >= {"index", "first_run", "truck", "orchestrator", "commands"}
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"<(?:script|link|img)[^>]+(?:src|href)=\"https?:", text), page
        for link in re.findall(r'(?:href|src)="(?!\w+:)([^"#?]+)', text):
            assert (page.parent / unquote(link)).exists(), f"{page}: {link}"


def test_every_page_of_the_documentation_has_a_place_in_the_contents():
    listed = (ROOT / "docs/site/contents.toml").read_text(encoding="utf-8")
    pages = [p.relative_to(ROOT).as_posix() for p in (ROOT / "docs").rglob("*.md")]
    assert [p for p in pages if f'"{p}"' not in listed and "/decisions/" not in p] == []
