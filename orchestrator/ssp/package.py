"""Where the files of a system are: archives unpacked, variants chosen, references followed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from urllib.parse import unquote, urlsplit

from ..errors import OrchestratorError, SspError, choices
from ..fmu.archive import Archive, allowed, check_file, open_archive, read_file, shown_size
from ..fmu.read import open_fmu
from ..fmu.units import BaseUnit
from .xml import Node, check, parse

DEFAULT = "SystemStructure.ssd"
"""The variant of an archive that is meant where none is named."""

_UNPACKED: list[tempfile.TemporaryDirectory[str]] = []
"""Folders with the contents of archives; they go when the program ends."""


NAMED = 1000
"""Files among which one is looked for whose name is like that of a file that is not there."""


@dataclass
class Unpacked:
    """What of an archive, and of those inside of it, has been unpacked.

    outermost: the archive, beside which all others count. places: folders by the archives.
    kept: where to unpack for good; None unpacks until the program ends.
    """

    outermost: Path
    kept: Path | None = None
    size: int = 0
    places: dict[Path, Path] = field(default_factory=dict)

    def folder(self, path: Path) -> Path:
        """The folder with what an archive holds; raises ArchiveError or SspError."""
        if path not in self.places:
            with open_archive(path) as archive:
                self._take(archive)
                folder = self._new_folder()
                archive.extract(archive.members, folder)
            self.places[path] = folder.resolve()
        return self.places[path]

    def _take(self, archive: Archive) -> None:
        self.size += archive.size
        limit = allowed(self.outermost.stat().st_size)
        if self.size > limit:
            raise SspError(
                f"'{self.outermost}' and the archives in it, '{archive.path.name}' the last, would "
                f"unpack to {shown_size(self.size)} or more; at most {shown_size(limit)} are "
                "accepted: unpack what you trust by hand, and run its .ssd"
            )

    def _new_folder(self) -> Path:
        if self.kept is None:
            temporary = tempfile.TemporaryDirectory(
                prefix="tracktrain-ssp-", ignore_cleanup_errors=True
            )
            _UNPACKED.append(temporary)
            return Path(temporary.name)
        inside = len(self.places)
        return self.kept / "inside" / str(inside) if inside else self.kept


@dataclass(frozen=True)
class Document:
    """A system structure description (.ssd), and what its references may lead to.

    folder: that they may not leave; None for a description that stands in no archive.
    """

    path: Path
    folder: Path | None
    label: str
    node: Node
    unpacked: Unpacked

    @cached_property
    def units(self) -> Mapping[str, BaseUnit]:
        return unit_definitions(self.node)

    def place(self, uri: str, wanted: str) -> tuple[Path, str]:
        """File and fragment of a reference; raises SspError unless it is a file of this package."""
        source = f"the source '{uri}' of {wanted}"
        try:
            parts = urlsplit(uri)
            path = (self.path.parent / unquote(parts.path, errors="strict")).resolve()
            is_there = path.is_file()
        except (ValueError, OSError) as error:  # also text that is not UTF-8, and a zero byte
            self.node.fail(f"{source} is no relative URI of a file: {error}")
        if parts.scheme or parts.netloc or parts.path.startswith("/"):
            self.node.fail(
                f"{source} is an absolute URI; files are found relative to the .ssd only"
            )
        if self.folder is not None and not path.is_relative_to(self.folder):
            self.node.fail(f"{source} lies outside of the package")
        if not is_there:
            around = self.folder or self.path.parent
            inside = islice((p for p in around.rglob("*" + path.suffix) if p.is_file()), NAMED)
            names = sorted(Path(os.path.relpath(p, self.path.parent)).as_posix() for p in inside)
            self.node.fail(f"{source} is not there; {choices(unquote(uri), names)}")
        return path, unquote(parts.fragment)

    def inner(self, place: Path, variant: str | None) -> Document:
        """The description that is meant by a file that a reference leads to."""
        label = f"{self.label}: {os.path.relpath(place, self.path.parent)}"
        if place.suffix.lower() == ".ssd":
            return _description(place, self.folder, label, variant, self.unpacked)
        return _of_archive(place, label, variant, self.unpacked)[0]

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
            return read_file(path, "file"), f"{self.label}: {uri}"
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
            {name: base.whole(name, 0) for name in names},
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
    for good. Raises SspError or ArchiveError.
    """
    check_file(path, "system")
    unpacked = Unpacked(path, kept)
    if path.suffix.lower() == ".ssd":
        return _description(path, None, str(path), variant, unpacked), []
    return _of_archive(path, str(path), variant, unpacked)


def _description(
    path: Path, folder: Path | None, label: str, variant: str | None, unpacked: Unpacked
) -> Document:
    if variant is not None:
        raise SspError(f"'{label}' is one description; a variant is chosen of an .ssp archive")
    return _document(path.resolve(), folder, label, unpacked)


def _of_archive(
    path: Path, label: str, variant: str | None, unpacked: Unpacked
) -> tuple[Document, list[str]]:
    """The variant of an archive that is meant, which alone has to be sound, and the others."""
    folder = unpacked.folder(path)
    files = {file.name: file for file in sorted(folder.glob("*.ssd")) if file.is_file()}

    def document(name: str) -> Document:
        return _document(files[name], folder, f"{label}: {name}", unpacked)

    if not files:
        raise SspError(f"'{label}' is no SSP archive: it has no {DEFAULT}")
    if variant is None and DEFAULT not in files and len(files) > 1:
        raise SspError(f"'{label}' has no {DEFAULT}; {choices(DEFAULT, files)}")
    usual = DEFAULT if DEFAULT in files else next(iter(files))
    chosen = usual if variant is None else next((n for n in files if variant == Path(n).stem), "")
    chosen = variant if variant in files else chosen
    if chosen:
        return document(chosen), [name for name in files if name != chosen]
    broken = []
    for name in files:
        try:
            found = document(name)
        except OrchestratorError as error:
            broken.append(str(error))
            continue
        if found.node.get("name") == variant:
            return found, [other for other in files if other != name]
    raise SspError(
        "; ".join(
            [f"'{label}' has no variant '{variant}'; {choices(str(variant), files)}", *broken]
        )
    )


def _document(path: Path, folder: Path | None, label: str, unpacked: Unpacked) -> Document:
    root = parse(read_file(path, "system"), label, "SystemStructureDescription")
    return Document(path, folder, label, root, unpacked)
