"""The types of variables: what they are in FMI 2.0 and 3.0, in memory and in SSP."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Type:
    """A type. kind: what it is whatever its size. ssp: its name in SSP 1.0.

    fmi2, fmi3: what its functions are named after, and a number in memory as numpy writes it.
    """

    kind: str
    ssp: str
    fmi2: tuple[str, str] = ("", "")
    fmi3: tuple[str, str] = ("", "")

    def access(self, fmi_version: str) -> tuple[str, str]:
        """What its functions are named after in a version of FMI, and a number in memory."""
        return self.fmi3 if fmi_version.startswith("3") else self.fmi2

    @property
    def limits(self) -> tuple[int, int] | None:
        """Smallest and largest number of an integer type."""
        if self.kind != "integer":
            return None
        memory = self.fmi2[1] or self.fmi3[1]
        bits = 8 * int(memory[1])
        return (0, 2**bits - 1) if memory[0] == "u" else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def _integer(name: str, memory: str) -> Type:
    return Type("integer", "Integer", fmi3=(name, memory))


TYPES = {
    "Real": Type("real", "Real", fmi2=("Real", "f8")),
    "Integer": Type("integer", "Integer", fmi2=("Integer", "i4")),
    "Boolean": Type("boolean", "Boolean", ("Boolean", "i4"), ("Boolean", "u1")),
    "Enumeration": Type("enumeration", "Enumeration", ("Integer", "i4"), ("Int64", "i8")),
    "String": Type("string", "String", ("String", ""), ("String", "")),
    "Float64": Type("real", "Real", fmi3=("Float64", "f8")),
    "Float32": Type("real", "Real", fmi3=("Float32", "f4")),
    **{f"Int{8 * n}": _integer(f"Int{8 * n}", f"i{n}") for n in (1, 2, 4, 8)},
    **{f"UInt{8 * n}": _integer(f"UInt{8 * n}", f"u{n}") for n in (1, 2, 4, 8)},
    "Binary": Type("binary", "Binary", fmi3=("Binary", "")),
    "Clock": Type("clock", "Clock", fmi3=("Clock", "u1")),
}
"""By their names in FMI 2.0 and 3.0 and in SSP."""
