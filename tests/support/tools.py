"""Tools that some tests need and that pip does not bring: wine, qemu, libraries of Debian."""

from __future__ import annotations

import os

import pytest


def need(found: object, what: str) -> None:
    """Skip the test for want of a tool; where CI is set in the environment, fail it."""
    if found:
        return
    if os.environ.get("CI"):
        pytest.fail(f"{what} is missing; .ci/run installs it where apt is at hand")
    pytest.skip(f"needs {what}")
