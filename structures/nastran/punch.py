"""Modes from a Nastran punch file: eigenvalues and eigenvectors, with the deck's own mass."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import pi
from pathlib import Path

import numpy as np

from ..assembled import Structure
from ..errors import StructureError
from ..free_modes import FreeModes, rigid_modes
from ..model import Array
from .bulk import Deck
from .cards import text_of

EIGENVALUE = re.compile(r"\$EIGENVALUE\s*=\s*(\S+)\s+MODE\s*=\s*(\d+)", re.IGNORECASE)
ID, VALUE, VALUES = 10, 18, 72
"""Columns: the point's number, a value, the end of the values (a count of lines follows)."""

SMALL = 0.1
"""Frequency [Hz] below which a mode counts as a rigid one."""

ASK = "ask for VECTOR(PUNCH,SORT1,REAL)=ALL in the case control, and give the .pch"


@dataclass(frozen=True, eq=False)
class Vectors:
    """eigenvalues (modes,) [rad2/s2 of the deck]; shapes by node, (modes, 6) each."""

    eigenvalues: Array
    shapes: dict[int, Array]


def read_punch(path: Path) -> Vectors:
    """The eigenvectors of a punch file; raises StructureError with the line."""
    text = text_of(path, ASK)
    if not re.search(r"\$(EIGENVECTOR|DISPLACEMENTS)", text):
        raise StructureError(f"{path.name} is no punch file with eigenvectors; {ASK}")
    squared: list[float] = []
    rows: list[dict[int, list[float]]] = []
    node = 0
    for number, line in enumerate(text.splitlines(), start=1):
        where = f"{path.name}, line {number}"
        if line.startswith("$"):
            if "IMAGINARY" in line or "PHASE" in line:
                raise StructureError(f"{where}: complex modes are not read; {ASK}")
            found = EIGENVALUE.match(line)
            if found:
                squared.append(_number(where, found[1]))
                rows.append({})
            continue
        if not line.strip():
            continue
        if not rows:
            raise StructureError(f"{where}: numbers before any $EIGENVALUE; {ASK}")
        values = [
            _number(where, line[n : n + VALUE])
            for n in range(VALUE, VALUES, VALUE)
            if line[n : min(n + VALUE, VALUES)].strip()
        ]
        if line.startswith("-CONT-"):
            if node not in rows[-1] or len(rows[-1][node]) != 3:
                raise StructureError(f"{where} goes on with no point")
            rows[-1][node] += values
        else:
            if not line[:ID].strip().isdigit():
                raise StructureError(f"{where}: '{line[:ID].strip()}' is no number of a point")
            node = int(line[:ID])
            if line[ID:VALUE].strip() != "G":
                raise StructureError(f"{where}: point {node} is no grid point (G)")
            if node in rows[-1]:
                raise StructureError(f"{where}: point {node} stands twice in mode {len(rows)}")
            rows[-1][node] = values
        count = len(rows[-1][node])
        if count != (6 if line.startswith("-CONT-") else 3):
            raise StructureError(f"{where} is cut off: three numbers are in a line")
    return _joined(path, squared, rows)


def _joined(path: Path, squared: list[float], rows: list[dict[int, list[float]]]) -> Vectors:
    if not rows:
        raise StructureError(f"{path.name} has no $EIGENVALUE; {ASK}")
    for mode, row in enumerate(rows, start=1):
        short = [n for n, values in row.items() if len(values) != 6] or sorted({*rows[0]} ^ {*row})
        if short:
            raise StructureError(
                f"{path.name}: mode {mode} has no six numbers at point {short[0]}; is the file cut "
                "off?"
            )
    shapes = {n: np.array([row[n] for row in rows]) for n in rows[0]}
    return Vectors(np.array(squared), shapes)


def _number(where: str, text: str) -> float:
    try:
        return float(re.sub("[dD]", "e", text))
    except ValueError:
        raise StructureError(f"{where}: '{text.strip()}' is no number") from None


def punched_modes(
    deck: Deck, structure: Structure, path: Path
) -> tuple[FreeModes, tuple[str, ...]]:
    """The elastic modes of a punch file in SI, for unit modal mass, and what is to be said.

    structure: the deck's, whose mass gives the modal masses. Raises StructureError.
    """
    vectors = read_punch(path)
    frequencies = np.sign(vectors.eigenvalues) * np.sqrt(np.abs(vectors.eigenvalues))
    frequencies = frequencies / (2 * pi * deck.units.time)
    negative = int(frequencies.argmin())
    if frequencies[negative] < -SMALL:
        raise StructureError(
            f"{path.name}: mode {negative + 1} has the eigenvalue "
            f"{vectors.eigenvalues[negative]:g}; a structure cannot push itself"
        )
    missing = [n for n in structure.numbers if n not in vectors.shapes]
    if missing:
        raise StructureError(
            f"{path.name} has no shape at {len(missing)} nodes of the deck, such as {missing[0]}; "
            f"{ASK}"
        )
    elastic = frequencies > SMALL
    if np.count_nonzero(~elastic) > 6 or not elastic.any():
        raise StructureError(
            f"{path.name} has {np.count_nonzero(~elastic)} modes below {SMALL:g} Hz and "
            f"{np.count_nonzero(elastic)} above; a free carbody has six rigid ones, more are "
            "mechanisms"
        )
    frames = np.stack([deck.frames.get(n, np.eye(3)) for n in structure.numbers])
    own = np.stack([vectors.shapes[n][elastic] for n in structure.numbers], axis=1)
    moved = own.reshape(len(own), len(frames), 2, 3)
    turned = np.einsum("nij,mnkj->mnki", frames, moved)  # out of the displacement systems
    turned = turned * np.array([deck.units.length, 1.0])[:, None]
    shapes = turned.reshape(len(own), -1).T
    masses = np.einsum("dm,dm->m", shapes, structure.mass @ shapes)
    rigid = rigid_modes(structure)
    leak = np.abs(rigid.T @ (structure.mass @ shapes)).max(axis=0) / np.sqrt(masses)
    if leak.max() > 0.2:
        raise StructureError(
            f"{path.name}: mode {int(np.flatnonzero(elastic)[leak.argmax()]) + 1} moves the whole "
            f"body by the deck's mass (share {leak.max():.2f}); shapes and deck are of different "
            "models"
        )
    said = masses / (deck.units.mass * deck.units.length**2)
    note = (
        f"modal masses of {path.name} by the deck's mass: {said.min():.4g} to {said.max():.4g} of "
        "the deck's units; shapes are scaled to 1 kg"
    )
    return FreeModes(frequencies[elastic], shapes / np.sqrt(masses), rigid), (note,)
