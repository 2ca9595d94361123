"""C to a shared library of a platform: by zig from its Python package, else by the host's cc."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from ..errors import OrchestratorError
from ..files import whole_file


class CompileError(OrchestratorError):
    """There is no compiler, or it refuses; the message says which, and what to do."""


@dataclass(frozen=True)
class Platform:
    """What zig calls a platform, and how its libraries end."""

    zig: str
    suffix: str


PLATFORMS = {
    ("linux", "x86_64"): Platform("x86_64-linux-gnu.2.17", ".so"),
    ("linux", "aarch64"): Platform("aarch64-linux-gnu.2.17", ".so"),
    ("win32", "amd64"): Platform("x86_64-windows-gnu", ".dll"),
    ("darwin", "x86_64"): Platform("x86_64-macos.11.0", ".dylib"),
    ("darwin", "arm64"): Platform("aarch64-macos.11.0", ".dylib"),
}
"""By Python's names of the system and the machine."""

# No fused multiply-add: the same numbers everywhere, and those of plain Python. Memory is read as
# what its address is said to point to, whoever wrote it.
FLAGS = (
    *("-std=c11", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-strict-aliasing"),
    *("-fPIC", "-shared", "-fvisibility=hidden", "-fomit-frame-pointer", "-g0", "-w"),
)


def host() -> Platform:
    """This machine; raises CompileError for one that is not known."""
    machine = platform.machine().lower()
    if (sys.platform, machine) not in PLATFORMS:
        raise CompileError(f"nothing is compiled for {sys.platform} {machine}")
    return PLATFORMS[sys.platform, machine]


def compile_library(text: str, library: Path, target: Platform) -> None:
    """Compile C into a shared library, and its checksum beside it.

    Raises CompileError, UnwrittenError, OSError.
    """
    with tempfile.TemporaryDirectory() as folder:
        source, made = Path(folder) / "loops.c", Path(folder) / library.name
        source.write_text(text)
        libraries = [] if target.suffix == ".dll" else ["-lm"]
        command = [*_compiler(target), *FLAGS, source.name, "-o", made.name, *libraries]
        cache = str(platformdirs.user_cache_path("tracktrain") / "zig")
        done = subprocess.run(
            command,
            cwd=folder,
            env={"ZIG_GLOBAL_CACHE_DIR": cache, "ZIG_LOCAL_CACHE_DIR": cache, **os.environ},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            raise CompileError(f"compiling the loops failed: {' '.join(command)}\n{done.stderr}")
        checksum_file(made).write_text(checksum(made))
        for new, place in ((made, library), (checksum_file(made), checksum_file(library))):
            with whole_file(place) as own:
                shutil.copyfile(new, own)


def checksum(path: Path) -> str:
    """The SHA-256 of a file; raises OSError."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def checksum_file(library: Path) -> Path:
    """Where the checksum of a library stands."""
    return library.with_name(f"{library.name}.sha256")


def _compiler(target: Platform) -> list[str]:
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-s"]
    cc = shutil.which("cc") if target == host() else None
    if cc is None:
        raise CompileError(
            "there is no C compiler; install ziglang (`python -m pip install "
            "'tracktrain[build]'`), or a C compiler called cc"
        )
    return [cc]
