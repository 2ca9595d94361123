"""Compiles a block's C sources into the shared library of one platform."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from ..errors import FmusError


class CompileError(FmusError):
    """The sources could not be compiled; the message holds the compiler's words."""


@dataclass(frozen=True)
class Target:
    """A platform: its folder in an FMI 2.0 archive, library suffix and zig's name for it."""

    folder: str
    suffix: str
    zig: str


TARGETS = {
    ("linux", "x86_64"): Target("linux64", ".so", "x86_64-linux-gnu.2.17"),
    ("linux", "aarch64"): Target("aarch64-linux", ".so", "aarch64-linux-gnu.2.17"),
    ("win32", "x86_64"): Target("win64", ".dll", "x86_64-windows-gnu"),
    ("darwin", "x86_64"): Target("darwin64", ".dylib", "x86_64-macos"),
    ("darwin", "aarch64"): Target("aarch64-darwin", ".dylib", "aarch64-macos"),
}

# The same rounding on every platform: no fused multiply-add. zig traps on undefined
# behaviour unless optimising; -g0 and no build id keep the bytes the same on every build.
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden", "-g0")


def host_target() -> Target:
    """The target of this machine; raises CompileError on a platform that is not supported."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    try:
        return TARGETS[sys.platform, machine]
    except KeyError:
        known = ", ".join(f"{system} {machine}" for system, machine in TARGETS)
        raise CompileError(
            f"no FMU can be built for {sys.platform} {machine}; supported are: {known}"
        ) from None


def compiler_command(target: Target) -> list[str]:
    """Command line of the compiler: zig from its Python package, else the host's cc."""
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-s"]
    cc = shutil.which("cc")
    if cc and target == host_target():
        return [cc, "-s"]
    raise CompileError(
        f"no compiler for {target.folder}: install the Python package ziglang "
        "(`python -m pip install ziglang`), or a C compiler called cc"
    )


def compile_library(
    sources: Iterable[Path], library: Path, target: Target, flags: Iterable[str] = FLAGS
) -> None:
    """Compile the C files into one shared library; raises CompileError."""
    names = [path.name for path in sources]
    folder = next(iter(sources)).parent
    command = [*compiler_command(target), *flags, *names, "-o", str(library.resolve())]
    if target.suffix != ".dll":
        command.append("-lm")
    cache = platformdirs.user_cache_path("tracktrain") / "zig"
    environment = {"ZIG_GLOBAL_CACHE_DIR": str(cache), "ZIG_LOCAL_CACHE_DIR": str(cache)}
    done = subprocess.run(
        command,
        cwd=folder,
        env={**environment, **os.environ},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise CompileError(f"{' '.join(command)} failed:\n{done.stderr.strip()}")
