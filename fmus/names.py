"""Names of the blocks and of their FMUs."""

from __future__ import annotations

NAMES = ("carbody", "truck", "wheelrail", "track")


SUFFIX = {"2.0": "", "3.0": "_fmi3"}
"""What follows a block's name in the name of its FMU, by version of FMI."""


FMI_VERSIONS = tuple(SUFFIX)
