"""The FMU of a carbody that is made of modal data."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path

from ..carbody.experiment import reference
from ..carbody.modal import ModalCarbody
from ..carbody.modal_data import ModalData
from ..carbody.modal_files import IN_FMU, as_text
from ..names import identifier
from .product import Product
from .single import build_single, kept


def build_carbody(
    data: ModalData, out: Path, fmi: str = "2.0", platforms: Iterable[str] = ("host",)
) -> Path:
    """Write the FMU of the data to the file `out`, and return its path.

    The data travel in it. platforms: names of compiler.TARGETS, `host` or `all`. Raises
    CompileError, ParameterError for data that make no carbody, OSError for a place that cannot be
    written.
    """
    product = carbody_product(data, identifier(out.stem, "carbody"))
    return build_single(product, out, fmi, platforms)


def carbody_fmu(data: ModalData) -> Path:
    """The FMU of the data for FMI 2.0 and this machine, built once and kept in the user's cache."""
    return kept("carbodies", "carbody", data.name, as_text(data), partial(build_carbody, data))


def carbody_product(data: ModalData, name: str) -> Product:
    """A block of this name with the numbers, the known results and the file of the data."""
    block = ModalCarbody(data, name)
    further = {IN_FMU: as_text(data).encode()}
    return Product(block, block.given, reference(name, data), further)
