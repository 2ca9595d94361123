"""A survey from a Universal file: modes of datasets 55, or transfer functions of datasets 58."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from fmus.carbody.modal_data import LARGEST_DAMPING, Mode, Point

from .errors import StructureError
from .single_mode import Array, fit, quadrature_peaks
from .survey import DAMPING, Survey

NODES, MODES, FUNCTIONS, UNITS = (15, 2411), 55, 58, 164
"""Kinds of datasets that are read; all others are left alone."""

NORMAL, COMPLEX = 2, (3, 7)
"""Analysis types of dataset 55: normal modes, complex eigenvalues."""

FREQUENCY_RESPONSE = 4
"""Function type of dataset 58."""

TO_ACCELERATION = {8: 2, 11: 1, 12: 0}
"""Displacement, velocity, acceleration: how often it is differentiated to be an acceleration."""


@dataclass(frozen=True)
class Dataset:
    """One dataset, and where it stands in the file."""

    place: str
    content: Mapping[str, Any]


def survey_of_universal_file(path: Path) -> Survey:
    """The survey in a Universal file; raises StructureError with the dataset.

    Datasets 55 give modes as they are; without any, modes are found in the frequency response
    functions of datasets 58 (`single_mode`). Places of the points are of datasets 15 or 2411.
    """
    kinds: dict[int, list[Dataset]] = {}
    for dataset in datasets(path):
        kinds.setdefault(int(dataset.content["type"]), []).append(dataset)
    places = _places(kinds)
    if MODES in kinds:
        found = _modes(path, kinds[MODES])
    elif FUNCTIONS in kinds:
        found = _modes_of_functions(path, kinds[FUNCTIONS])
    else:
        raise StructureError(
            f"{path.name} has the datasets {', '.join(map(str, sorted(kinds)))}; a survey needs "
            "modes (55) or frequency response functions (58): export one of them"
        )
    modes, nodes, shapes = found
    unknown = (np.nan, np.nan, np.nan)
    points = tuple(Point(str(node), *places.get(node, unknown)) for node in nodes)
    return Survey(path.stem, modes, points, shapes)


def datasets(path: Path) -> Iterator[Dataset]:
    """Each dataset that is read, in the file's order."""
    lines = [line.strip() for line in path.read_bytes().split(b"\n")]
    ends = [number for number, line in enumerate(lines, start=1) if line == b"-1"]
    file = pyuff.UFF(str(path))
    kinds = file.get_set_types()
    if not len(kinds):
        raise StructureError(
            f"{path.name} has no dataset; a Universal file has each between two lines of -1 "
            "(written in columns 5 and 6)"
        )
    if len(ends) % 2:
        raise StructureError(
            f"{path.name}: the dataset that begins in line {ends[-1]} has no end (-1); the file is "
            "cut off, export it again"
        )
    for number, kind in enumerate(kinds):
        line = f", line {ends[2 * number]}" if len(ends) == 2 * len(kinds) else ""
        place = f"{path.name}, dataset {number + 1} of {len(kinds)} (kind {kind}{line})"
        if kind not in (*NODES, MODES, FUNCTIONS, UNITS):
            continue
        try:
            content = file.read_sets(number)
        except Exception as error:  # pyuff raises plain ones
            raise StructureError(
                f"{place} cannot be read: its columns or their number are not those of such a "
                "dataset; export it again"
            ) from error
        yield Dataset(place, content)


def _places(kinds: Mapping[int, Sequence[Dataset]]) -> dict[int, tuple[float, float, float]]:
    """Places of the nodes [m]: lengths are divided by the factor of dataset 164."""
    units = kinds.get(UNITS, [])
    per_metre = float(units[-1].content["length"]) if units else 1.0
    if not (np.isfinite(per_metre) and per_metre > 0):
        raise StructureError(f"{units[-1].place} has the length factor {per_metre:g}")
    found = {}
    for dataset in (d for kind in NODES for d in kinds.get(kind, [])):
        columns = [dataset.content[name] for name in ("node_nums", "x", "y", "z")]
        for node, *place in zip(*columns, strict=True):
            x, y, z = (float(value) / per_metre for value in place)
            found[int(node)] = (x, y, z)
    return found


Found = tuple[tuple[Mode, ...], list[int], np.ndarray]
"""Modes, nodes, shapes (modes, nodes, 6)."""


def _modes(path: Path, datasets: Sequence[Dataset]) -> Found:
    """Datasets 55. Directions of a node that are zero in all modes were not measured.

    The format asks for zeros there (its note 15).
    """
    nodes = sorted({int(node) for d in datasets for node in d.content.get("node_nums", ())})
    shapes = np.zeros((len(datasets), len(nodes), 6))
    modes = []
    for number, (dataset, shape) in enumerate(zip(datasets, shapes, strict=True), start=1):
        content = dataset.content
        if content["analysis_type"] == NORMAL:
            frequency = float(content["freq"])
            damping = float(content["modal_damp_vis"] or content["modal_damp_his"] / 2)
        elif content["analysis_type"] in COMPLEX:
            root = complex(content["eig"])
            frequency = abs(root) / (2 * pi)
            damping = -root.real / max(abs(root), 1e-300)
        else:
            raise StructureError(
                f"{dataset.place} has analysis type {content['analysis_type']}; modes are of type "
                f"{NORMAL} (normal) or {', '.join(map(str, COMPLEX))} (complex)"
            )
        modes.append(_mode(dataset.place, number, frequency, damping))
        rows = [nodes.index(int(node)) for node in content["node_nums"]]
        columns = [content[f"r{i}"] for i in range(1, 7) if f"r{i}" in content]
        shape[rows, : len(columns)] = _real(np.array(columns).T)
    shapes[:, ~shapes.any(axis=0)] = np.nan
    return tuple(modes), nodes, shapes


def _mode(place: str, number: int, frequency: float, damping: float) -> Mode:
    if not (np.isfinite(frequency) and frequency > 0 and abs(damping) <= LARGEST_DAMPING):
        raise StructureError(
            f"{place} has the frequency {frequency:g} Hz and the damping ratio {damping:g}; give a "
            f"frequency above zero and a ratio below {LARGEST_DAMPING} (1.5 % is 0.015)"
        )
    given = damping if damping > 0 else DAMPING
    source = place if damping > 0 else f"{place}; it gives no damping, {DAMPING} was taken"
    return Mode(f"mode {number}", frequency, given, "measured", source)


def _real(shape: np.ndarray) -> np.ndarray:
    """A complex shape turned so that as much of it as can be is real; then its real part."""
    turned = shape * np.exp(-0.5j * np.angle(np.sum(shape.astype(complex) ** 2)))
    return turned.real


def _modes_of_functions(path: Path, datasets: Sequence[Dataset]) -> Found:
    """Modes at the quadrature peaks of the frequency response functions, each fitted alone.

    Of several exciters, each mode's shape is of the one that moved it most.
    """
    responses = [d for d in datasets if d.content["func_type"] == FREQUENCY_RESPONSE]
    if not responses:
        raise StructureError(
            f"{path.name}: no dataset 58 is a frequency response function (type "
            f"{FREQUENCY_RESPONSE}); they are of type "
            f"{', '.join(sorted({str(d.content['func_type']) for d in datasets}))}"
        )
    frequency = np.asarray(responses[0].content["x"], float)
    accelerance = np.column_stack([_accelerance(d, frequency) for d in responses])
    peaks = quadrature_peaks(frequency, accelerance)
    if not peaks:
        raise StructureError(
            f"{path.name}: no quadrature peak stands out between {frequency[0]:g} and "
            f"{frequency[-1]:g} Hz; no mode is seen in these functions"
        )
    at = [_directed(d, "rsp") for d in responses]
    exciters = np.array([d.content["ref_node"] * 10 + d.content["ref_dir"] for d in responses])
    nodes = sorted({node for node, _, _ in at})
    modes: list[Mode] = []
    shapes: list[np.ndarray] = []
    for peak in peaks:
        found = fit(frequency, accelerance, peak)
        if any(abs(found.frequency - m.frequency) < m.damping * m.frequency for m in modes):
            continue  # noise has given one mode two peaks
        place = f"{path.name}, peak at {frequency[peak]:.4g} Hz"
        modes.append(_mode(place, len(modes) + 1, found.frequency, found.damping))
        power = {e: float(np.sum(found.residues[exciters == e] ** 2)) for e in set(exciters)}
        most = max(power, key=power.__getitem__)
        shape = np.full((len(nodes), 6), np.nan)
        for (node, direction, sign), residue, exciter in zip(
            at, found.residues, exciters, strict=True
        ):
            if exciter == most:
                shape[nodes.index(node), direction] = sign * residue
        shapes.append(shape / np.nanmax(np.abs(shape)))
    return tuple(modes), nodes, np.array(shapes)


def _accelerance(dataset: Dataset, frequency: Array) -> np.ndarray:
    """A frequency response function as acceleration over force."""
    content = dataset.content
    axis, values = np.asarray(content["x"], float), np.asarray(content["data"])
    if len(axis) != len(frequency) or not np.allclose(axis, frequency):
        raise StructureError(
            f"{dataset.place} has {len(axis)} frequencies from {axis[0]:g} to {axis[-1]:g} Hz, the "
            f"first function {len(frequency)} from {frequency[0]:g} to {frequency[-1]:g} Hz; "
            "export all on the same lines"
        )
    if not np.iscomplexobj(values):
        raise StructureError(
            f"{dataset.place} has real values; a frequency response function is complex: export "
            "real and imaginary part"
        )
    kind = int(content["ordinate_spec_data_type"])
    if kind not in TO_ACCELERATION:
        raise StructureError(
            f"{dataset.place} says in its ordinate's data type {kind}; give 8 (displacement), 11 "
            "(velocity) or 12 (acceleration)"
        )
    return values * (2j * pi * frequency) ** TO_ACCELERATION[kind]


def _directed(dataset: Dataset, end: str) -> tuple[int, int, float]:
    """Node, direction (column of a shape) and sign of a function's response."""
    direction = int(dataset.content[f"{end}_dir"])
    if not 1 <= abs(direction) <= 6:
        raise StructureError(
            f"{dataset.place} has the direction {direction}; give 1 to 6 for x, y, z and the "
            "rotations about them, or the negative"
        )
    return int(dataset.content[f"{end}_node"]), abs(direction) - 1, float(np.sign(direction))
