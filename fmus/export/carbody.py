"""The FMU of a carbody that is made of modal data."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterable
from pathlib import Path

import platformdirs

from .. import catalogue
from ..carbody.experiment import reference
from ..carbody.modal import ModalCarbody
from ..carbody.modal_data import ModalData
from ..carbody.modal_files import IN_FMU, as_text
from ..names import identifier
from .build import build_products
from .product import Product


def build_carbody(
    data: ModalData, out: Path, fmi: str = "2.0", platforms: Iterable[str] = ("host",)
) -> Path:
    """Write the FMU of the data to the file `out`, and return its path.

    The data travel in it. platforms: names of compiler.TARGETS, `host` or `all`. Raises
    CompileError, ParameterError for data that make no carbody, OSError for a place that cannot be
    written.
    """
    product = carbody_product(data, identifier(out.stem, "carbody"))
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as folder:
        (built,) = build_products(Path(folder), [product], platforms, [fmi]).values()
        built.replace(out)
    return out


def carbody_fmu(data: ModalData) -> Path:
    """The FMU of the data for FMI 2.0 and this machine, built once and kept in the user's cache."""
    text = catalogue.source_hash() + as_text(data)
    folder = platformdirs.user_cache_path("tracktrain") / "carbodies"
    digest = hashlib.sha256(text.encode()).hexdigest()[:16]
    out = folder / digest / f"{identifier(data.name, 'carbody')}.fmu"
    if not out.exists():
        with catalogue.announce(f"building the FMU of the carbody {data.name}, once"):
            build_carbody(data, out)
    return out


def carbody_product(data: ModalData, name: str) -> Product:
    """A block of this name with the numbers, the known results and the file of the data."""
    block = ModalCarbody(data, name)
    further = {IN_FMU: as_text(data).encode()}
    return Product(block, block.given, reference(name, data), further)
