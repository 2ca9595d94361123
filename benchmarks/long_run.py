"""Ten minutes of the hopper car: wall time, processor time and peak memory of what is done with it.

    python benchmarks/long_run.py [seconds]

A macro step of 1 ms, everything recorded, each command in a process of its own. The share is that
of the processor's time in the run before it, so that other load falls on both.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

RESULT = Path(__file__).parent / "results" / "long_run.md"


def spent(*arguments: str) -> tuple[float, float, float]:
    """Wall time [s], processor time [s] and peak memory [MB] of a command."""
    begin = time.perf_counter()
    command = [sys.executable, "-m", "tracktrain", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return time.perf_counter() - begin, used.ru_utime + used.ru_stime, _peak(used)


def _peak(used: resource.struct_rusage) -> float:
    return used.ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


def main(duration: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        rows = {"run": spent("run", "--duration", f"{duration}s", "--out", folder, "--quiet")}
        size = (Path(folder) / "results.nc").stat().st_size
        rows["assess"] = spent("assess", folder)
        rows["report"] = spent("report", folder)
    first = rows["run"][1]
    lines = [
        f"{duration:g} s of the hopper car at 1 ms, everything recorded, {size / 1e9:.2f} GB "
        f"(`long_run.py`); load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores.",
        "",
        "| command | wall | processor | of the run's | peak memory |",
        "|---|---|---|---|---|",
    ]
    for name, (wall, busy, peak) in rows.items():
        lines.append(
            f"| `{name}` | {wall:.0f} s | {busy:.0f} s | {busy / first:.2f} | {peak:.0f} MB |"
        )
    RESULT.write_text("\n".join(lines) + "\n")
    print(RESULT.read_text())


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 600.0)
