"""The one place that opens zip archives (FMUs, SSPs): nothing in them is trusted."""

from __future__ import annotations

import re
import stat
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree
from xml.parsers import expat

from ..errors import ArchiveError

MEMBERS = 50_000
"""An archive with more members is refused: no FMU has that many files."""

SIZE = 4 * 2**30
"""Unpacked, an archive may take this many bytes."""

RATIO, UNSUSPICIOUS = 200, 64 * 2**20
"""Beyond so many bytes unpacked, an archive may grow by this factor at most."""

XML_SIZE, XML_DEPTH = 256 * 2**20, 100
"""Bytes of an XML file, and how deep its elements may be nested."""

_UNREADABLE = (zipfile.BadZipFile, zlib.error, OSError, RuntimeError, NotImplementedError, EOFError)


class Archive:
    """A zip archive whose members have been looked at: none reaches out of it or swells."""

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self.path, self._archive = path, archive
        self.members = tuple(info.filename for info in archive.infolist())
        _check(path, archive.infolist())

    def read(self, member: str) -> bytes:
        """A member's bytes; raises ArchiveError."""
        try:
            return self._archive.read(member)
        except KeyError:
            raise ArchiveError(f"'{self.path}' has no {member}") from None
        except _UNREADABLE as error:
            raise ArchiveError(
                f"'{self.path}' has a {member} that cannot be read: {error}"
            ) from None

    def xml(self, member: str) -> ElementTree.Element:
        """Root of an XML member without a document type; raises ArchiveError."""
        if member in self.members and self._archive.getinfo(member).file_size > XML_SIZE:
            size = self._archive.getinfo(member).file_size
            raise ArchiveError(
                f"'{self.path}' has a {member} of {_size(size)}; at most {_size(XML_SIZE)} are read"
            )
        return parse_xml(self.read(member), f"'{self.path}' has a {member}")

    def extract(self, members: Iterable[str], folder: Path) -> None:
        """Unpack members into a folder; raises ArchiveError."""
        for member in members:
            try:
                self._archive.extract(member, folder)
            except _UNREADABLE as error:
                raise ArchiveError(
                    f"'{member}' of '{self.path}' cannot be unpacked into '{folder}': {error}"
                ) from None


@contextmanager
def open_archive(path: Path) -> Iterator[Archive]:
    """Open an archive; raises ArchiveError for one that is damaged, or not safe to unpack."""
    try:
        archive = zipfile.ZipFile(path)
    except _UNREADABLE as error:
        raise ArchiveError(f"'{path}' cannot be opened as a zip archive: {error}") from None
    with archive:
        yield Archive(path, archive)


def parse_xml(text: bytes, name: str) -> ElementTree.Element:
    """Root of an XML document without a document type; `name` begins the ArchiveError."""
    try:
        _look_at_xml(text, name)
        return ElementTree.fromstring(text)
    except (expat.ExpatError, ElementTree.ParseError, LookupError, ValueError) as error:
        raise ArchiveError(f"{name} that cannot be read: {error}") from None


def _check(path: Path, infos: list[zipfile.ZipInfo]) -> None:
    if len(infos) > MEMBERS:
        raise ArchiveError(f"'{path}' holds {len(infos)} members; at most {MEMBERS} are accepted")
    seen: set[PurePosixPath] = set()
    for info in infos:
        name = PurePosixPath(info.filename)
        problem = _outside(info.orig_filename) or _unusable(info)
        if name in seen:
            problem = "which is there twice"
        if problem:
            raise ArchiveError(f"'{path}' holds '{info.orig_filename}', {problem}")
        seen.add(name)
    packed = sum(info.compress_size for info in infos)
    if packed > path.stat().st_size:
        raise ArchiveError(f"'{path}' holds members that overlap: it is no archive but a trap")
    size = sum(info.file_size for info in infos)
    largest = max(infos, key=lambda info: info.file_size, default=None)
    if largest is not None and (size > SIZE or size > max(UNSUSPICIOUS, RATIO * packed)):
        limit = min(SIZE, max(UNSUSPICIOUS, RATIO * packed))
        raise ArchiveError(
            f"'{path}' of {_size(packed)} would unpack to {_size(size)} ('{largest.filename}' "
            f"alone to {_size(largest.file_size)}); at most {_size(limit)} are accepted"
        )


def _outside(name: str) -> str:
    if name.startswith("/") or re.match(r"[A-Za-z]:", name):
        return "which is an absolute path"
    if ".." in PurePosixPath(name).parts or "\\" in name:
        return "which lies outside of the archive"
    if re.search(r"[\x00-\x1f]", name):
        return "whose name has characters that cannot be printed"
    return ""


def _unusable(info: zipfile.ZipInfo) -> str:
    if info.flag_bits & 1:
        return "which is encrypted"
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return "which is a link"
    if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "which is neither a file nor a folder"
    return ""


def _look_at_xml(text: bytes, name: str) -> None:
    """Refuse what is unsafe for any parser: a document type, which brings entities, and depth."""
    depth = 0

    def doctype(*_: object) -> None:
        raise ArchiveError(
            f"{name} that declares a document type, which may hold entities; remove <!DOCTYPE ...>"
        )

    def start(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > XML_DEPTH:
            raise ArchiveError(f"{name} that nests its elements deeper than {XML_DEPTH}")

    def end(_: str) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(text, True)


def _size(size: float) -> str:
    for unit in ("bytes", "kB", "MB"):
        if size < 1024:
            return f"{size:.0f} {unit}"
        size /= 1024
    return f"{size:.1f} GB"
