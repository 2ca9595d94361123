"""What runs the programs of another platform here."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from support.tools import need

RUNNERS = {
    "windows-x86_64": ("wine", ("wine", "wine64", "/usr/lib/wine/wine64"), ()),
    "linux-aarch64": (
        "qemu-user-static and libc6-arm64-cross",
        ("qemu-aarch64-static", "qemu-aarch64"),
        ("-L", "/usr/aarch64-linux-gnu"),
    ),
}
"""By platform: Debian's name, its programs, arguments."""


def runner(platform: str) -> list[str]:
    """The beginning of a command; skips the test where there is none."""
    package, programs, arguments = RUNNERS[platform]
    found = next(filter(None, map(shutil.which, programs)), None)
    need(found, package)
    return [str(found), *arguments]


def environment(home: Path) -> dict[str, str]:
    """Of the runners: no display, and a home for wine."""
    own = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    return {**own, "WINEPREFIX": str(home), "WINEDEBUG": "-all"}
