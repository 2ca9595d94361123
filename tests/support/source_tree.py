"""The packages as files that import each other, read without importing them.

Imports inside functions and under TYPE_CHECKING count as all others do.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("fmus", "orchestrator", "structures", "tracktrain")


@dataclass(frozen=True)
class Import:
    module: str
    """The file's, if what is imported is a module, else that of the name."""
    name: str
    line: int
    hidden: bool
    """Inside a function."""


@dataclass(frozen=True)
class Source:
    """One Python file. module: its name with dots."""

    module: str
    path: Path

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.path.read_text(encoding="utf-8"))

    @property
    def place(self) -> str:
        return self.path.relative_to(ROOT).as_posix()

    def functions(self) -> Iterator[ast.FunctionDef]:
        return (node for node in ast.walk(self.tree) if isinstance(node, ast.FunctionDef))

    def imports(self) -> Iterator[Import]:
        """All of them, by absolute names."""
        hidden = {id(node) for function in self.functions() for node in ast.walk(function)}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    yield Import(alias.name, "", node.lineno, id(node) in hidden)
            elif isinstance(node, ast.ImportFrom):
                base = self._absolute(node)
                for alias in node.names:
                    inner = f"{base}.{alias.name}"
                    module = inner if inner in sources() else base
                    yield Import(module, alias.name, node.lineno, id(node) in hidden)

    def _absolute(self, node: ast.ImportFrom) -> str:
        if not node.level:
            return node.module or ""
        package = self.module.split(".")
        if self.path.name != "__init__.py":
            package.pop()
        package = package[: len(package) + 1 - node.level]
        return ".".join([*package, *([node.module] if node.module else [])])


@cache
def sources() -> dict[str, Source]:
    """By module: all of the packages' files but the templates, which belong to users."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            module = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            if "templates" not in parts:
                found[module] = Source(module, path)
    return found


def of(package: str) -> list[Source]:
    """The files of a package."""
    return [s for m, s in sources().items() if m.split(".")[0] == package]


def circle(package: str) -> list[str]:
    """Modules of a package that import each other in a circle, first and last the same."""
    graph = {
        source.module: {i.module for i in source.imports()} & sources().keys() - {source.module}
        for source in of(package)
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []
