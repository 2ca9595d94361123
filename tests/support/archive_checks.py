"""What tools that others wrote find wrong with an FMU file."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from fmpy.validation import validate_fmu


def fmutool_report(path: Path) -> str:
    """What `fmutool -check` prints."""
    fmutool = Path(sys.executable).parent / "fmutool"
    command = [fmutool, "-input", path, "-check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def findings(path: Path) -> list[str]:
    """Findings of `fmpy validate` and of `fmutool -check`."""
    report = fmutool_report(path)
    wrong = [line for line in report.splitlines() if "WARNING" in line or "ERROR" in line]
    for verdict in (
        r"seems to be compliant with FMI-[23]\.0",
        r"No semantic error against the FMI-[23]",
    ):
        if not re.search(verdict, report):
            wrong.append(f"fmutool does not say {verdict!r}")
    return [*validate_fmu(str(path)), *wrong]
