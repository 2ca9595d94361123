"""Files that are wrong on purpose: descriptions, archives and SSP files, mutated by rule."""

from __future__ import annotations

import copy
import io
import random
import stat
import struct
import warnings
import zipfile
from collections.abc import Iterator
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

LONG = 1_000_000
"""Characters of a name that is too long."""

VALUES = {
    "empty": "",
    "text": "seven",
    "negative": "-1",
    "fraction": "1.5",
    "huge": "99999999999999999999",
    "beyond doubles": "1e999",
    "nan": "NaN",
    "list": "1 2 x",
    "long": "n" * LONG,
    "controls": "a\x9b31mred\u202e\u2028b",
    "markup": "[red]a[/bold] %s %n {0}",
    "newline": "a\nb",
}
"""What stands where something else should."""

SOURCES = {
    "nul": "resources/a%00.fmu",
    "not utf-8": "resources/%ff%fe.fmu",
    "half an escape": "resources/%zz%.fmu",
    "bad host": "http://[::1/a.fmu",
    "remote": "https://localhost/a.fmu",
    "absolute": "file:///etc/passwd",
    "host": "//host/a.fmu",
    "root": "/etc/passwd",
    "upward": "../../etc/passwd",
    "upward, escaped": "%2e%2e/%2e%2e/etc/passwd",
    "windows": "C:\\a.fmu",
    "backslashes": "resources\\a.fmu",
    "folder": "resources/",
    "itself": ".",
    "empty": "",
    "fragment": "#nothing",
    "long": "a" * LONG,
    "many folders": "a/" * 3000 + "a.fmu",
    "controls": "a\x9b31m.fmu",
    "query": "resources/damper.fmu?x=1",
}
"""References that lead nowhere, or where they may not."""


def descriptions(text: str, each: int = 3) -> Iterator[tuple[str, bytes]]:
    """A document with each of its kinds of attributes and elements wrong in turn, by name.

    each: of so many ways an attribute is wrong.
    """
    root = ElementTree.fromstring(text)
    places = _places(root)
    chance = random.Random(1687)
    for (tag, attribute), path in places.items():
        for kind in chance.sample([*VALUES], each):
            yield f"{tag} {attribute} {kind}", _with(root, path, attribute, VALUES[kind])
        yield f"{tag} without {attribute}", _with(root, path, attribute, None)
    for tag, path in {tag: path for (tag, _), path in places.items() if path}.items():
        yield f"no {tag}", _pruned(root, path, 0)
        yield f"{tag} twice", _pruned(root, path, 2)


def texts(text: str) -> Iterator[tuple[str, bytes]]:
    """A document whose bytes are wrong, by name."""
    data = text.encode()
    yield "nothing", b""
    yield "no xml", b"hello"
    yield "other encoding", b'<?xml version="1.0" encoding="utf-7"?>' + data
    yield "unknown encoding", b'<?xml version="1.0" encoding="klingon"?>' + data
    yield "utf-16", text.encode("utf-16")
    yield "latin 1", text.replace("Slave", "Fahrgestell f\xfcr").encode("latin-1")
    yield "nul", data.replace(b"Slave", b"Sl\0ve")
    yield "surrogate", data.replace(b"Slave", b"\xed\xa0\x80")
    yield "character of no character", data.replace(b"Slave", b"&#27;[31m")
    yield "deep", b"<a>" * 5000 + b"</a>" * 5000
    yield "entity", b'<!DOCTYPE a [<!ENTITY b "c">]>' + data
    yield "instruction", b'<?xml-stylesheet href="file:///etc/passwd"?>' + data
    attributes = " ".join(f"a{n}='b'" for n in range(20_000))
    yield "many attributes", f"<a {attributes}/>".encode()
    chance = random.Random(1864)
    for n in range(10):
        start = chance.randrange(len(data))
        yield f"cut {n}", data[: start + 1]
        yield f"hole {n}", data[:start] + data[start + chance.randrange(1, 40) :]
        yield f"noise {n}", data[:start] + chance.randbytes(3) + data[start + 3 :]


def archives(member: str, text: str) -> Iterator[tuple[str, bytes]]:
    """Archives of a member that are damaged or mean harm, by name."""
    sound = zipped({member: text.encode(), "resources/a": bytes(200)})
    chance = random.Random(1729)
    for _ in range(40):
        place = chance.randrange(len(sound))
        yield f"cut at {place}", sound[:place]
        yield f"flip at {place}", _flipped(sound, place, 1 << chance.randrange(8))
    directory = sound.rindex(b"PK\x01\x02")
    for place in range(directory, len(sound)):
        yield f"directory byte {place - directory}", _flipped(sound, place, 0xFF)
    for name in (
        "../a", "/a", "C:/a", "a\nb", "a\x9bb", "a\x1b[31m", "resources/..", ".", "..", "",
        "resources//a/../../b", "n" * 60_000, "/".join("a" * 2000), "con", "\u202eexe.so",
        "binaries/linux64/../../x.so", "..\\..\\a", "\\a", "resources\\..\\..\\a", "a:b",
    ):  # fmt: skip
        yield f"member {name[:12]!r}", zipped({member: text.encode(), name: b"x"})
    yield "twice", zipped([(member, text.encode()), (member, b"<other/>")])
    yield "no member", zipped({})
    yield "file and folder", zipped({member: text.encode(), f"{member}/a": b"x"})
    for kind in (stat.S_IFLNK, stat.S_IFIFO, stat.S_IFCHR, stat.S_IFSOCK):
        info = zipfile.ZipInfo("resources/special")
        info.create_system, info.external_attr = 3, (kind | 0o777) << 16
        yield f"kind {kind:o}", zipped([(member, text.encode()), (info, b"/etc/passwd")])
    yield "bomb", zipped({member: text.encode(), "resources/zeros": bytes(70 * 2**20)})
    yield "bomb in the xml", zipped({member: b" " * (70 * 2**20)})
    yield "archive in an archive", zipped({member: text.encode(), "resources/b.fmu": sound})
    yield "not a zip", b"PK\x05\x06"
    yield "empty", b""
    yield "page", b"<html><body>404</body></html>"
    yield "behind something", b"#!/bin/sh\n" * 30 + sound


def zipped(members: dict[str, bytes] | list[tuple[str | zipfile.ZipInfo, bytes]]) -> bytes:
    """An archive as bytes."""
    listed = [*members.items()] if isinstance(members, dict) else members
    with io.BytesIO() as stream:
        with warnings.catch_warnings(), zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
            warnings.simplefilter("ignore")
            for name, content in listed:
                info = name if isinstance(name, zipfile.ZipInfo) else zipfile.ZipInfo("a")
                if isinstance(name, str):
                    info.filename = name  # as it is, whatever the platform
                file.writestr(info, content, zipfile.ZIP_DEFLATED)
        return stream.getvalue()


def larger_than_it_says(data: bytes) -> bytes:
    """An archive whose first member is said to have 10 bytes."""
    changed = bytearray(data)
    struct.pack_into("<I", changed, data.index(b"PK\x01\x02") + 24, 10)
    return bytes(changed)


def _flipped(data: bytes, place: int, bits: int) -> bytes:
    return data[:place] + bytes([data[place] ^ bits]) + data[place + 1 :]


def _places(root: Element) -> dict[tuple[str, str], tuple[int, ...]]:
    """The first place of each kind of attribute: by element and attribute, the way to it."""
    found: dict[tuple[str, str], tuple[int, ...]] = {}

    def look(element: Element, path: tuple[int, ...]) -> None:
        for attribute in element.attrib:
            found.setdefault((element.tag.rpartition("}")[2], attribute), path)
        for n, child in enumerate(element):
            look(child, (*path, n))

    look(root, ())
    return found


def _with(root: Element, path: tuple[int, ...], attribute: str, value: str | None) -> bytes:
    changed = copy.deepcopy(root)
    element = changed
    for n in path:
        element = element[n]
    if value is None:
        del element.attrib[attribute]
    else:
        element.set(attribute, value)
    return ElementTree.tostring(changed, encoding="utf-8")


def _pruned(root: Element, path: tuple[int, ...], times: int) -> bytes:
    """The document with an element so many times."""
    changed = copy.deepcopy(root)
    parent = changed
    for n in path[:-1]:
        parent = parent[n]
    element = parent[path[-1]]
    parent[path[-1] : path[-1] + 1] = [copy.deepcopy(element) for _ in range(times)]
    return ElementTree.tostring(changed, encoding="utf-8")
