"""A model in plain Python, in a file of its own, becomes an FMU."""

from __future__ import annotations

import hashlib
import importlib
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from ... import model
from ...describe import variables
from ...model import Model
from ..documentation import documentation
from ..xml.description import TOOL
from ..xml.fmi2 import described
from .assembly import Recipe, write
from .check import check
from .sources import PackError, Sources


def pack(project: Path, out: Path, platforms: Iterable[str] = ("host",)) -> Path:
    """Write NAME.fmu of the model in NAME.py, or in the folder NAME, and return its path.

    platforms: those whose binaries it holds, as for the blocks.
    Modules and a folder `data` beside the model travel along. Raises PackError, which says what to
    change, for a model whose declarations are not true.
    """
    file = _model_file(project)
    sources = Sources(project=file.parent)
    for needed in ("fmus.python.slave", "fmus.model", file.stem):
        sources.add(needed)
    sources.add_data(file.parent / "data", "data")
    with _imported(sources, file) as module:
        kind = _model_class(module, file)
        one = kind()
        check(one)
        start = one.start_values()[0]
        recipe = Recipe(
            file.stem, sources, file.stem, kind.__name__, f"{kind.__name__}()", start, {}
        )
        now = {v.name: one.feedthrough.get(v.name, ()) for v in one.outputs}
        has_start = kind.start is not Model.start
        at_start = {
            name: [*start, *((v.name for v in one.inputs) if has_start else inputs)]
            for name, inputs in now.items()
        }
        said = {"author": one.author, "license": one.license, "generationTool": TOOL}
        head = {key: text for key, text in said.items() if text}
        description = described(one, start, head, [recipe.interface], now, at_start)
        page = documentation(one, None, start, file.with_name("README.md"), description)
    out.mkdir(parents=True, exist_ok=True)
    files = {"documentation/index.html": page.encode()}
    return write(out, recipe, description, files, platforms)


def _model_file(project: Path) -> Path:
    file = project / f"{project.resolve().name}.py" if project.is_dir() else project
    if file.suffix != ".py" or not file.is_file():
        raise PackError(
            f"there is no model '{file}'; name the model's Python file, or the folder with the "
            "file of the same name, such as tracktrain new makes"
        )
    if not file.stem.isidentifier() or file.stem in ("fmus", "data", "__init__"):
        raise PackError(f"a model cannot be called '{file.stem}'; rename {file}")
    return file.resolve()


@contextmanager
def _imported(sources: Sources, file: Path) -> Iterator[ModuleType]:
    """Import the model from its FMU's package, so that a file that does not travel is missed."""
    digest = hashlib.sha256(repr(sorted(sources.files.items())).encode()).hexdigest()
    package = f"packed_{digest[:12]}"
    with tempfile.TemporaryDirectory() as temporary:
        for place, content in sources.files.items():
            path = Path(temporary, package, place)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        sys.path.insert(0, temporary)
        for own in (model, variables):  # so that its declarations are of our classes
            sys.modules[f"{package}.{own.__name__}"] = own
        try:
            yield importlib.import_module(f"{package}.{file.stem}")
        except PackError:
            raise
        except Exception as error:
            raise PackError(
                f"{file} cannot be imported: {type(error).__name__}: {error}"
            ) from error
        finally:
            sys.path.remove(temporary)
            for name in [n for n in sys.modules if n.partition(".")[0] == package]:
                del sys.modules[name]


def _model_class(module: ModuleType, file: Path) -> type[Model]:
    kinds = [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, Model)
        and value.__module__ == module.__name__
    ]
    if len(kinds) != 1:
        names = ", ".join(kind.__name__ for kind in kinds) or "none"
        raise PackError(
            f"{file} has to define one class derived from fmus.model.Model; found {names}"
        )
    return kinds[0]
