"""The Python flavour of a block: its CasADi sources, evaluated by CasADi's virtual machine."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ... import BLOCKS
from ...describe.parameters import DEFAULT_SET, parameter_set
from ...python.twin_model import TwinModel
from ..accompanying import accompanying_files
from ..dependencies import dependencies, initial_dependencies
from ..product import shipped
from ..xml.description import OURS
from ..xml.fmi2 import described
from .assembly import Recipe, write
from .sources import FMUS, Sources


def build_python(name: str, out: Path, platforms: Iterable[str] = ("host",)) -> Path:
    """Write NAME_python.fmu of a block into the folder and return its path.

    It holds the binaries of all the platforms: names of compiler.TARGETS, `host` or `all`.
    """
    kind = BLOCKS[name]
    block = kind()
    parameters = parameter_set(DEFAULT_SET)
    start = parameters.values(block)
    sources = Sources()
    module = f"fmus.{name}"
    for needed in ("fmus.python.slave", "fmus.python.twin_model", module):
        sources.add(needed)
    sources.add_data(FMUS / name, f"fmus/{name}", "*")
    recipe = Recipe(
        f"{name}_python",
        sources,
        module=module,
        model=kind.__name__,
        create=f"TwinModel({kind.__name__}, self.start_values)",
        start=start,
        imports={"fmus.python.twin_model": "TwinModel"},
    )
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
    files = accompanying_files(shipped(name), start, description)
    return write(out, recipe, description, files, platforms)
