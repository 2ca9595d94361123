"""A structure as matrices K and M with a table of nodes: Matrix Market or NPZ."""

from __future__ import annotations

import csv
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import mmread
from scipy.sparse import csc_matrix, issparse

from fmus.carbody.modal_table import HEADING
from fmus.describe.units import registry

from .assembled import Structure
from .errors import StructureError
from .model import Array
from .unit_system import UnitSystem, scaled

KEYS = {
    "stiffness": "K, six degrees of freedom a node",
    "mass": "M",
    "nodes": "the nodes' numbers",
    "positions": "their places, (nodes, 3)",
}
"""What an NPZ holds. A sparse matrix is three arrays: stiffness_data, _indices, _indptr (CSC)."""

COLUMNS = ("node", "x", "y", "z")
SYMMETRIC = 1e-8
"""Largest difference of a matrix to its transpose, over its largest entry."""


def read_npz(path: Path, units: UnitSystem, places: Mapping[str, int]) -> Structure:
    """The structure of an NPZ whose arrays are `KEYS`, all in the units."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            content = {key: archive[key] for key in archive.files}
    except OSError as error:
        raise StructureError(f"{path} cannot be read: {error.strerror or error}") from error
    except (ValueError, zipfile.BadZipFile, EOFError, AttributeError) as error:
        raise StructureError(f"{path.name} is no NPZ of plain arrays: {error}") from error
    for key in ("nodes", "positions"):
        if key not in content:
            raise _missing(path, key, content)
    numbers, positions = content["nodes"].ravel(), content["positions"]
    if positions.shape != (len(numbers), 3) or not np.isfinite(positions).all():
        raise StructureError(
            f"{path.name}: positions has the size {positions.shape} for {len(numbers)} nodes; give "
            "three finite numbers for each"
        )
    K, M = (_of_archive(path, content, key) for key in ("stiffness", "mass"))
    table = {int(n): units.length * at for n, at in zip(numbers, positions, strict=True)}
    if len(table) < len(numbers):
        raise StructureError(f"{path.name}: a node's number stands twice in nodes")
    return _structure(path, (K, M), units, table, places)


def _missing(path: Path, key: str, content: Mapping[str, Any]) -> StructureError:
    told = "; ".join(f"{name}: {what}" for name, what in KEYS.items())
    return StructureError(
        f"{path.name} has no array '{key}', but {', '.join(content) or 'none'}; give {told}"
    )


def _of_archive(path: Path, content: Mapping[str, Any], key: str) -> Any:
    if key in content:
        return content[key]
    parts = [f"{key}_{part}" for part in ("data", "indices", "indptr")]
    if not all(part in content for part in parts):
        raise _missing(path, key, content)
    data, indices, indptr = (content[part] for part in parts)
    size = len(indptr) - 1
    try:
        return csc_matrix((data, indices, indptr), (size, size))
    except ValueError as error:
        raise StructureError(f"{path.name}: {key} is no sparse matrix (CSC): {error}") from error


def read_matrices(
    files: tuple[Path, Path, Path], units: UnitSystem, places: Mapping[str, int]
) -> Structure:
    """The structure of K and M (Matrix Market) and a table of nodes (CSV), in this order."""
    K, M = (_matrix_market(path) for path in files[:2])
    table, named = read_nodes(files[2])
    return _structure(files[0], (K, M), units, table, {**named, **places})


def _matrix_market(path: Path) -> Any:
    try:
        return mmread(str(path))
    except OSError as error:
        raise StructureError(f"{path} cannot be read: {error.strerror or error}") from error
    except (ValueError, OverflowError, StopIteration) as error:
        raise StructureError(f"{path.name} is no Matrix Market file: {error}") from error


def read_nodes(path: Path) -> tuple[dict[int, Array], dict[str, int]]:
    """Places of nodes [m], and the nodes that have a name.

    Columns node, x, y, z, each place with its unit (`x [in]`), and place (`front`, `rear`).
    Raises StructureError with the line.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise StructureError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise StructureError(f"{path.name} is no text in UTF-8") from error
    rows = [(n, row) for n, row in enumerate(csv.reader(lines), start=1) if any(row)]
    headings = [HEADING.fullmatch(text) for text in rows[0][1]] if rows else []
    columns = {m[1]: (i, m[2]) for i, m in enumerate(headings) if m}
    lacking = [name for name in COLUMNS if name not in columns]
    if lacking:
        raise StructureError(
            f"{path.name} has no column {lacking[0]}; a table of nodes has node, x [m], y [m], "
            "z [m], and place for the centre plates front and rear"
        )
    factors = [_length(path, name, columns[name][1]) for name in COLUMNS[1:]]
    table: dict[int, Array] = {}
    named: dict[str, int] = {}
    for number, row in rows[1:]:
        cells = {name: row[i].strip() if i < len(row) else "" for name, (i, _) in columns.items()}
        try:
            node = int(cells["node"])
            at = np.array([float(cells[name]) for name in COLUMNS[1:]]) * factors
        except ValueError as error:
            raise StructureError(f"{path.name}, line {number}: {error}; {','.join(row)}") from error
        if node in table or not np.isfinite(at).all():
            why = "stands twice" if node in table else "has no finite place"
            raise StructureError(f"{path.name}, line {number}: node {node} {why}")
        table[node] = at
        if cells.get("place"):
            named[cells["place"]] = node
    return table, named


def _length(path: Path, name: str, unit: str | None) -> float:
    try:
        return float(registry().Quantity(1.0, unit or "").to("m").magnitude)
    except Exception as error:  # pint raises errors of many kinds for what is no unit
        raise StructureError(
            f"{path.name}: column {name} has the unit '{unit or ''}'; write a length in brackets, "
            f"such as {name} [m] or {name} [in]"
        ) from error


def _structure(
    path: Path,
    matrices: tuple[Any, Any],
    units: UnitSystem,
    table: Mapping[int, Array],
    places: Mapping[str, int],
) -> Structure:
    numbers = tuple(table)
    size = 6 * len(numbers)
    for name, matrix in zip(("stiffness", "mass"), matrices, strict=True):
        if matrix.shape != (size, size):
            raise StructureError(
                f"{path.name}: the {name} has the size {matrix.shape}; {len(numbers)} nodes of six "
                f"degrees of freedom make ({size}, {size})"
            )
    unknown = {name: node for name, node in places.items() if node not in table}
    if unknown:
        name, node = next(iter(unknown.items()))
        raise StructureError(
            f"{path.name} has no node {node} for the place {name}; its nodes are "
            f"{', '.join(map(str, numbers[:8]))}, ... ({len(numbers)} in all)"
        )
    both = tuple(csc_matrix(m) if issparse(m) else csc_matrix(np.asarray(m)) for m in matrices)
    K, M = scaled(units, *both)
    index = {number: i for i, number in enumerate(numbers)}
    found = Structure(
        path.stem, K, M, numbers, np.array(list(table.values())),
        {name: index[node] for name, node in places.items()},
    )  # fmt: skip
    for name, matrix in (("stiffness", K), ("mass", M)):
        _check(found, path, name, matrix)
    return found


def _check(found: Structure, path: Path, name: str, matrix: Any) -> None:
    entries = matrix.tocoo()
    wrong = np.flatnonzero(~np.isfinite(entries.data))
    if len(wrong):
        at = found.label(int(entries.row[wrong[0]]))
        raise StructureError(f"{path.name}: the {name} of {at} is no finite number")
    apart = abs(matrix - matrix.T).tocoo()
    size = np.abs(entries.data).max(initial=0.0)
    if apart.nnz and apart.data.max() > SYMMETRIC * size:
        worst = int(apart.data.argmax())
        raise StructureError(
            f"{path.name}: the {name} is not symmetric, by {apart.data.max() / size:.2g} of its "
            f"largest entry, at {found.label(int(apart.row[worst]))} and "
            f"{found.label(int(apart.col[worst]))}; was only a triangle written?"
        )
    if name == "mass" and (matrix.diagonal() < 0).any():
        at = found.label(int(matrix.diagonal().argmin()))
        raise StructureError(f"{path.name}: the mass of {at} is below 0")
