"""Where the files of a system are: archives unpacked, variants chosen, references followed."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote, urlsplit

from ..errors import SspError, choices
from ..fmu.archive import open_archive
from ..fmu.read import open_fmu
from ..fmu.units import BaseUnit
from .xml import Node, check, parse

DEFAULT = "SystemStructure.ssd"
"""The variant of an archive that is meant where none is named."""

_UNPACKED: list[tempfile.TemporaryDirectory[str]] = []
"""Folders with the contents of archives; they go when the program ends."""


@dataclass(frozen=True)
class Document:
    """A system structure description (.ssd) in the folder that its references may not leave.

    kept: where archives inside are unpacked for good; None unpacks them until the program ends.
    """

    path: Path
    folder: Path
    label: str
    node: Node
    kept: Path | None = None

    @cached_property
    def units(self) -> Mapping[str, BaseUnit]:
        return unit_definitions(self.node)

    def place(self, uri: str, wanted: str) -> tuple[Path, str]:
        """File and fragment of a reference; raises SspError unless it is a file of this package."""
        parts = urlsplit(uri)
        if parts.scheme or parts.netloc:
            self.node.fail(
                f"the source '{uri}' of {wanted} is an absolute URI; files are found relative to "
                "the .ssd only"
            )
        path = (self.path.parent / unquote(parts.path)).resolve()
        if not path.is_relative_to(self.folder):
            self.node.fail(f"the source '{uri}' of {wanted} lies outside of the package")
        if not path.is_file():
            inside = (p for p in self.folder.rglob("*" + path.suffix) if p.is_file())
            names = sorted(p.relative_to(self.path.parent).as_posix() for p in inside)
            self.node.fail(
                f"the source '{uri}' of {wanted} is not there; {choices(unquote(uri), names)}"
            )
        return path, unquote(parts.fragment)

    def inner(self, place: Path, variant: str | None) -> Document:
        """The description that is meant by a file of this package."""
        kept = self.kept and self.kept / "inside" / place.relative_to(self.folder)
        return open_document(place, variant, kept)[0]

    def part(
        self, node: Node, inline: Node | None, root: str, wanted: str, fmu: Path | None = None
    ) -> Node:
        """What a binding, map or dictionary refers to by its `source`, or else holds inline.

        root: the name that it begins with. fmu: the component that a source may be inside of.
        """
        if node.has("source"):
            return parse(*self._content(node, wanted, fmu), root)
        found = inline.find(root) if inline else None
        if found is None:
            self.node.fail(f"{wanted} has neither a source nor a <{root}> in it")
        found = replace(found, file=self.label)
        check(found, root, self.node.get("version"))
        return found

    def _content(self, node: Node, wanted: str, component: Path | None) -> tuple[bytes, str]:
        uri = node.get("source")
        if node.get("sourceBase", "SSD") == "SSD":
            path, _ = self.place(uri, wanted)
            return path.read_bytes(), f"{self.label}: {uri}"
        if component is None:
            self.node.fail(f"{wanted} has a source inside of a component, but belongs to none")
        if unquote(uri) not in open_fmu(component).members:
            self.node.fail(f"the source '{uri}' of {wanted} is not in '{component.name}'")
        with open_archive(component) as archive:
            return archive.read(unquote(uri)), f"{self.label}: {component.name}: {uri}"


def unit_definitions(root: Node) -> Mapping[str, BaseUnit]:
    """The units that a file defines, by name."""
    names = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    return {
        unit.need("name"): BaseUnit(
            {name: int(base.number(name, 0.0)) for name in names},
            base.number("factor", 1.0),
            base.number("offset", 0.0),
        )
        for unit in root.all("Units", "Unit")
        if (base := unit.find("BaseUnit"))
    }


def open_document(
    path: Path, variant: str | None = None, kept: Path | None = None
) -> tuple[Document, list[str]]:
    """The system of an .ssp or .ssd file, and the other variants that the archive holds.

    variant: file name, or the name that the description gives itself. kept: folder to unpack into
    for good. Raises SspError.
    """
    if not path.exists():
        raise SspError(f"the system '{path}' cannot be read: no such file or directory")
    if path.suffix.lower() == ".ssd":
        if variant is not None:
            raise SspError(f"'{path}' is one description; a variant is chosen of an .ssp archive")
        return _document(path.resolve(), path.parent.resolve(), str(path), kept), []
    folder = _unpack(path, kept)
    found = {
        file.name: _document(file, folder, f"{path}: {file.name}", kept)
        for file in sorted(folder.glob("*.ssd"))
    }
    if not found:
        raise SspError(f"'{path}' is no SSP archive: it has no {DEFAULT}")
    chosen = _variant(path, found, variant)
    others = [name for name, document in found.items() if document is not chosen]
    return chosen, others


def _variant(path: Path, found: Mapping[str, Document], wanted: str | None) -> Document:
    if wanted is None:
        if DEFAULT not in found and len(found) > 1:
            raise SspError(f"'{path}' has no {DEFAULT}; {choices(DEFAULT, found)}")
        return found.get(DEFAULT) or next(iter(found.values()))
    for file, document in found.items():
        if wanted in (file, file.removesuffix(".ssd"), document.node.get("name")):
            return document
    raise SspError(f"'{path}' has no variant '{wanted}'; {choices(wanted, found)}")


def _document(path: Path, folder: Path, label: str, kept: Path | None) -> Document:
    root = parse(path.read_bytes(), label, "SystemStructureDescription")
    return Document(path, folder, label, root, kept)


def _unpack(path: Path, kept: Path | None) -> Path:
    with open_archive(path) as archive:
        if kept is None:
            temporary = tempfile.TemporaryDirectory(
                prefix="tracktrain-ssp-", ignore_cleanup_errors=True
            )
            _UNPACKED.append(temporary)
            kept = Path(temporary.name)
        archive.extract(archive.members, kept)
    return kept.resolve()
