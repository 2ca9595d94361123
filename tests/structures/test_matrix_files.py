"""Matrices with a table of nodes: what comes back is the structure they were written of."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import csc_matrix

from structures.elements import assembled
from structures.errors import StructureError
from structures.free_modes import free_modes
from structures.model import Beam, Element, Material, Model
from structures.model_files import Asked, lowest_modes, read_structure

INCH, POUND = 0.0254, 4.4482216152605
PLATES = {"front": 2, "rear": 8}


@pytest.fixture(scope="module")
def beam():
    """A beam of eight elements, and its matrices in inches, pounds and seconds."""
    section = Beam(1e-2, 4e-5, 2e-5, 1e-5, Material(2e11, 0.3, 7850.0))
    nodes = {n: (9.0 - n, 0.5, 0.0) for n in range(1, 10)}
    elements = [Element("beam", (n, n + 1), "b") for n in range(1, 9)]
    return assembled(Model("beam", nodes, {"b": section}, elements))


def in_inches(structure):
    per = np.tile(np.r_[np.full(3, INCH), 1.0, 1.0, 1.0], len(structure.numbers))
    factor = np.outer(per, per) / (POUND * INCH)
    return structure.stiffness.toarray() * factor, structure.mass.toarray() * factor


def archive(path, structure, **changes):
    K, M = in_inches(structure)
    content = {
        "stiffness": K,
        "mass": M,
        "nodes": np.array(structure.numbers),
        "positions": structure.positions / INCH,
        **changes,
    }
    np.savez(path, **{name: value for name, value in content.items() if value is not None})
    return path


def table(path, structure, heading="node, x [in], y [in], z [in], place"):
    named = {number: name for name, number in PLATES.items()}
    rows = [
        f"{n},{x / INCH!r},{y / INCH!r},{z / INCH!r},{named.get(n, '')}"
        for n, (x, y, z) in zip(structure.numbers, structure.positions.tolist(), strict=True)
    ]
    path.write_text("\n".join([heading, *rows]) + "\n")
    return path


ASKED = Asked("in, lbf, s", PLATES)


def test_an_npz_in_inches_has_the_modes_of_the_structure(tmp_path, beam):
    found = read_structure(archive(tmp_path / "beam.npz", beam), ASKED).structure
    assert found.positions == pytest.approx(beam.positions)
    assert free_modes(found, 4).frequencies == pytest.approx(
        free_modes(beam, 4).frequencies, rel=1e-6
    )


def test_a_sparse_npz_is_the_same(tmp_path, beam):
    parts = {"stiffness": None, "mass": None}
    for name, matrix in zip(("stiffness", "mass"), in_inches(beam), strict=True):
        own = csc_matrix(matrix)
        parts |= {f"{name}_{part}": getattr(own, part) for part in ("data", "indices", "indptr")}
    found = read_structure(archive(tmp_path / "beam.npz", beam, **parts), ASKED).structure
    assert abs(found.stiffness - beam.stiffness).max() < 1e-9 * abs(beam.stiffness).max()


def test_matrix_market_files_with_a_table_of_nodes(tmp_path, beam):
    K, M = in_inches(beam)
    for name, matrix in (("K", K), ("M", M)):
        mmwrite(tmp_path / f"{name}.mtx", csc_matrix((matrix + matrix.T) / 2), symmetry="symmetric")
    nodes = table(tmp_path / "nodes.csv", beam)
    asked = Asked("in, lbf, s", mass=tmp_path / "M.mtx", nodes=nodes)
    found = read_structure(tmp_path / "K.mtx", asked).structure
    assert abs(found.mass - beam.mass).max() < 1e-9 * abs(beam.mass).max()


def test_modes_below_a_frequency_are_all_of_them(beam):
    every = free_modes(beam, 12).frequencies
    below = float(every[5] + every[6]) / 2
    assert len(lowest_modes(beam, 2, below).frequencies) == 6
    with pytest.raises(StructureError, match="lowest is at"):
        lowest_modes(beam, 2, 1e-3)


def loose(beam):
    """The same without what joins node 9 to the rest."""
    K = in_inches(beam)[0]
    at = 6 * beam.numbers.index(9) + np.arange(6)
    K[at], K[:, at] = 0.0, 0.0
    return K


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (lambda b: {"mass": None}, ["no array 'mass'", "positions"]),
        (lambda b: {"nodes": np.arange(4)}, ["positions", "4 nodes"]),
        (lambda b: {"nodes": np.ones(9, int)}, ["twice"]),
        (lambda b: {"mass": np.eye(6)}, ["(6, 6)", "(54, 54)"]),
        (lambda b: {"stiffness": np.triu(in_inches(b)[0])}, ["not symmetric", "node"]),
        (lambda b: {"stiffness": in_inches(b)[0] * np.nan}, ["finite", "x of node 1"]),
        (lambda b: {"stiffness": -in_inches(b)[0]}, ["negative", "node"]),
        (lambda b: {"stiffness": in_inches(b)[0] + np.eye(54)}, ["held to the ground"]),
        (lambda b: {"stiffness": loose(b)}, ["held to the ground"]),
        (lambda b: {"mass": 0 * in_inches(b)[1]}, ["mass is 0 kg"]),
        (lambda b: {"mass": -in_inches(b)[1]}, ["mass of", "below 0"]),
        (lambda b: {"nodes": np.array([object()] * 9)}, ["plain arrays"]),
    ],
)
def test_bad_matrices_are_refused_with_what_is_wrong(tmp_path, beam, changes, words):
    with pytest.raises(StructureError) as caught:
        free_modes(
            read_structure(archive(tmp_path / "beam.npz", beam, **changes(beam)), ASKED).structure,
            3,
        )
    for word in ("beam", *words):
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("x [in]", "x", "column x has the unit ''"),
        ("x [in]", "x [kg]", "kg"),
        ("y [in], ", "", "no column y"),
        ("\n4,", "\n5,", "line 6: node 5 stands twice"),
        ("\n4,", "\nfour,", "line 5"),
        ("\n4,", "\n4,nan,0,0\n44,", "no finite place"),
    ],
)
def test_bad_tables_of_nodes_are_refused_with_their_line(tmp_path, beam, old, new, word):
    nodes = table(tmp_path / "nodes.csv", beam)
    assert old in nodes.read_text()
    nodes.write_text(nodes.read_text().replace(old, new, 1))
    for name, matrix in zip("KM", in_inches(beam), strict=True):
        mmwrite(tmp_path / f"{name}.mtx", csc_matrix(matrix))
    with pytest.raises(StructureError, match=word.replace("[", "[[]")):
        read_structure(
            tmp_path / "K.mtx", Asked("in, lbf, s", mass=tmp_path / "M.mtx", nodes=nodes)
        )


@pytest.mark.parametrize(
    ("asked", "word"),
    [
        (Asked("m, N, s", PLATES), "--mass"),
        (Asked(None, PLATES), "--units"),
        (Asked("m, N, s", PLATES, lading="loose"), "takes no lading"),
    ],
)
def test_what_a_kind_of_file_needs_is_said(tmp_path, beam, asked, word):
    name = "K.mtx" if word == "--mass" else "K.npz"
    archive(tmp_path / "K.npz", beam)
    mmwrite(tmp_path / "K.mtx", csc_matrix(np.eye(6)))
    with pytest.raises(StructureError, match=word):
        read_structure(tmp_path / name, asked)


@pytest.mark.parametrize("name", ["K.npz", "K.mtx"])
def test_files_that_are_no_matrices_are_refused(tmp_path, name):
    (tmp_path / name).write_text("mode,frequency\n")
    asked = Asked("m, N, s", PLATES)
    if name == "K.mtx":
        nodes = tmp_path / "n.csv"
        nodes.write_text("node,x [m],y [m],z [m]\n")
        asked = Asked("m, N, s", PLATES, mass=tmp_path / name, nodes=nodes)
    with pytest.raises(StructureError, match=f"{name} is no"):
        read_structure(tmp_path / name, asked)
