"""The blocks as parameters of tests: those of a car always, further ones in the slow tests."""

from __future__ import annotations

import pytest

from fmus.names import CAR, NAMES

EACH_BLOCK = [
    *CAR,
    *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES if name not in CAR),
]
