"""From nothing to the first result: the README's first command where nothing is installed yet.

    python benchmarks/first_result.py [folder]

A new virtual environment, empty caches of ours and of the user, and the commands as a user types
them. Downloads are part of the first command: pip's own cache is used as it is found, and the
table says so. The rows below the first two are of commands in the environment that these leave, in
a folder without sources: of each the median of `TIMES`.
CPU seconds are those of all processes of a command. folder: where to work; else a temporary one.
"""

from __future__ import annotations

import os
import platform
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import venv
from collections.abc import Mapping
from pathlib import Path
from statistics import median

ROOT = Path(__file__).parents[1]
RESULT = Path(__file__).parent / "results" / "first_result.md"
RUN = "tracktrain run"
SHORT = "tracktrain run --speed '60 ft/s' --track report --duration 8s"
TIMES = 3


def main(folder: Path) -> None:
    install = readme_command()
    environment, project = folder / "venv", folder / "project"
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    tracked = subprocess.check_output(["git", "ls-files", "-z"], cwd=ROOT, text=True)
    for name in filter(None, tracked.split("\0")):  # no built files
        (project / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, project / name)
    venv.create(environment, with_pip=True)
    before = megabytes(environment)
    cache = folder / "cache"
    settings = {
        **{name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        "PATH": f"{environment / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "VIRTUAL_ENV": str(environment),
        "XDG_CACHE_HOME": str(cache),
        "PIP_CACHE_DIR": pip_cache(),
    }
    pip, first = install.split(" && ")
    rows = [timed("first command, installation", pip, project, settings)]
    installed = megabytes(environment) - before
    rows.append(timed("first command, the run", first, project, settings))
    rows += [
        timed("again, warm", RUN, folder, settings, TIMES),
        timed("with its page, warm", f"{RUN} --report", folder, settings, TIMES),
        timed("8 s instead of a minute, warm", SHORT, folder, settings, TIMES),
        timed("that with its page, warm", f"{SHORT} --report", folder, settings, TIMES),
        timed("import orchestrator", "python -c 'import orchestrator'", folder, settings, TIMES),
        timed("help", "tracktrain run --help", folder, settings, TIMES),
    ]
    written = table(rows, installed, megabytes(cache), busy)
    RESULT.write_text(written, encoding="utf-8")
    print(written)


def readme_command() -> str:
    """The command that installs and runs, as the README has it."""
    found = re.search(
        r"^python -m pip install .*tracktrain run$", (ROOT / "README.md").read_text(), re.M
    )
    if found is None:
        raise SystemExit("the README has no command that installs and runs")
    return found[0]


def pip_cache() -> str:
    """Where pip keeps what it has downloaded."""
    asked = [sys.executable, "-m", "pip", "cache", "dir"]
    return subprocess.check_output(asked, text=True).strip()


def timed(
    what: str, command: str, folder: Path, settings: Mapping[str, str], times: int = 1
) -> tuple[str, ...]:
    """A command's wall and CPU time [s], medians of several; ends the program where it fails."""
    found = [spent(command, folder, settings) for _ in range(times)]
    wall, used = (median(each) for each in zip(*found, strict=True))
    print(f"{what}: {wall:.1f} s wall, {used:.1f} s CPU", flush=True)
    return what, f"`{command}`", f"{wall:.2f}", f"{used:.2f}"


def spent(command: str, folder: Path, settings: Mapping[str, str]) -> tuple[float, float]:
    """Wall and CPU time of a command [s]."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        command, shell=True, cwd=folder, env=settings, capture_output=True, text=True, check=False
    )
    wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise SystemExit(f"{command} failed:\n{done.stdout}\n{done.stderr}")
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def megabytes(folder: Path) -> float:
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(path.stat().st_size for path in files) / 1e6


def table(rows: list[tuple[str, ...]], installed: float, cache: float, busy: float) -> str:
    heading = ("what", "command", "wall [s]", "CPU [s]")
    lines = [" | ".join(row) for row in (heading, ("---",) * 4, *rows)]
    return (
        f"From nothing to the first result; {os.cpu_count()} cores, {platform.machine()}, "
        f"{platform.system()}, Python {platform.python_version()}; load average before it began: "
        f"{busy:.1f}. Pip's own cache of downloads was as it was found.\n\n"
        + "".join(f"| {line} |\n" for line in lines)
        + f"\nInstalled: {installed:.0f} MB. Caches after it: {cache:.0f} MB.\n"
    )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as place:
            main(Path(place))
