"""An FMU that crashes, hangs, ends its process or prints without end, as it is told to."""

from __future__ import annotations

from pathlib import Path

from orchestrator import Component, System
from support.native_slaves import FIXED, archive, body, description, library, variable

SOURCE = Path(__file__).parent / "slaves" / "mishap.c"
KINDS = ("none", "crash", "abort", "hang", "exit", "babble", "endless", "log", "escape", "garbage")
PORTS = body(
    [
        variable("u", "input", '<Real unit="s" start="0"/>'),
        variable("y", "output", '<Real unit="s"/>'),
        variable("at", "parameter", '<Real unit="s" start="0"/>', FIXED),
        variable("kind", "parameter", '<Real start="0"/>', FIXED),
    ],
    '<Unknown index="2" dependencies=""/>',
)


def mishap(folder: Path, *flags: str, text: str = "") -> Path:
    """The FMU of `slaves/mishap.c`. flags: of the compiler. text: its description."""
    binary = library(folder, "-O1", *flags, source=SOURCE)
    return archive(folder / "mishap.fmu", text or description(PORTS), binary)


def system(fmu: Path, kind: str, at: float = 0.045) -> System:
    """That FMU alone, whose mishap of a kind of `KINDS` comes after a time [s]."""
    return System({"odd": Component(fmu, {"at": at, "kind": float(KINDS.index(kind))})})
