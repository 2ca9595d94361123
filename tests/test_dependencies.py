"""The list of dependencies in the documents is that of pyproject.toml."""

from __future__ import annotations

import re
import tomllib

from support.source_tree import ROOT

PAGE = (ROOT / "docs/maintainers/dependencies.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TOOLS = ("docs", "test")
"""Extras of who works on the code."""


def names(requirements: list[str]) -> list[str]:
    return [re.split(r"[<>=; \[]", requirement)[0] for requirement in requirements]


def test_every_dependency_has_its_weight_and_its_reason():
    always, extras = PAGE.partition("## Always")[2].split("## Extras")
    listed = re.findall(r"^\| ([\w.-]+) \| [\d.]+ \| .*\| (.{5,}) \|$", always, re.M)
    assert [name for name, _ in listed] == names(PROJECT["dependencies"])
    rows = re.findall(r"^\| ([\w.-]+) \| (\w+) \| [\d.]+ \| .*\| .+ \|$", extras, re.M)
    of_extras = {
        (name, extra)
        for extra, requirements in PROJECT["optional-dependencies"].items()
        if extra not in TOOLS
        for name in names(requirements)
    }
    assert set(rows) == of_extras and len(rows) == len(of_extras)
