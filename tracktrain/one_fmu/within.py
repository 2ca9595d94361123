"""The C sources of FMUs, each with a prefix of its own, so that all fit into one library."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from orchestrator import open_archive

from ..errors import TracktrainError

HIDDEN = """\
#define FMI2_FUNCTION_PREFIX {prefix}
#define VISIBLE_H /* the functions of FMUs within stay within */
#define VISIBLE
#include "{file}"
"""


def sources_of(files: Sequence[Path]) -> dict[str, str]:
    """C files by name: those of each FMU in a folder, and beside it one to compile for each unit.

    Raises TracktrainError for an FMU without sources.
    """
    found: dict[str, str] = {}
    for number, file in enumerate(files):
        folder = prefix_of(number).rstrip("_")
        with open_archive(file) as archive:
            units = _units(archive.xml("modelDescription.xml"))
            names = [name for name in archive.members if name.startswith("sources/")]
            if not units or not {f"sources/{unit}" for unit in units} <= {*names}:
                raise TracktrainError(
                    f"{file.name} cannot be made part of one FMU: it brings no C sources; take one "
                    "that does (`tracktrain build` writes such), or export an archive: FILE.ssp"
                )
            for name in names:
                if name.endswith((".c", ".h")):
                    path = f"{folder}/{name.removeprefix('sources/')}"
                    found[path] = archive.read(name).decode()
        for unit in units:
            name = f"{folder}_{unit.replace('/', '_')}"
            found[name] = HIDDEN.format(prefix=prefix_of(number), file=f"{folder}/{unit}")
    return found


def prefix_of(number: int) -> str:
    """What the functions of an FMU begin with."""
    return f"within_{number}_"


def tables(guids: Sequence[str], fmu_of: Sequence[int], own: Sequence[tuple[int, int]]) -> str:
    """C of what is within. fmu_of: by instance. own: by parameter, instance and value reference."""
    prefixes = [prefix_of(number) for number in range(len(guids))]
    fmus = ",\n    ".join(f'FMU({p}, "{g}")' for p, g in zip(prefixes, guids, strict=True))
    listed = ",\n    ".join(f"{{{i}, {reference}}}" for i, reference in own) or "{0, 0}"
    return "\n".join(
        (
            '#include "coupled.h"',
            *(f"DECLARE_FMU({prefix})" for prefix in prefixes),
            f"const Fmu2 FMU_WITHIN[] = {{\n    {fmus}}};",
            f"const unsigned char FMU_OF[] = {{{', '.join(map(str, fmu_of))}}};",
            f"const Own PARAMETER_OF[] = {{\n    {listed}}};",
            "",
        )
    )


def header(numbers: Mapping[str, int]) -> str:
    """C of numbers by name."""
    lines = "\n".join(f"#define {name} {number}" for name, number in numbers.items())
    return f"#ifndef LAYOUT_H\n#define LAYOUT_H\n{lines}\n#endif\n"


def _units(description: Element) -> list[str]:
    """The files that are compiled."""
    return [*_named(description.iterfind("CoSimulation/SourceFiles/File"))]


def _named(elements: Iterator[Element]) -> Iterator[str]:
    for element in elements:
        yield element.attrib["name"]
