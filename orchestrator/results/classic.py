"""Header of a NetCDF file in the classic format (64-bit offsets): what stands before its rows.

Every variable is a double over the unlimited dimension `time`, so that a row is one number of each.
Source: The NetCDF Classic Format Specification, Unidata.
"""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, BinaryIO

MAGIC = b"CDF\x02"
ROW_COUNT = 4
"""Where the number of rows stands, in four bytes."""

MOST_ROWS = 2**32 - 2

_DIMENSION, _VARIABLE, _ATTRIBUTE = 10, 11, 12
_CHAR, _INT, _DOUBLE = 2, 4, 6
_SEAL = b"SEAL"
"""Before a CRC-32 of the header without its number of rows, in the last bytes before the rows."""

_ALLOWED = re.compile(r"(?:[A-Za-z0-9_]|[^\x00-\x7f])[^\x00-\x1f\x7f/]{0,200}(?<!\s)")

Attributes = Mapping[str, Any]


class HeaderError(Exception):
    """Bytes that are no such header, or a name that cannot be in one."""


@dataclass
class ClassicHeader:
    """Attributes of the file, and of each variable by name; where the rows begin, in bytes.

    sealed: whether the bytes that were read are those that were written; None where nothing says.
    """

    variables: Mapping[str, Attributes]
    attributes: dict[str, Any]
    first_row: int = 0
    rows: int = 0
    sealed: bool | None = field(default=None, compare=False)

    @property
    def width(self) -> int:
        """Numbers in a row."""
        return len(self.variables)

    def reserve(self, room: int) -> None:
        """Have the rows begin so many bytes behind what the header needs by now."""
        self.first_row = len(self._packed()) + -(-room // 8) * 8 + 8

    def packed(self) -> bytes:
        """All bytes before the first row; raises HeaderError where these are too few."""
        head = self._packed()
        room = self.first_row - len(head) - 8
        if room < 0:
            raise HeaderError(f"the header needs {-room} bytes more than there are before the rows")
        head += bytes(room)
        return head + _SEAL + struct.pack(">I", _digest(head))

    def _packed(self) -> bytes:
        variables = b"".join(
            _name(name)
            + struct.pack(">II", 1, 0)  # over the dimension 0
            + _attributes(said)
            + struct.pack(">IIQ", _DOUBLE, 8, self.first_row + 8 * n)
            for n, (name, said) in enumerate(self.variables.items())
        )
        return b"".join(
            (
                MAGIC,
                struct.pack(">III", self.rows, _DIMENSION, 1),
                _name("time") + struct.pack(">I", 0),  # unlimited
                _attributes(self.attributes),
                struct.pack(">II", _VARIABLE, self.width),
                variables,
            )
        )

    @classmethod
    def read(cls, stream: BinaryIO) -> ClassicHeader:
        """The header of a file; raises HeaderError for a file that has another."""
        bytes_ = _Bytes(stream)
        if bytes_.take(4) != MAGIC:
            raise HeaderError("it is no file in NetCDF's classic format with 64-bit offsets")
        rows = bytes_.number()
        bytes_.expect(_DIMENSION, 1)
        if bytes_.name() != "time" or bytes_.number() != 0:
            raise HeaderError("its dimension is not time")
        attributes = bytes_.attributes()
        bytes_.expect(_VARIABLE)
        variables, begins = {}, []
        for _ in range(bytes_.number()):
            name = bytes_.name()
            bytes_.expect(1, 0)
            variables[name] = bytes_.attributes()
            bytes_.expect(_DOUBLE, 8)
            begins.append(struct.unpack(">Q", bytes_.take(8))[0])
        first = begins[0] if begins else 0
        if begins != [first + 8 * n for n in range(len(variables))] or first < bytes_.place:
            raise HeaderError("its variables are not the numbers of one row")
        return cls(variables, attributes, first, rows, _sealed(stream, first))


def may_be_named(name: str) -> bool:
    """Whether NetCDF takes a name for a variable."""
    return _ALLOWED.fullmatch(name) is not None


def has_seal(stream: BinaryIO) -> bool:
    """Whether there is a seal anywhere before the rows, also of a header that cannot be read."""
    stream.seek(0)
    return _SEAL in stream.read(2**22)


def _sealed(stream: BinaryIO, first_row: int) -> bool | None:
    stream.seek(0)
    head = stream.read(first_row)
    if head[-8:-4] != _SEAL:
        return None
    return head[-4:] == struct.pack(">I", _digest(head[:-8]))


def _digest(head: bytes) -> int:
    """Of all but the number of rows, which changes while they are written."""
    return zlib.crc32(head[ROW_COUNT + 4 :], zlib.crc32(head[:ROW_COUNT]))


def _padded(content: bytes) -> bytes:
    return content + bytes(-len(content) % 4)


def _name(name: str) -> bytes:
    text = name.encode()
    return struct.pack(">I", len(text)) + _padded(text)


def _attributes(said: Attributes) -> bytes:
    if not said:
        return bytes(8)
    return struct.pack(">II", _ATTRIBUTE, len(said)) + b"".join(
        _name(name) + _value(value) for name, value in said.items()
    )


def _value(value: Any) -> bytes:
    if isinstance(value, str):
        text = value.encode(errors="replace")
        return struct.pack(">II", _CHAR, len(text)) + _padded(text)
    if isinstance(value, int) and abs(value) < 2**31:
        return struct.pack(">IIi", _INT, 1, value)
    numbers = [float(n) for n in (value if isinstance(value, list | tuple) else [value])]
    return struct.pack(f">II{len(numbers)}d", _DOUBLE, len(numbers), *numbers)


class _Bytes:
    """Bytes of a header, taken one thing after the other."""

    def __init__(self, stream: BinaryIO) -> None:
        stream.seek(0)
        self._stream, self.place = stream, 0

    def take(self, count: int) -> bytes:
        taken = self._stream.read(min(count, 2**26))
        if len(taken) != count:
            raise HeaderError("its header is cut short")
        self.place += count
        return taken

    def number(self) -> int:
        return int.from_bytes(self.take(4), "big")

    def expect(self, *numbers: int) -> None:
        if any(self.number() != wanted for wanted in numbers):
            raise HeaderError("its header is not that of rows of doubles")

    def name(self) -> str:
        return self._text(self.number())

    def _text(self, length: int) -> str:
        return self.take(length + -length % 4)[:length].decode(errors="replace")

    def attributes(self) -> dict[str, Any]:
        kind, count = self.number(), self.number()
        if kind not in (0, _ATTRIBUTE):
            raise HeaderError("its header is not that of rows of doubles")
        return {self.name(): self._value() for _ in range(count)}

    def _value(self) -> Any:
        kind, count = self.number(), self.number()
        if kind == _CHAR:
            return self._text(count)
        if kind not in (_INT, _DOUBLE):
            raise HeaderError("its header has attributes of another type")
        size, letter = (4, "i") if kind == _INT else (8, "d")
        numbers = struct.unpack(f">{count}{letter}", self.take(size * count))
        return numbers[0] if count == 1 else list(numbers)
