"""FMUs with native code that several tests of the orchestrator read."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.typed_slaves import build_fmi2, build_fmi3


@pytest.fixture(scope="session")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Variables of every type of FMI 2.0."""
    return build_fmi2(tmp_path_factory.mktemp("two"))


@pytest.fixture(scope="session")
def three(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Variables of every type of FMI 3.0, and arrays."""
    return build_fmi3(tmp_path_factory.mktemp("three"))
