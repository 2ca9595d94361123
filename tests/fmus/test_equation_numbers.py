"""Equations of a block are found by their numbers, in its README and in the FMU's documentation."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

import fmus

READMES = sorted(Path(fmus.__file__).parent.glob("*/README.md"))
NUMBER = re.compile(r"^ {4}\((\d+)\) ", re.MULTILINE)


@pytest.mark.parametrize("readme", READMES, ids=lambda readme: readme.parent.name)
def test_a_number_stands_for_one_equation(readme):
    counts = Counter(NUMBER.findall(readme.read_text(encoding="utf-8")))
    assert [number for number, count in counts.items() if count > 1] == []


def test_the_blocks_number_their_equations():
    numbered = [r.parent.name for r in READMES if NUMBER.search(r.read_text(encoding="utf-8"))]
    assert {"carbody", "track", "truck", "wheelrail"} <= set(numbered)
