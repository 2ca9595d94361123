"""A small carbody as a Nastran deck: a box of plates with a sill, in any units."""

from __future__ import annotations

from pathlib import Path

import numpy as np

PLATES = {"front": 902, "rear": 202}
"""Nodes of the centre plates."""

STATIONS = 11
RING = ((-1.5, 0.0), (0.0, 0.0), (1.5, 0.0), (1.5, 2.5), (0.0, 2.5), (-1.5, 2.5))
"""Places y, z [m] of the nodes of a cross-section."""


def real(value: float) -> str:
    """A number in eight columns, as Nastran writes it: 2.0+11, 6.-3."""
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    return f"{mantissa}{int(exponent):+d}"[:8]


def node(station: int, corner: int) -> int:
    return 100 * (station + 1) + corner + 1


def box(length: float = 1.0, force: float = 1.0, time: float = 1.0) -> list[str]:
    """Lines of the deck; units of it in SI. Written in small, large and free fields."""
    mass = force * time**2 / length
    lines = ["SOL 103", "CEND", "BEGIN BULK", "$ a box of plates with a sill"]
    for i, x in enumerate(np.linspace(-7.5, 7.5, STATIONS)):
        for j, (y, z) in enumerate(RING):
            place = ",".join(f"{v / length:.6f}" for v in (x, y, z))
            lines.append(f"GRID,{node(i, j)},,{place}")
    element = 0
    for i in range(STATIONS - 1):
        for j in range(6):
            element, k = element + 1, (j + 1) % 6
            corners = (node(i, j), node(i + 1, j), node(i + 1, k), node(i, k))
            lines.append("CQUAD4  " + "".join(f"{n:8d}" for n in (element, 1, *corners)))
        element += 1
        ends = f"{node(i, 1)},{node(i + 1, 1)}"
        lines += [f"CBEAM,{element},3,{ends},0.,0.,1.", f",,,0.,0.,{real(-0.15 / length)},0.,0.,"
                  f"{real(-0.15 / length)}  $ below the floor"]  # fmt: skip
    for i in (0, 3, 7, STATIONS - 1):
        for j in range(6):
            element += 1
            lines.append(f"CBAR,{element},2,{node(i, j)},{node(i, (j + 1) % 6)},1.,0.,0.")
    a, s = length**2, length**4
    lines += [
        f"PSHELL,1,1,{real(6e-3 / length)},1,,1",
        f"PBAR    2       1       {real(4e-3 / a):8}{real(1e-5 / s):8}{real(1e-5 / s):8}"
        f"{real(2e-6 / s):8}",
        f"{'PBEAM*':8}{3:<16}{1:<16}{1.2e-2 / a:<16.6E}{1.5e-4 / s:<16.6E}*",
        f"{'*':8}{1e-4 / s:<16.6E}{'':16}{5e-5 / s:<16.6E}",
        f"MAT1,1,{real(2e11 * a / force)},,.3,{real(7850 * length**3 / mass)}",
        f"CONM2,9001,{node(0, 1)},,{real(500 / mass)},0.,0.,{real(-0.5 / length)}",
        f"CONM2,9002,{node(STATIONS - 1, 1)},,{real(500 / mass)},0.,0.,{real(-0.5 / length)}",
        "ENDDATA",
    ]
    return lines


def deck(folder: Path, lines: list[str], name: str = "box.bdf") -> Path:
    path = folder / name
    path.write_text("\n".join(lines) + "\n")
    return path


def changed(lines: list[str], old: str, new: str) -> list[str]:
    """The deck with a text replaced, which must be in it."""
    assert any(old in line for line in lines)
    return [line.replace(old, new) for line in lines]


def punch(structure, modes, units) -> str:
    """What Nastran punches of modes: rigid ones first, in the deck's units."""
    count, lines = 0, []

    def line(text: str) -> None:
        nonlocal count
        count += 1
        lines.append(f"{text:72}{count:8d}")

    squared = np.r_[np.full(6, 1e-7), (2 * np.pi * modes.frequencies) ** 2] * units.time**2
    per = np.tile(np.r_[np.full(3, units.length), 1.0, 1.0, 1.0], len(structure.numbers))
    whole = np.hstack([modes.rigid, modes.shapes]) / per[:, None]
    whole *= np.sqrt(units.mass) * units.length
    for mode, (value, shape) in enumerate(zip(squared, whole.T, strict=True), start=1):
        for text in ("$TITLE   = BOX", "$EIGENVECTOR", "$REAL OUTPUT", "$SUBCASE ID =   1"):
            line(text)
        line(f"$EIGENVALUE = {value:14.7E}  MODE ={mode:6d}")
        for number, row in zip(structure.numbers, shape.reshape(-1, 6), strict=True):
            first, second = ("".join(f"{v:18.6E}" for v in part) for part in (row[:3], row[3:]))
            line(f"{number:10d}{'G':^8}{first}")
            line(f"{'-CONT-':18}{second}")
    return "\n".join(lines) + "\n"
