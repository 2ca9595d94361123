"""One FMU of a block with data of its own: written to a file, or kept in the user's cache."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import platformdirs

from .. import catalogue
from ..names import identifier
from .build import build_products
from .product import Product


def build_single(product: Product, out: Path, fmi: str, platforms: Iterable[str]) -> Path:
    """Write the FMU of a product to the file `out`, and return its path.

    platforms: names of compiler.TARGETS, `host` or `all`. Raises CompileError, or OSError for a
    place that cannot be written.
    """
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as folder:
        (built,) = build_products(Path(folder), [product], platforms, [fmi]).values()
        built.replace(out)
    return out


def kept(place: str, kind: str, name: str, text: str, build: Callable[[Path], Path]) -> Path:
    """The FMU of data, built once for this machine and kept in the user's cache.

    place: its folder there. kind: of block, such as "carbody". name, text: of the data. build:
    writes it to a path.
    """
    digest = hashlib.sha256((catalogue.source_hash() + text).encode()).hexdigest()[:16]
    folder = platformdirs.user_cache_path("tracktrain") / place / digest
    out = folder / f"{identifier(name, kind)}.fmu"
    if not out.exists():
        with catalogue.announce(f"building the FMU of the {kind} {name}, once"):
            build(out)
    return out
