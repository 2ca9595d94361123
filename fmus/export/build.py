"""Builds FMUs: the files of one archive, compiled, zipped, the same bytes on every build."""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .. import BLOCKS
from ..block import Block
from ..parameters import DEFAULT_SET, parameter_set
from . import code
from .compiler import FLAGS, Target, compile_library, targets
from .description import model_description
from .documentation import documentation

VERSION = "0.1.0"
NO_GUID = "{00000000-0000-0000-0000-000000000000}"
EPOCH = (1980, 1, 1, 0, 0, 0)


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
    guid = _guid(description, sources)
    sources = {name: text.replace(NO_GUID, guid) for name, text in sources.items()}
    files: dict[str, bytes] = {
        "modelDescription.xml": description.replace(NO_GUID, guid).encode(),
        "documentation/index.html": documentation(block, parameters, start).encode(),
        "documentation/licenses/license.txt": _licence().encode(),
    }
    for name, text in sources.items():
        files[f"sources/{name}"] = text.encode()
    files |= _binaries(block.name, sources, platforms or targets(["host"]))
    path = out / f"{block.name}.fmu"
    _write_archive(path, files)
    return path


def _guid(description: str, sources: Mapping[str, str]) -> str:
    """A GUID that changes with the description, the sources or the compiler's flags."""
    digest = hashlib.sha256(description.encode())
    for name, text in sorted(sources.items()):
        digest.update(name.encode() + b"\0" + text.encode())
    digest.update(" ".join(FLAGS).encode())
    h = digest.hexdigest()
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


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


def _licence() -> str:
    return (Path(__file__).parent / "license.txt").read_text()


def _write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Zip with fixed times and order; the file appears whole or not at all."""
    descriptor, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(descriptor, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for file in sorted(files, key=lambda name: (name != "modelDescription.xml", name)):
                info = zipfile.ZipInfo(file, date_time=EPOCH)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                archive.writestr(info, files[file])
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
