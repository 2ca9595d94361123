"""Where the blocks' FMUs are: built on installation, rebuilt when a source has changed."""

from __future__ import annotations

import hashlib
import json
import os
import platform
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from functools import cache
from pathlib import Path
from typing import Any

import platformdirs

from .names import CAR, NAMES, SUFFIX

PACKAGE = Path(__file__).parent

STAMP = "sources.sha256"

announce: Callable[[str], AbstractContextManager[object]] = nullcontext
"""Says what takes its time while it does; a command line puts its own way of saying here."""

NUMBERS = "numbers.json"
"""File beside the FMUs with what is known of the blocks' parameters without building the blocks."""


@cache
def source_hash() -> str:
    """SHA-256 of all that an FMU is made from: the files of this package."""
    digest = hashlib.sha256()
    files = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*")}
    for place, path in sorted(files.items()):  # as text: Windows sorts paths otherwise
        if path.is_file() and not place.startswith("built/") and "__pycache__" not in place:
            digest.update(place.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def fmu_path(name: str, fmi: str = "2.0") -> Path:
    """Path of the up-to-date FMU of a block; builds the FMUs when the sources have changed.

    Those of a block that no car needs are built when they are first asked for. Raises KeyError for
    an unknown block or version, CompileError when a build is needed and fails.
    """
    if name not in NAMES:
        raise KeyError(f"no block is called {name!r}; the blocks are {', '.join(NAMES)}")
    if fmi not in SUFFIX:
        raise KeyError(f"no FMU is made for FMI {fmi!r}; the versions are {', '.join(SUFFIX)}")
    path = folder() / f"{name}{SUFFIX[fmi]}.fmu"
    return path if path.exists() else _built(name, path)


def parameters(name: str) -> dict[str, dict[str, float]]:
    """The parameters [SI] of a shipped parameter set, by block and name; raises KeyError."""
    return {block: {**values} for block, values in _numbers()["sets"][name].items()}


def parameter_units(block: str) -> dict[str, str]:
    """The unit of each parameter of a block; raises KeyError."""
    return {**_numbers()["units"][block]}


@cache
def _numbers() -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder() / NUMBERS).read_text())
    return found


@cache
def folder() -> Path:
    """Folder with the up-to-date FMUs of this machine's platform."""
    own = PACKAGE / "built"
    places = [own, platformdirs.user_cache_path("tracktrain") / source_hash()[:16]]
    for place in places:
        if _is_current(place):
            return place
    place = own if os.access(PACKAGE, os.W_OK) else places[1]
    with announce("building the FMUs of the car for this machine, once"):
        build_into(place, CAR)
    return place


def build_into(place: Path, names: Iterable[str] = NAMES, platform_name: str = "host") -> None:
    """Build the FMUs of these blocks for a platform, and no others, into the folder; stamp it.

    platform_name: of `export.compiler.TARGETS`, or `host`. Raises CompileError, OSError.
    """
    from . import BLOCKS
    from .describe.parameters import PARAMETER_SETS, parameter_set
    from .export import build
    from .export.compiler import targets

    (target,) = targets([platform_name])
    stamp = place / STAMP
    stamp.unlink(missing_ok=True)
    built = set(build(place, names, [platform_name]).values())
    for old in set(place.glob("*.fmu")) - built:  # another process may be at the same
        old.unlink(missing_ok=True)
    blocks = [kind() for kind in BLOCKS.values()]
    known = {
        "units": {block.name: {p.name: p.unit for p in block.parameters} for block in blocks},
        "sets": {
            name: {block.name: parameter_set(name).values(block) for block in blocks}
            for name in PARAMETER_SETS
        },
    }
    (place / NUMBERS).write_text(json.dumps(known, indent=1))
    stamp.write_text(_stamp(target.system, target.machine))


def _built(name: str, path: Path) -> Path:
    """The FMU of a further block, built beside the others, or in the cache if that is closed."""
    from .export import build

    place = path.parent
    if not os.access(place, os.W_OK):
        place = platformdirs.user_cache_path("tracktrain") / source_hash()[:16]
    if not (place / path.name).exists():
        with announce(f"building the FMU {name} for this machine, once"):
            build(place, [name])
    return place / path.name


def _is_current(place: Path) -> bool:
    try:
        files = [f"{name}{suffix}.fmu" for name in CAR for suffix in SUFFIX.values()]
        return (place / STAMP).read_text() == _stamp(platform.system(), platform.machine()) and all(
            (place / name).exists() for name in (*files, NUMBERS)
        )
    except OSError:
        return False


def _stamp(system: str, machine: str) -> str:
    return f"{source_hash()} {system} {machine}\n"
