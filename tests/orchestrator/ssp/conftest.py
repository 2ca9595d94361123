"""Two FMUs as members of archives."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.native_slaves import build_damper, build_mass
from support.ssp_archives import DAMPER, MASS


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """By the name of the member."""
    folder = tmp_path_factory.mktemp("fmus")
    return {DAMPER: build_damper(folder), MASS: build_mass(folder)}
