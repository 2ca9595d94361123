"""The one place that opens zip archives and XML files (FMUs, SSPs): nothing in them is trusted."""

from __future__ import annotations

import errno
import lzma
import re
import stat
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree
from xml.parsers import expat

from ..errors import ArchiveError, printable

MEMBERS = 50_000
"""An archive with more members is refused: no FMU has that many files."""

SIZE = 4 * 2**30
"""Unpacked, an archive may take this many bytes."""

RATIO, UNSUSPICIOUS = 200, 64 * 2**20
"""Beyond so many bytes unpacked, an archive may grow by this factor at most."""

XML_SIZE, XML_DEPTH = 256 * 2**20, 100
"""Bytes of an XML file, and how deep its elements may be nested."""

NAME = 4096
"""Characters of a name, in an archive or in XML."""

NAMES = {
    "name", "modelIdentifier", "modelName", "guid", "instantiationToken", "unit", "displayUnit",
    "declaredType", "quantity", "source", "target", "prefix", "dictionary", "startElement",
    "endElement", "startConnector", "endConnector",
}  # fmt: skip
"""Attributes of XML that are names."""

_UNREADABLE = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, OSError, RuntimeError, NotImplementedError,
    EOFError, ValueError, struct.error, IndexError, OverflowError,
)  # fmt: skip


class Archive:
    """A zip archive whose members have been looked at: none reaches out of it or swells.

    Folders in the members' names are parted by strokes, also where the archive has backslashes.
    """

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self.path, self._archive = path, archive
        self._infos: dict[str, zipfile.ZipInfo] = {}
        for info in archive.infolist():
            info.filename = info.filename.replace("\\", "/")
            self._infos[info.filename] = info
        _check(path, archive.infolist())
        self.members = tuple(self._infos)
        self.size = sum(info.file_size for info in archive.infolist())

    def read(self, member: str) -> bytes:
        """A member's bytes; raises ArchiveError for one that is not there, damaged or huge."""
        if member not in self._infos:
            raise ArchiveError(f"'{self.path}' has no {member}")
        size = self._infos[member].file_size
        if size > XML_SIZE:
            raise ArchiveError(
                f"'{self.path}' has a {member} of {shown_size(size)}; at most "
                f"{shown_size(XML_SIZE)} are read"
            )
        try:
            return self._archive.read(self._infos[member])
        except _UNREADABLE as error:
            raise ArchiveError(
                f"'{self.path}' has a {member} that cannot be read: {error}"
            ) from None

    def xml(self, member: str) -> ElementTree.Element:
        """Root of an XML member without a document type; raises ArchiveError."""
        return parse_xml(self.read(member), f"'{self.path}' has a {member}")

    def extract(self, members: Iterable[str], folder: Path) -> None:
        """Unpack members into a folder; raises ArchiveError."""
        for member in members:
            try:
                self._archive.extract(self._infos[member], folder)
            except _UNREADABLE as error:
                full = isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)
                advice = (
                    "; make room there, or set TMPDIR to a folder that has some" if full else ""
                )
                raise ArchiveError(
                    f"'{member}' of '{self.path}' cannot be unpacked into '{folder}': {error}"
                    f"{advice}"
                ) from None


@contextmanager
def open_archive(path: Path) -> Iterator[Archive]:
    """Open an archive; raises ArchiveError for one that is damaged, or not safe to unpack."""
    check_file(path, "archive")
    try:
        archive = zipfile.ZipFile(path)
    except _UNREADABLE as error:
        raise ArchiveError(f"'{path}' cannot be opened as a zip archive: {error}") from None
    with archive:
        yield Archive(path, archive)


def check_file(path: Path, kind: str) -> None:
    """Raise ArchiveError for what is no file, such as a pipe or a device, which may never end.

    kind: what it should be, such as "FMU".
    """
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", "") or str(error)).lower()
        raise ArchiveError(f"the {kind} '{path}' cannot be read: {reason}") from None
    if stat.S_ISDIR(mode):
        raise ArchiveError(f"'{path}' is no {kind}: it is a folder")
    if not stat.S_ISREG(mode):
        raise ArchiveError(f"'{path}' is no {kind}: it is a pipe or a device")


def read_file(path: Path, kind: str) -> bytes:
    """A file of XML or the like, as bytes; raises ArchiveError for one that is none, or huge."""
    check_file(path, kind)
    if (size := path.stat().st_size) > XML_SIZE:
        raise ArchiveError(
            f"the {kind} '{path}' has {shown_size(size)}; at most {shown_size(XML_SIZE)} are read"
        )
    try:
        return path.read_bytes()
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ArchiveError(f"the {kind} '{path}' cannot be read: {reason}") from None


def parse_xml(text: bytes, name: str) -> ElementTree.Element:
    """Root of an XML document without a document type; `name` begins the ArchiveError.

    Attributes can be printed: see `plain` for what cannot.
    """
    try:
        _look_at_xml(text, name)
        root = ElementTree.fromstring(text)
    except (expat.ExpatError, ElementTree.ParseError, LookupError, ValueError) as error:
        raise ArchiveError(f"{name} that cannot be read: {error}") from None
    for element in root.iter():
        for attribute, value in element.attrib.items():
            if attribute in NAMES and len(value) > NAME:
                raise ArchiveError(
                    f"{name} with a {attribute} of {len(value)} characters, '{value[:40]}...'; at "
                    f"most {NAME} are read"
                )
            if not value.isprintable():
                element.set(attribute, printable(value))
    return root


def _check(path: Path, infos: list[zipfile.ZipInfo]) -> None:
    if len(infos) > MEMBERS:
        raise ArchiveError(f"'{path}' holds {len(infos)} members; at most {MEMBERS} are accepted")
    seen: dict[PurePosixPath, zipfile.ZipInfo] = {}
    for info in infos:
        name = PurePosixPath(info.filename)
        problem = _outside(info.orig_filename) or _unusable(info)
        if name in seen and not _same(info, seen[name]):
            problem = "which is there twice"
        if problem:
            raise ArchiveError(f"'{path}' holds '{info.orig_filename}', {problem}")
        seen[name] = info
    packed = sum(info.compress_size for info in infos)
    if packed > path.stat().st_size:
        raise ArchiveError(f"'{path}' holds members that overlap: it is no archive but a trap")
    size = sum(info.file_size for info in infos)
    largest = max(infos, key=lambda info: info.file_size, default=None)
    limit = allowed(packed)
    if largest is not None and size > limit:
        raise ArchiveError(
            f"'{path}' of {shown_size(packed)} would unpack to {shown_size(size)} "
            f"('{largest.filename}' alone to {shown_size(largest.file_size)}); at most "
            f"{shown_size(limit)} are accepted"
        )


def _same(one: zipfile.ZipInfo, other: zipfile.ZipInfo) -> bool:
    """Whether two entries are the same folder, or files of the same content."""
    folders = {one.is_dir(), other.is_dir()}
    content = (one.CRC, one.file_size) == (other.CRC, other.file_size)
    return folders == {True} or (folders == {False} and content)


def _outside(name: str) -> str:
    name = name.replace("\\", "/")
    if name.startswith("/") or re.match(r"[A-Za-z]:", name):
        return "which is an absolute path"
    if ".." in PurePosixPath(name).parts:
        return "which lies outside of the archive"
    if printable(name) != name or not name:
        return "whose name has characters that cannot be printed" if name else "without a name"
    return f"a name of {len(name)} characters" if len(name) > NAME else ""


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


def allowed(packed: int) -> int:
    """Bytes that an archive of so many may unpack to."""
    return min(SIZE, max(UNSUSPICIOUS, RATIO * packed))


def shown_size(size: float) -> str:
    """ "55 kB"."""
    for unit in ("bytes", "kB", "MB"):
        if size < 1024:
            return f"{size:.0f} {unit}"
        size /= 1024
    return f"{size:.1f} GB"
