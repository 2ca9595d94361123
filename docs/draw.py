"""Renders the FMUs' drawings (`icon.svg`, `diagram.svg`, ...) to the PNG files beside them.

python docs/draw.py     needs Chromium
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

FOLDERS = [Path(__file__).parent.parent / name for name in ("fmus", "tracktrain/one_fmu")]


def render(drawing: Path, chromium: str) -> None:
    """Write the drawing's PNG at twice its size, transparent where nothing is drawn."""
    viewbox = re.search(r'viewBox="0 0 (\d+) (\d+)"', drawing.read_text())
    assert viewbox, f"{drawing} has no viewBox from 0 0"
    subprocess.run(
        [
            chromium,
            "--headless",
            "--no-sandbox",
            "--force-device-scale-factor=2",
            "--default-background-color=00000000",
            f"--window-size={viewbox[1]},{viewbox[2]}",
            f"--screenshot={drawing.with_suffix('.png')}",
            drawing.as_uri(),
        ],
        check=True,
        stderr=subprocess.DEVNULL,
    )


if __name__ == "__main__":
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        sys.exit("Chromium is needed: neither chromium nor google-chrome is on the path")
    for file in sorted(drawing for folder in FOLDERS for drawing in folder.rglob("*.svg")):
        render(file, program)
