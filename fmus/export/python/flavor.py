"""The Python flavour of a block: its CasADi sources, evaluated by CasADi's virtual machine."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from ... import BLOCKS
from ...carbody.modal_data import ModalData
from ...carbody.modal_files import as_text
from ...carbody.stored import BESIDE, stored
from ...describe.block import Block
from ...names import identifier
from ...python.twin_model import TwinModel
from ..accompanying import accompanying_files
from ..carbody import carbody_product
from ..dependencies import dependencies, initial_dependencies
from ..product import Product, shipped
from ..xml.description import OURS
from ..xml.fmi2 import described
from .assembly import Recipe, write
from .sources import FMUS, Sources


def build_python(name: str, out: Path, platforms: Iterable[str] = ("host",)) -> Path:
    """Write NAME_python.fmu of a block into the folder and return its path.

    It holds the binaries of all the platforms: names of compiler.TARGETS, `host` or `all`.
    """
    kind, module = BLOCKS[name], f"fmus.{name}.block"
    sources = _sources(module)
    sources.add_data(FMUS / name, f"fmus/{name}", "*")
    recipe = _recipe(f"{name}_python", sources, module, kind.__name__, shipped(name))
    return _packed(out, recipe, kind, shipped(name), platforms)


def build_python_carbody(data: ModalData, out: Path, platforms: Iterable[str] = ("host",)) -> Path:
    """Write the Python FMU of a carbody of modal data to the file `out` and return its path."""
    name = identifier(out.stem, "carbody")
    product, module = carbody_product(data, name), stored.__module__
    sources = _sources(module)
    sources.files[f"fmus/carbody/{BESIDE}"] = as_text(data).encode()
    recipe = _recipe(product.block.name, sources, module, stored.__name__, product)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as folder:
        _packed(Path(folder), recipe, lambda: product.block, product, platforms).replace(out)
    return out


def _sources(module: str) -> Sources:
    sources = Sources()
    for needed in ("fmus.python.slave", "fmus.python.twin_model", module):
        sources.add(needed)
    return sources


def _recipe(identifier: str, sources: Sources, module: str, kind: str, product: Product) -> Recipe:
    return Recipe(
        identifier,
        sources,
        module=module,
        model=kind,
        create=f"TwinModel({kind}, self.start_values)",
        start=product.parameters.values(product.block),
        imports={"fmus.python.twin_model": "TwinModel"},
    )


def _packed(
    out: Path,
    recipe: Recipe,
    kind: Callable[[], Block],
    product: Product,
    platforms: Iterable[str],
) -> Path:
    """The archive of a block whose twin the recipe makes."""
    block, start = product.block, recipe.start
    outputs = {v.name for v in block.outputs}
    now, at_start = (
        {
            name: [k for k in known if k not in outputs]
            for name, known in on.items()
            if name in outputs
        }
        for on in (dependencies(block), initial_dependencies(block))
    )
    model = TwinModel(kind, start)
    description = described(model, start, OURS, [recipe.interface], now, at_start)
    out.mkdir(parents=True, exist_ok=True)
    files = accompanying_files(product, start, description)
    return write(out, recipe, description, files, platforms)
