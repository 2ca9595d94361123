"""Builds FMUs: the files of each archive, compiled, zipped, the same bytes on every build."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

from .. import BLOCKS
from ..names import FMI_VERSIONS, SUFFIX
from . import code
from .accompanying import accompanying_files
from .archive import NO_GUID, guid, write_archive
from .compiler import FLAGS, Target, compile_library, targets
from .product import Product, shipped
from .xml import fmi2, fmi3
from .xml.build_description import build_description

DESCRIPTIONS = {"2.0": fmi2.model_description, "3.0": fmi3.model_description}


@dataclass(frozen=True)
class Contents:
    """What an FMU holds apart from its binaries: files by their place, and C files by name.

    units: those of the C files that are compiled, with what flags.
    """

    block: str
    fmi: str
    files: Mapping[str, bytes]
    sources: Mapping[str, str]
    units: Sequence[str]
    flags: Sequence[str] = FLAGS


def build(
    out: Path,
    names: Iterable[str] | None = None,
    platforms: Iterable[str] = ("host",),
    fmi: Iterable[str] = FMI_VERSIONS,
) -> dict[str, Path]:
    """Write the FMUs of each block into the folder; their paths by name (truck, truck_fmi3).

    Each holds the binaries of all the platforms: names of compiler.TARGETS, `host` or `all`.
    Raises CompileError, or OSError for a folder that cannot be written.
    """
    return build_products(out, [shipped(name) for name in names or BLOCKS], platforms, fmi)


def build_products(
    out: Path,
    products: Iterable[Product],
    platforms: Iterable[str] = ("host",),
    fmi: Iterable[str] = FMI_VERSIONS,
) -> dict[str, Path]:
    """The same for blocks with numbers of their own; the file is named as the block is."""
    chosen, versions = targets(platforms), tuple(fmi)
    out.mkdir(parents=True, exist_ok=True)
    prepared = [contents(product, versions) for product in products]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        built = pool.map(lambda of_block: write(of_block, out, chosen), prepared)
        return {path.stem: path for paths in built for path in paths}


def contents(product: Product, versions: Iterable[str]) -> list[Contents]:
    """The block's FMUs for the versions of FMI, before they are compiled."""
    block = product.block
    start = product.parameters.values(block)
    found = []
    for fmi in versions:
        xml = DESCRIPTIONS[fmi](block, start)
        sources = code.sources(block, start, fmi, NO_GUID)
        files = accompanying_files(product, start, xml)
        found.append(
            identified(Contents(block.name, fmi, files, sources, code.unit_files(fmi)), xml)
        )
    return found


def identified(fmu: Contents, description: str) -> Contents:
    """The same with its description, how it is compiled, and a GUID wherever that belongs."""
    own = _guid(description, fmu)
    options = " ".join(flag for flag in fmu.flags if flag not in FLAGS)
    texts = {
        "modelDescription.xml": description.replace(NO_GUID, own),
        "sources/buildDescription.xml": build_description(fmu.block, fmu.units, options),
    }
    return replace(
        fmu,
        files={**fmu.files, **{place: text.encode() for place, text in texts.items()}},
        sources={name: text.replace(NO_GUID, own) for name, text in fmu.sources.items()},
    )


def _guid(description: str, fmu: Contents) -> str:
    """A GUID that changes with the description, the sources or the compiler's flags."""
    digest = hashlib.sha256(description.encode())
    for name, text in sorted(fmu.sources.items()):
        digest.update(name.encode() + b"\0" + text.encode())
    digest.update(" ".join(fmu.flags).encode())
    return guid(digest.hexdigest())


def write(of_block: Iterable[Contents], out: Path, platforms: Iterable[Target]) -> list[Path]:
    """Compile and zip the FMUs of one block into a folder; their paths."""
    paths = []
    # One folder for both versions: zig compiles only what has been written anew.
    with tempfile.TemporaryDirectory() as folder:
        for fmu in of_block:
            files = {f"sources/{name}": text.encode() for name, text in fmu.sources.items()}
            files |= fmu.files
            files |= _binaries(fmu, Path(folder), platforms)
            paths.append(out / f"{fmu.block}{SUFFIX[fmu.fmi]}.fmu")
            write_archive(paths[-1], files)
    return paths


def _binaries(fmu: Contents, folder: Path, platforms: Iterable[Target]) -> dict[str, bytes]:
    """The library of each platform by its place in the archive."""
    for name, text in fmu.sources.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.exists() or file.read_text() != text:
            file.write_text(text)
    units = [folder / name for name in fmu.units]

    def compiled(target: Target) -> tuple[str, bytes]:
        place = f"binaries/{target.folder(fmu.fmi)}/{fmu.block}{target.suffix}"
        library = folder / place
        library.parent.mkdir(parents=True, exist_ok=True)
        compile_library(units, library, target, fmu.flags)
        return place, library.read_bytes()

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(pool.map(compiled, platforms))
