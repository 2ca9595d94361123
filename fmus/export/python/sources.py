"""The Python sources of an FMU: a module and all that it imports, as one package of their own.

All FMUs in a process share one table of modules, so that two files of the same name would be one.
Hence a package under a name that no other FMU has. Inside it imports are relative; an import from
`fmus` or a file beside a user's model becomes so, and its file travels along.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ...errors import FmusError

FMUS = Path(__file__).parents[2]
ROOTS = {"fmus": FMUS}
"""Packages whose modules travel one by one, without what their `__init__` imports."""

DATA = (".csv", ".json", ".md", ".npy", ".toml", ".txt")


class PackError(FmusError):
    """A model that cannot become an FMU; the message says what to change."""


@dataclass
class Sources:
    """Files of the package by their place in it, and packages that have to be installed.

    project: folder of a user's model, whose modules may travel, too.
    """

    project: Path | None = None
    files: dict[str, bytes] = field(default_factory=dict)
    installed: set[str] = field(default_factory=set)

    def add(self, module: str) -> None:
        """Take a module such as `fmus.truck.block`, the packages it is in, and what they import."""
        parts = module.split(".")
        for depth in range(1, len(parts) + 1):
            name = ".".join(parts[:depth])
            if name in ROOTS:
                self.files[f"{name}/__init__.py"] = f'"""Part of {name}."""\n'.encode()
            else:
                self._add_file(name)

    def add_data(self, folder: Path, place: str, pattern: str = "**/*") -> None:
        """Take the data and the documentation of a folder."""
        for path in sorted(folder.glob(pattern)):
            if path.suffix in DATA:
                self.files[f"{place}/{path.relative_to(folder).as_posix()}"] = path.read_bytes()

    def _add_file(self, module: str) -> None:
        path = self._file(module)
        assert path is not None
        is_package = path.name == "__init__.py"
        place = module.replace(".", "/") + ("/__init__.py" if is_package else ".py")
        if place in self.files:
            return
        self.files[place] = b""  # modules may import each other
        text = path.read_text(encoding="utf-8")
        try:
            tree = ast.parse(text)
        except SyntaxError as error:
            raise PackError(f"{path}, line {error.lineno}: {error.msg}") from None
        lines = text.splitlines(keepends=True)
        package = module.split(".")[: None if is_package else -1]
        for node in _imports(tree):
            place_of = f"{path}, line {node.lineno}"
            if isinstance(node, ast.ImportFrom):
                self._follow(node, package, lines, place_of)
            else:
                self._follow_whole(node, package, lines, place_of)
        self.files[place] = "".join(lines).encode()

    def _file(self, module: str) -> Path | None:
        """File of a module that can travel, None for any other."""
        top, *inner = module.split(".")
        root = ROOTS.get(top, self.project and self.project / top)
        if root is None:
            return None
        base = root.joinpath(*inner)
        files = (base.with_name(f"{base.name}.py"), base / "__init__.py")
        return next((file for file in files if file.is_file()), None)

    def _follow(
        self, node: ast.ImportFrom, package: list[str], lines: list[str], place: str
    ) -> None:
        """`from module import name, ...`, where a name may be a module itself."""
        module = node.module or ""
        if node.level:
            outer = package[: len(package) - node.level + 1]
            module = ".".join([*outer, *filter(None, [module])])
        elif not self._file(module.split(".")[0]):
            return self._need(module)
        elif module in ROOTS:
            raise PackError(
                f"{place}: write 'from {module}.MODULE import ...', so that what it names travels "
                "with the FMU"
            )
        else:
            _make_relative(lines, node, f"from {module}", f"from {_dots(package)}{module}")
        self.add(module)
        for alias in node.names:
            if self._file(f"{module}.{alias.name}"):
                self.add(f"{module}.{alias.name}")
        return None

    def _follow_whole(
        self, node: ast.Import, package: list[str], lines: list[str], place: str
    ) -> None:
        """`import module, ...`."""
        for alias in node.names:
            name = alias.name
            if not self._file(name.split(".")[0]):
                self._need(name)
            elif "." in name or name in ROOTS or len(node.names) > 1:
                raise PackError(
                    f"{place}: 'import {name}' cannot travel with the FMU; "
                    f"write 'from {name} import ...'"
                )
            else:
                relative = f"from {_dots(package)} import {name}"
                _make_relative(lines, node, f"import {name}", relative)
                self.add(name)

    def _need(self, module: str) -> None:
        top = module.split(".")[0]
        if top not in sys.stdlib_module_names:
            self.installed.add(top)


def _dots(package: list[str]) -> str:
    return "." * (len(package) + 1)


def _make_relative(lines: list[str], node: ast.stmt, old: str, new: str) -> None:
    line, column = node.lineno - 1, node.col_offset
    lines[line] = lines[line][:column] + lines[line][column:].replace(old, new, 1)


def _imports(tree: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Import statements that run; what is for type checkers alone is left out."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            for other in node.orelse:
                yield from _imports(other)
        else:
            yield from _imports(node)
