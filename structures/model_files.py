"""A structure from a file of any kind that is read: what each kind needs, and what it may have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from fmus.carbody.modal_data import ENDS

from .assembled import Structure
from .elements import assembled
from .errors import StructureError
from .free_modes import FreeModes, free_modes
from .half import mirrored
from .hopper import hopper_half, numbers
from .hopper.coal import lumps, springs
from .lading import laden
from .matrix_files import read_matrices, read_npz
from .nastran import read_bulk
from .nastran.punch import punched_modes
from .unit_system import UnitSystem, unit_system

LADINGS = ("none", "loose", "carrying")
"""No lading; one without stiffness, as the report has it; one that carries."""

SPACING = (1.0, 50.0)
"""Least and largest distance of a car's centre plates [m]."""

MOST = 400
"""Modes at most that a frequency is looked for among."""


@dataclass(frozen=True)
class Asked:
    """What is said beside a model's file. Which of it a kind of file takes is in `KINDS`.

    units: "in, lbf, s". places: nodes by name, `front` and `rear` among them. mass, nodes: files
    beside a stiffness. punch: modes of a Nastran model.
    """

    units: str | None = None
    places: Mapping[str, int] = field(default_factory=dict)
    mass: Path | None = None
    nodes: Path | None = None
    punch: Path | None = None
    lading: str = "none"
    refinement: int = 1


@dataclass(frozen=True, eq=False)
class Found:
    """A structure, what is to be said of it, and its modes where the files give them."""

    structure: Structure
    source: str
    notes: tuple[str, ...] = ()
    modes: FreeModes | None = None


def read_structure(path: Path, asked: Asked | None = None) -> Found:
    """The structure of a file: hopper car, Nastran or matrices, by its suffix (`KINDS`).

    Raises StructureError for another kind of file, and for what this kind does not take.
    """
    asked = asked or Asked()
    suffix = path.suffix.lower()
    if suffix not in KINDS:
        raise StructureError(
            f"{path.name} is no model by its name; give a hopper car's dimensions (.toml), Nastran "
            "bulk data (.bdf, .dat, .nas) or matrices (.npz; .mtx with --mass and --nodes)."
            f"{RESULTS.get(suffix, '')}"
        )
    if not path.is_file():
        raise StructureError(f"{path} cannot be read: there is no such file")
    kind = KINDS[suffix]
    usual = Asked()
    for one in fields(Asked):
        if getattr(asked, one.name) != getattr(usual, one.name) and one.name not in kind.takes:
            raise StructureError(
                f"{path.name} ({kind.what}) takes no {one.name}; it takes {', '.join(kind.takes)}"
            )
    found = kind.read(path, asked)
    _check_plates(found.structure)
    _check_spacing(found.structure, asked.units)
    return found


def lowest_modes(structure: Structure, count: int, below: float | None = None) -> FreeModes:
    """The lowest elastic modes: so many, or all below a frequency [Hz] (one at least)."""
    if below is None:
        return free_modes(structure, count)
    while True:
        modes = free_modes(structure, count)
        kept = modes.frequencies < below
        if not kept.all() or count >= min(MOST, structure.degrees - 8):
            break
        count *= 2
    if not kept.any():
        raise StructureError(
            f"{structure.name} has no mode below {below:g} Hz; its lowest is at "
            f"{modes.frequencies[0]:.4g} Hz"
        )
    return FreeModes(modes.frequencies[kept], modes.shapes[:, kept], modes.rigid)


def _hopper(path: Path, asked: Asked) -> Found:
    of = numbers(path)
    structure = mirrored(assembled(hopper_half(of, asked.refinement)))
    if asked.lading != "none":
        coal = lumps(of, structure)
        held = springs(of, coal) if asked.lading == "carrying" else ()
        structure = laden(structure, coal, held, name=f"{structure.name}, loaded")
    return Found(structure, f"finite elements: {path.name}")


def _nastran(path: Path, asked: Asked) -> Found:
    deck = read_bulk(path, unit_system(asked.units) if asked.units else None, asked.places)
    structure = assembled(deck.model)
    source = f"finite elements: {path.name} (Nastran, {deck.units.name})"
    if asked.punch is None:
        return Found(structure, source, deck.notes)
    modes, said = punched_modes(deck, structure, asked.punch)
    source = f"Nastran modes: {asked.punch.name} of {path.name} ({deck.units.name})"
    return Found(structure, source, (*deck.notes, *said), modes)


def _npz(path: Path, asked: Asked) -> Found:
    return Found(read_npz(path, _units(path, asked), asked.places), f"matrices: {path.name}")


def _matrices(path: Path, asked: Asked) -> Found:
    if asked.mass is None or asked.nodes is None:
        raise StructureError(
            f"{path.name} is a stiffness matrix; give the mass matrix (--mass M.mtx) and the table "
            "of nodes (--nodes nodes.csv) as well"
        )
    files = path, asked.mass, asked.nodes
    source = f"matrices: {path.name}, {asked.mass.name}"
    return Found(read_matrices(files, _units(path, asked), asked.places), source)


def _units(path: Path, asked: Asked) -> UnitSystem:
    if asked.units is None:
        raise StructureError(
            f"{path.name} does not say its units, and they are not guessed; say them with --units, "
            'such as "m, N, s", "mm, N, s" or "in, lbf, s"'
        )
    return unit_system(asked.units)


def _check_plates(structure: Structure) -> None:
    missing = [end for end in ENDS if end not in structure.places]
    if missing:
        raise StructureError(
            f"{structure.name}: which nodes are the centre plates? say --front and --rear, each "
            f"with a node's number ({' and '.join(missing)} is missing)"
        )
    front, rear = (structure.positions[structure.places[end]] for end in ENDS)
    apart = np.abs(front - rear)
    if int(apart.argmax()) != 0 or front[0] < rear[0]:
        raise StructureError(
            f"{structure.name}: from the rear centre plate to the front one it is "
            f"{', '.join(f'{d:.4g}' for d in front - rear)} m along X, Y, Z; X points forward, Y "
            "left, Z up: turn the model, or change front and rear"
        )


def _check_spacing(structure: Structure, units: str | None) -> None:
    front, rear = (structure.positions[structure.places[end]] for end in ENDS)
    spacing = float(np.linalg.norm(front - rear))
    if not SPACING[0] <= spacing <= SPACING[1]:
        raise StructureError(
            f"{structure.name}: the centre plates are {spacing:.4g} m apart, a car's "
            f"{SPACING[0]:g} to {SPACING[1]:g} m. Are its places in the units '{units or 'm'}' "
            "too, or does the model mix units?"
        )


@dataclass(frozen=True)
class Kind:
    """A kind of file: what it is, its reader, and the fields of `Asked` that it takes."""

    what: str
    read: Callable[[Path, Asked], Found]
    takes: tuple[str, ...]


_NASTRAN = Kind("Nastran bulk data", _nastran, ("units", "places", "punch"))
KINDS = {
    ".toml": Kind("a hopper car's dimensions", _hopper, ("lading", "refinement")),
    ".bdf": _NASTRAN,
    ".dat": _NASTRAN,
    ".nas": _NASTRAN,
    ".npz": Kind("matrices", _npz, ("units", "places")),
    ".mtx": Kind("matrices", _matrices, ("units", "places", "mass", "nodes")),
}
"""Kinds of files by their suffix."""

_OP2 = (
    " Results as OP2 or HDF5 are not read: let Nastran write them as text, "
    "VECTOR(PUNCH,SORT1,REAL)=ALL, and give the bulk data with --punch FILE.pch"
)
RESULTS = {
    ".op2": _OP2, ".h5": _OP2, ".xdb": _OP2, ".f06": _OP2,
    ".pch": " A punch file goes with its bulk data: MODEL.bdf --punch FILE.pch",
    ".csv": " Modes as CSV need no structure: 'tracktrain carbody MODES.csv'",
}  # fmt: skip
