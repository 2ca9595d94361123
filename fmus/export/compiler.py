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
    """A platform: its name, folders in an FMI 2.0 and 3.0 archive, library suffix, name for zig,
    and what Python calls its system and its machine."""

    name: str
    folder2: str
    folder3: str
    suffix: str
    zig: str
    system: str
    machine: str

    def folder(self, fmi: str) -> str:
        """The platform's folder in the archives of a version of FMI."""
        return self.folder2 if fmi == "2.0" else self.folder3


_TARGETS = """
linux-x86_64   linux64        x86_64-linux   .so    x86_64-linux-gnu.2.17  Linux   x86_64
linux-aarch64  aarch64-linux  aarch64-linux  .so    aarch64-linux-gnu.2.17 Linux   aarch64
windows-x86_64 win64          x86_64-windows .dll   x86_64-windows-gnu     Windows AMD64
macos-x86_64   darwin64       x86_64-darwin  .dylib x86_64-macos.11.0      Darwin  x86_64
macos-arm64    aarch64-darwin aarch64-darwin .dylib aarch64-macos.11.0     Darwin  arm64
"""

# FMI 2.0.4 calls the x86-64 ones linux64, win64 and darwin64, and takes the names of all others
# from FMI 3.0. The versions are the oldest glibc and macOS that the libraries run with.
TARGETS = {row.split()[0]: Target(*row.split()) for row in _TARGETS.strip().splitlines()}

LANGUAGE = "C99"
"""What our C is written in, as FMI's build descriptions call it."""

# The same rounding on every platform: no fused multiply-add. zig traps on undefined
# behaviour unless optimising, and keeps frame pointers unless told; -g0 and no build id keep the
# bytes the same on every build.
FLAGS = (
    f"-std={LANGUAGE.lower()}",
    *("-O2", "-fomit-frame-pointer", "-ffp-contract=off"),
    *("-fPIC", "-shared", "-fvisibility=hidden", "-g0"),
)


def host_target() -> Target:
    """The target of this machine; raises CompileError on a platform that is not supported."""
    system, machine = platform.system(), platform.machine()
    for target in TARGETS.values():
        if (target.system, target.machine) == (system, machine):
            return target
    raise CompileError(
        f"no FMU can be built for {system} {machine}; supported are: {', '.join(TARGETS)}"
    )


def targets(names: Iterable[str]) -> tuple[Target, ...]:
    """The targets of these names, each once; `host` is this machine, `all` are all.

    Raises CompileError for a name that is not known.
    """
    chosen: dict[str, Target] = {}
    for name in names:
        if name == "all":
            chosen.update(TARGETS)
        elif name == "host":
            chosen.setdefault(host_target().name, host_target())
        elif name in TARGETS:
            chosen[name] = TARGETS[name]
        else:
            raise CompileError(
                f"there is no target '{name}'; choose from host, all, {', '.join(TARGETS)}"
            )
    return tuple(chosen.values())


def compiler_command(target: Target) -> list[str]:
    """Command line of the compiler: zig from its Python package, else the host's cc."""
    if importlib.util.find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-s"]
    install = "install ziglang (`python -m pip install 'tracktrain[build]'`)"
    if target != host_target():
        raise CompileError(
            f"no compiler for {target.name}: a C compiler called cc is used for this machine "
            f"({host_target().name}) only; {install}"
        )
    cc = shutil.which("cc")
    if cc is None:
        raise CompileError(f"no compiler for {target.name}: {install}, or a C compiler called cc")
    return [cc, "-s"]


def compile_library(
    sources: Iterable[Path],
    library: Path,
    target: Target,
    flags: Iterable[str] = FLAGS,
    libraries: Iterable[str] = ("m",),
) -> None:
    """Compile the C files into one shared library; raises CompileError.

    libraries: of C, which Unix has apart.
    """
    paths = list(sources)
    command = [*compiler_command(target), *flags, *(path.name for path in paths)]
    command += ["-o", str(library.resolve()), *_link_flags(library, target, libraries)]
    cache = platformdirs.user_cache_path("tracktrain") / "zig"
    environment = {"ZIG_GLOBAL_CACHE_DIR": str(cache), "ZIG_LOCAL_CACHE_DIR": str(cache)}
    done = subprocess.run(
        command,
        cwd=paths[0].parent,
        env={**environment, **os.environ},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise CompileError(
            f"compiling for {target.name} failed: {' '.join(command)}\n{done.stderr.strip()}"
        )


def _link_flags(library: Path, target: Target, libraries: Iterable[str]) -> list[str]:
    if target.suffix == ".dll":
        return []
    flags = [f"-l{name}" for name in libraries]
    if target.suffix == ".dylib":
        # Else the library would be named after the folder that it was linked in.
        flags.append(f"-Wl,-install_name,@rpath/{library.name}")
    return flags
