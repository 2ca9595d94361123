"""Constant tables in C, and those that FMI 3.0 needs for its arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..describe.block import Block


def c_tables(block: Block, header: str, tables: Mapping[str, Sequence[str]]) -> str:
    """A C file with the tables that the header declares: elements by declaration."""
    head = f'/* Generated from the block {block.name!r}. */\n#include "{header}"\n'
    return head + "".join(
        # A table of nothing would not be C.
        f"\nconst {declaration}[] = {{\n    " + ",\n    ".join(elements or ["0"]) + "};\n"
        for declaration, elements in tables.items()
    )


def array_tables(block: Block, known: Mapping[str, Sequence[str]]) -> str:
    """The file arrays.c: which scalars an array gathers, and what each scalar depends on.

    known: the latter, by name.
    """
    reference, gathered = block.references, block.all_arrays
    elements, first = [], [0]
    for array in gathered:
        elements += [str(reference[member]) for member in array.members]
        first.append(len(elements))
    place = {
        member: (1 + len(reference) + n, element)
        for n, array in enumerate(gathered)
        if array.replaces
        for element, member in enumerate(array.members, start=1)
    }
    starts, needs = [0], []
    for v in (*block.outputs, *block.locals, *block.constants):
        for name in known.get(v.name, ()):
            variable, element = place.get(name, (reference[name], 1))
            needs.append(f"{{{variable}, {element}}}")
        starts.append(len(needs))
    tables = {
        "uint32_t ARRAY_ELEMENT": elements,
        "uint32_t ARRAY_START": [str(n) for n in first],
        "unsigned char IN_ARRAY": ["0", *(str(int(name in place)) for name in reference)],
        "Dependency DEPENDENCY": needs,
        "uint32_t DEPENDENCY_START": [str(n) for n in starts],
    }
    return c_tables(block, "arrays.h", tables)
