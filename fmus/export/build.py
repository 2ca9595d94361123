"""Builds FMUs: the files of one archive, compiled, zipped, the same bytes on every build."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .. import BLOCKS
from ..block import Block
from ..parameters import DEFAULT_SET, parameter_set
from . import code
from .accompanying import accompanying_files
from .archive import NO_GUID, guid, write_archive
from .build_description import build_description
from .compiler import FLAGS, Target, compile_library, targets
from .description import model_description

VERSION = "0.1.0"


def build(
    out: Path, names: Iterable[str] | None = None, platforms: Iterable[str] = ("host",)
) -> dict[str, Path]:
    """Write NAME.fmu for each block into the folder and return their paths.

    Each holds the binaries of all the platforms: names of compiler.TARGETS, `host` or `all`.
    Raises CompileError, or OSError for a folder that cannot be written.
    """
    chosen = targets(platforms)
    out.mkdir(parents=True, exist_ok=True)
    return {name: build_block(BLOCKS[name](), out, chosen) for name in names or BLOCKS}


def build_block(block: Block, out: Path, platforms: Iterable[Target] | None = None) -> Path:
    """Write one block's FMU into the folder and return its path."""
    parameters = parameter_set(DEFAULT_SET)
    start = parameters.values(block)
    description = model_description(block, start, NO_GUID, VERSION)
    sources = code.sources(block, start, NO_GUID)
    own = _guid(description, sources)
    sources = {name: text.replace(NO_GUID, own) for name, text in sources.items()}
    files: dict[str, bytes] = {
        "modelDescription.xml": description.replace(NO_GUID, own).encode(),
        "sources/buildDescription.xml": build_description(block.name, sources).encode(),
    }
    files |= accompanying_files(block, parameters, start, description)
    for name, text in sources.items():
        files[f"sources/{name}"] = text.encode()
    files |= _binaries(block.name, sources, platforms or targets(["host"]))
    path = out / f"{block.name}.fmu"
    write_archive(path, files)
    return path


def _guid(description: str, sources: Mapping[str, str]) -> str:
    """A GUID that changes with the description, the sources or the compiler's flags."""
    digest = hashlib.sha256(description.encode())
    for name, text in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + text.encode())
    digest.update(" ".join(FLAGS).encode())
    return guid(digest.hexdigest())


def _binaries(
    name: str, sources: Mapping[str, str], platforms: Iterable[Target]
) -> dict[str, bytes]:
    """The block's library of each platform by its place in the archive."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for file, text in sources.items():
            (folder / file).write_text(text)
        units = sorted(folder.glob("*.c"))

        def compiled(target: Target) -> tuple[str, bytes]:
            place = f"binaries/{target.folder}/{name}{target.suffix}"
            library = folder / place
            library.parent.mkdir(parents=True)
            compile_library(units, library, target)
            return place, library.read_bytes()

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            return dict(pool.map(compiled, platforms))
