"""Half and mirror, rigid checks, Guyan reduction, lading and modes on structures of a few parts."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csc_matrix

from structures.assembled import Structure, rigid_motions
from structures.elements import assembled
from structures.errors import StructureError
from structures.free_modes import free_modes
from structures.half import mirrored
from structures.lading import Lump, Spring, laden
from structures.model import Beam, Element, Material, Model, Plate
from structures.reduction import again, mass_on, proposed, reduced
from structures.rigid import check_free, grounding, mass_properties

STEEL = Material(2.0e11, 0.3, 7850.0)
BEAM = Beam(2e-3, 4e-6, 3e-6, 5e-7, STEEL)


def trough(half: bool, cells: int = 8) -> Model:
    """An open trough 4 m long, two walls and a floor, with a beam on one edge; or its half."""
    stations = np.linspace(0.0, 2.0, cells + 1) if half else np.linspace(-2.0, 2.0, 2 * cells + 1)
    section = [
        (0.5, 0.8),
        (0.5, 0.4),
        (0.5, 0.0),
        (0.0, 0.0),
        (-0.5, 0.0),
        (-0.5, 0.4),
        (-0.5, 0.8),
    ]
    rows = len(section)
    nodes = {
        1 + i * rows + j: (float(x), y, z)
        for i, x in enumerate(stations)
        for j, (y, z) in enumerate(section)
    }
    shells = [
        Element("quad", (n, n + rows, n + rows + 1, n + 1), "plate", "sheet")
        for i in range(len(stations) - 1)
        for n in range(1 + i * rows, i * rows + rows)
    ]
    chord = [
        Element("beam", (1 + i * rows, 1 + (i + 1) * rows), "beam", "chord")
        for i in range(len(stations) - 1)
    ]
    x = [abs(place - 1.5) for place in stations]
    front = 1 + int(np.argmin(x)) * rows + 3
    places = {"front": front}
    if not half:
        places["rear"] = 1 + int(np.argmin([abs(place + 1.5) for place in stations])) * rows + 3
    sections = {"plate": Plate(0.005, STEEL), "beam": BEAM}
    return Model("trough", nodes, sections, shells + chord, places=places)


@pytest.fixture(scope="module")
def whole() -> Structure:
    return assembled(trough(half=False))


def test_two_halves_have_the_modes_and_the_mass_of_the_whole(whole):
    joined = mirrored(assembled(trough(half=True)))
    assert joined.degrees == whole.degrees
    assert set(joined.places) == {"front", "rear"}
    places = [joined.positions[joined.places[name]] for name in ("front", "rear")]
    assert places[0] == pytest.approx([1.5, 0, 0]) and places[1] == pytest.approx([-1.5, 0, 0])
    ours, theirs = (free_modes(one, 8).frequencies for one in (joined, whole))
    assert ours == pytest.approx(theirs, rel=1e-8)
    assert mass_properties(joined).inertia == pytest.approx(mass_properties(whole).inertia)


def test_a_half_must_reach_the_middle_and_not_beyond():
    half = assembled(trough(half=True))
    apart = replace(half, positions=half.positions + np.eye(3)[0])
    with pytest.raises(StructureError, match="no node of the half lies on x = 0"):
        mirrored(apart)
    beyond = replace(half, positions=half.positions - np.eye(3)[0] / 2)
    with pytest.raises(StructureError, match=r"node 1 of the half lies at x = -0\.5 m"):
        mirrored(beyond)


def test_rigid_motions_meet_no_force_and_what_holds_them_is_named(whole):
    assert grounding(whole).worst < 1e-9
    held = whole.stiffness.tolil()
    degree = 6 * 20 + 2
    held[degree, degree] += 1e9
    grounded = replace(whole, stiffness=held.tocsc())
    assert grounding(grounded).degrees[0] == whole.label(degree) == "z of node 21"
    with pytest.raises(StructureError, match="trough is held to the ground at z of node 21"):
        check_free(grounded)


def test_modes_are_orthogonal_of_unit_mass_and_apart_from_rigid_motions(whole):
    modes = free_modes(whole, 6)
    shapes, mass, stiffness = modes.shapes, whole.mass, whole.stiffness
    assert shapes.T @ mass @ shapes == pytest.approx(np.eye(6), abs=1e-9)
    squared = (2 * pi * modes.frequencies) ** 2
    energy = shapes.T @ stiffness @ shapes
    assert energy == pytest.approx(np.diag(squared), abs=1e-6 * squared.max())
    assert np.abs(modes.rigid.T @ (mass @ shapes)).max() < 1e-9
    assert np.abs(rigid_motions(whole.positions).T @ (mass @ shapes)).max() < 1e-6


def test_reduced_frequencies_are_never_below_the_full_ones_and_close_with_enough_points(whole):
    full = free_modes(whole, 12).frequencies
    errors = []
    for count in (60, 150, 300):
        small = reduced(whole, proposed(whole, count))
        found = (
            np.sqrt(np.maximum(eigh(small.stiffness, small.mass, eigvals_only=True), 0)) / 2 / pi
        )
        assert np.all(found[6:18] >= full * (1 - 1e-9))
        errors.append(float(np.max(found[6:10] / full[:4] - 1)))
    assert errors[0] > errors[1] > errors[2] and errors[2] < 0.01


def test_statics_of_the_retained_points_are_exact(whole):
    """The flexibility between retained points is the full structure's: held at six of them."""
    kept = proposed(whole, 60)
    small = reduced(whole, kept)
    loaded = np.setdiff1d(kept, [6 * whole.places["front"] + d for d in range(6)])
    held = [6 * whole.places["front"] + d for d in range(6)]
    free = np.setdiff1d(np.arange(whole.degrees), held)
    full = np.linalg.inv(whole.stiffness.toarray()[np.ix_(free, free)])
    own = np.flatnonzero(np.isin(free, loaded))
    place = np.flatnonzero(np.isin(small.retained, loaded))
    flexibility = np.linalg.inv(small.stiffness[np.ix_(place, place)])
    expected = full[np.ix_(own, own)]
    assert flexibility == pytest.approx(expected, rel=1e-5, abs=1e-8 * np.abs(expected).max())


def test_two_stages_are_one_in_stiffness_and_more_in_mass(whole):
    wide, narrow = proposed(whole, 150), proposed(whole, 60)
    two = again(reduced(whole, np.union1d(wide, narrow)), narrow)
    one = reduced(whole, narrow)
    assert two.stiffness == pytest.approx(one.stiffness, rel=1e-6, abs=1e-6 * one.stiffness.max())
    assert two.shape == pytest.approx(one.shape, abs=1e-6)
    assert two.mass == pytest.approx(one.mass, rel=1e-6, abs=1e-6 * one.mass.max())
    with pytest.raises(StructureError, match="was not retained by the first stage"):
        again(one, wide)


def test_mass_formed_on_the_coarse_set_keeps_mass_and_centre_and_moves_frequencies(whole):
    kept = proposed(whole, 150)
    first = reduced(whole, kept)
    coarse = mass_on(whole, kept)
    motions = rigid_motions(whole.positions)[kept]
    for matrix in (first.mass, coarse):
        total = motions.T @ matrix @ motions
        assert total[:3, :3] == pytest.approx(np.eye(3) * mass_properties(whole).mass, abs=1e-6)
        exact = mass_properties(whole).matrix
        assert total[:3, 3:] == pytest.approx(exact[:3, 3:], abs=1e-6 * abs(exact).max())
    kinds = (eigh(first.stiffness, m, eigvals_only=True)[6] for m in (first.mass, coarse))
    consistent, cheap = (np.sqrt(value) / 2 / pi for value in kinds)
    assert cheap != pytest.approx(consistent, rel=1e-4) and cheap == pytest.approx(
        consistent, rel=0.2
    )


def test_retained_points_must_hold_the_rest(whole):
    with pytest.raises(StructureError, match="retain six at least that hold the structure"):
        reduced(whole, [0, 1, 2])
    with pytest.raises(StructureError, match="can be retained"):
        reduced(whole, [whole.degrees])


LUMP = Lump(900.0, (30.0, 200.0, 210.0), (0.4, 0.1, 0.5), tuple(range(40, 68)))


def test_lading_comes_out_with_its_mass_centre_and_inertia(whole):
    before, after = mass_properties(whole), mass_properties(laden(whole, [LUMP]))
    assert after.mass - before.mass == pytest.approx(900.0, rel=1e-12)
    moment = after.mass * after.centre - before.mass * before.centre
    assert moment == pytest.approx(900.0 * np.array(LUMP.centre), abs=1e-6)
    arm = np.array(LUMP.centre)
    own = np.diag(LUMP.inertia) + 900.0 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert (after.matrix - before.matrix)[3:, 3:] == pytest.approx(own, abs=1e-6)


def test_stiff_lading_leaves_rigid_motions_free_and_raises_frequencies(whole):
    lumps = [
        replace(LUMP, centre=(x, 0.0, 0.4), adjacent=near)
        for x, near in ((-1.0, tuple(range(14, 42))), (1.0, tuple(range(77, 105))))
    ]
    stiffness = (1e8, 1e8, 1e8, 1e7, 1e7, 1e7)
    soft, stiff = laden(whole, lumps), laden(whole, lumps, [Spring(0, 1, stiffness)])
    assert grounding(stiff).worst < 1e-6
    one, other = (free_modes(s, 5).frequencies for s in (soft, stiff))
    assert np.all(other >= one * (1 - 1e-9)) and other.max() > 0.99 * one.max()
    assert (other - one).max() > 0.01 * one.max()


def test_a_lump_needs_three_points_that_are_not_on_a_line(whole):
    with pytest.raises(StructureError, match="cannot ride on the nodes 1, 8"):
        laden(whole, [replace(LUMP, adjacent=(0, 7))])


def test_a_mechanism_is_named_by_what_moves():
    model = trough(half=False)
    loose = max(model.nodes) + 1
    nodes = {**model.nodes, loose: (2.0, 0.0, 1.0), loose + 1: (2.0, 0.3, 1.0)}
    swinging = [*model.elements, Element("beam", (loose, loose + 1), "beam", "loose")]
    structure = assembled(replace(model, nodes=nodes, elements=swinging))
    with pytest.raises(StructureError, match=r"is a mechanism: .* of node (120|121)"):
        free_modes(structure, 4)


def test_negative_stiffness_and_missing_mass_are_refused(whole):
    lumps = [
        replace(LUMP, centre=(x, 0.0, 0.4), adjacent=near)
        for x, near in ((-1.0, tuple(range(14, 42))), (1.0, tuple(range(77, 105))))
    ]
    pushing = laden(whole, lumps, [Spring(0, 1, (-1e9,) * 6)])
    with pytest.raises(
        StructureError, match=r"the stiffness is negative in a motion of .* of node"
    ):
        free_modes(pushing, 4)
    with pytest.raises(StructureError, match="its mass is 0 kg"):
        mass_properties(replace(whole, mass=csc_matrix(whole.mass.shape)))
