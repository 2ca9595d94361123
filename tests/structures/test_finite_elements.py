"""Each kind of element against a closed form: patches, plates, beams, bars, torsion, taper."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from structures.beam_estimate import bending_frequency
from structures.elements import assembled, parts_of
from structures.errors import StructureError
from structures.free_modes import free_modes
from structures.model import Beam, Element, Mass, Material, Model, Plate
from structures.rigid import grounding, mass_properties, properties_of_parts

STEEL = Material(2.0e11, 0.3, 7850.0)
NO_CONTRACTION = replace(STEEL, poisson=0.0)
SKEWED = {
    1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0), 3: (2.0, 0.0, 0.0),
    4: (0.0, 1.1, 0.0), 5: (1.2, 0.8, 0.0), 6: (2.0, 1.0, 0.0),
    7: (0.0, 2.0, 0.0), 8: (0.9, 2.0, 0.0), 9: (2.0, 2.0, 0.0),
}  # fmt: skip
"""A patch of skewed quadrilaterals about node 5."""

STRAIGHT = {n: (float((n - 1) % 3), float((n - 1) // 3), 0.0) for n in SKEWED}
"""The same patch of squares. Skewed quadrilaterals of pyfe3d bend with up to 1.5 % of force."""

QUADS = ((1, 2, 5, 4), (2, 3, 6, 5), (4, 5, 8, 7), (5, 6, 9, 8))


def patch(kind: str, nodes=None) -> Model:
    shells = [
        part
        for a, b, c, d in QUADS
        for part in ([(a, b, c, d)] if kind == "quad" else [(a, b, c), (a, c, d)])
    ]
    plate = {"plate": Plate(0.01, STEEL)}
    return Model(kind, nodes or SKEWED, plate, [Element(kind, nodes, "plate") for nodes in shells])


def square(
    count: int,
    side: float = 1.0,
    material: Material = STEEL,
    turned=((1, 0, 0), (0, 1, 0), (0, 0, 1)),
) -> Model:
    """A plate of count x count quadrilaterals, thickness a hundredth of the side."""
    places = np.linspace(0.0, side, count + 1)
    nodes = {
        1 + i + (count + 1) * j: tuple(np.array(turned) @ [places[i], places[j], 0.0])
        for j in range(count + 1)
        for i in range(count + 1)
    }
    corners = (
        (n, n + 1, n + count + 2, n + count + 1)
        for j in range(count)
        for n in range(1 + (count + 1) * j, 1 + (count + 1) * j + count)
    )
    plate = {"plate": Plate(side / 100, material)}
    return Model("square", nodes, plate, [Element("quad", four, "plate") for four in corners])


def line(count: int, length: float, section: Beam, kind: str = "beam", axis=(1.0, 0.0, 0.0)):
    nodes = {n + 1: tuple(np.array(axis) * length * n / count) for n in range(count + 1)}
    pairs = [Element(kind, (n, n + 1), "beam") for n in range(1, count + 1)]
    return Model("line", nodes, {"beam": section}, pairs)


def deflected(model: Model, held, force: dict[int, float]) -> np.ndarray:
    structure = assembled(model)
    free = np.setdiff1d(np.arange(structure.degrees), held)
    load = np.zeros(structure.degrees)
    for degree, value in force.items():
        load[degree] = value
    moved = np.zeros(structure.degrees)
    moved[free] = spsolve(structure.stiffness[free][:, free].tocsc(), load[free])
    return moved


FIELDS = {
    "stretched": lambda x, y: (1e-3 * x, 0, 0, 0, 0, 0),
    "sheared": lambda x, y: (2e-3 * y, 0, 0, 0, 0, -1e-3),
    "turned": lambda x, y: (-1e-3 * y, 1e-3 * x, 0, 0, 0, 1e-3),
    "bent": lambda x, y: (0, 0, 5e-4 * x * x, 0, -1e-3 * x, 0),
    "twisted": lambda x, y: (0, 0, 1e-3 * x * y, 1e-3 * x, -1e-3 * y, 0),
}


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("kind", ["quad", "triangle"])
def test_a_patch_of_shells_carries_a_constant_strain_without_force_inside(kind, field):
    model = patch(kind, STRAIGHT if field in ("bent", "twisted") else SKEWED)
    structure = assembled(model)
    motion = np.concatenate([FIELDS[field](x, y) for x, y, _ in model.positions])
    force = structure.stiffness @ motion
    around = np.abs(structure.stiffness) @ np.abs(motion)
    inner = slice(6 * 4, 6 * 5)
    assert np.abs(force[inner]).max() < 1e-6 * around[inner].max()


def test_a_stretched_patch_holds_the_energy_of_plane_stress():
    structure = assembled(patch("quad"))
    motion = np.zeros(structure.degrees)
    motion[0::6] = 1e-3 * structure.positions[:, 0]
    energy = motion @ structure.stiffness @ motion / 2
    expected = 0.5 * STEEL.young / (1 - 0.3**2) * 1e-6 * 0.01 * 4.0
    assert energy == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_simply_supported_plate_sinks_as_timoshenko_says(turn):
    """0.00406 q a^4/D in the middle of a square plate (Timoshenko, Woinowsky-Krieger, table 8)."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    count = 16
    model = square(count, turned=turned)
    flat = square(count).positions
    edge = np.flatnonzero(np.isclose(flat[:, :2], 0).any(1) | np.isclose(flat[:, :2], 1).any(1))
    structure = assembled(model)
    across = turned @ [0.0, 0.0, 1.0]
    stiff = 1e14  # holds the edges square to the plate
    held = np.zeros((structure.degrees, len(edge)))
    for column, node in enumerate(edge):
        held[6 * node : 6 * node + 3, column] = across
    matrix = structure.stiffness.toarray() + stiff * held @ held.T
    for node in edge:  # and the plate in its plane
        matrix[6 * node : 6 * node + 3, 6 * node : 6 * node + 3] += 1e9 * np.eye(3)
    load = np.zeros(structure.degrees)
    for node in range(len(flat)):
        if node not in edge:
            load[6 * node : 6 * node + 3] = across / count**2
    moved = np.linalg.solve(matrix, load).reshape(-1, 6)
    middle = moved[(count // 2) * (count + 1) + count // 2, :3] @ across
    rigidity = STEEL.young * 0.01**3 / (12 * (1 - 0.3**2))
    assert middle == pytest.approx(0.00406 / rigidity, rel=0.02)


def test_cantilever_sinks_turns_twists_and_stretches_as_its_section_says():
    section = Beam(2e-3, 4e-6, 1e-6, 5e-7, STEEL)
    length, force = 2.0, 1000.0
    model = line(4, length, section)
    tip = 6 * 4
    held = range(6)
    young, shear = STEEL.young, STEEL.shear
    slender = {1: force * length**3 / (3 * young * 1e-6), 2: force * length**3 / (3 * young * 4e-6)}
    for direction, expected in slender.items():
        moved = deflected(model, held, {tip + direction: force})
        assert moved[tip + direction] == pytest.approx(expected, rel=0.01)
    moved = deflected(model, held, {tip + 3: force, tip: force})
    assert moved[tip + 3] == pytest.approx(force * length / (shear * 5e-7), rel=1e-9)
    assert moved[tip] == pytest.approx(force * length / (young * 2e-3), rel=1e-9)


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, 1.0, 0.0)])
def test_a_beam_is_strong_in_the_plane_of_up(axis):
    section = Beam(2e-3, 4e-6, 1e-6, 5e-7, STEEL)
    up = (0.0, 0.0, 1.0) if axis[2] < 1 else (0.0, 1.0, 0.0)
    model = line(2, 1.0, section, axis=axis)
    model = replace(model, elements=[replace(e, up=up) for e in model.elements])
    along = np.array(axis)
    strong = np.array(up) - (np.array(up) @ along) * along
    strong /= np.linalg.norm(strong)
    for direction, second in ((strong, 4e-6), (np.cross(along, strong), 1e-6)):
        force = {12 + i: float(value) for i, value in enumerate(direction)}
        moved = deflected(model, range(6), force)[12:15] @ direction
        assert moved == pytest.approx(1 / (3 * STEEL.young * second), rel=0.02)


@pytest.mark.parametrize("kind", ["bar", "beam"])
def test_bars_stretch_by_their_area(kind):
    model = line(1, 3.0, Beam(1e-3, 1e-8, 1e-8, 1e-8, STEEL), kind)
    moved = deflected(model, [*range(6), *range(7, 12)], {6: 1e4})
    assert moved[6] == pytest.approx(1e4 * 3.0 / (STEEL.young * 1e-3), rel=1e-9)


def test_a_tapered_bar_stretches_as_the_logarithm_of_its_areas():
    small = Beam(1e-3, 1e-7, 1e-7, 1e-7, STEEL)
    section = replace(small, area=3e-3, end=small)
    moved = deflected(line(1, 2.0, section), range(6), {6: 1e4})
    expected = 1e4 * 2.0 / (STEEL.young * 2e-3) * log(3.0)
    assert moved[6] == pytest.approx(expected, rel=3e-3)
    mass, centre = properties_of_parts(parts_of(line(1, 2.0, section)))
    assert mass == pytest.approx(7850 * 2e-3 * 2.0, rel=1e-9)
    assert centre[0] == pytest.approx(2.0 * (3 + 2 * 1) / (3 * (3 + 1)), rel=5e-3)


def test_free_beam_rings_as_its_closed_form():
    section = Beam(2e-3, 4e-6, 1e-6, 5e-7, STEEL)
    found = free_modes(assembled(line(24, 6.0, section)), 4).frequencies
    mass = 7850 * 2e-3
    weak = bending_frequency(STEEL.young, 1e-6, mass, 6.0)
    strong = bending_frequency(STEEL.young, 4e-6, mass, 6.0)
    assert sorted(found)[0] == pytest.approx(weak, rel=0.01)
    assert min(abs(found / strong - 1)) < 0.01


def test_a_tube_of_plates_rings_as_a_beam():
    """A flat free sheet of pyfe3d's quadrilaterals folds without force; folded ones cannot."""
    side, thickness, length, cells = 0.1, 0.002, 4.0, 40
    corners = ((0.0, 0.0), (side, 0.0), (side, side), (0.0, side))
    nodes = {
        1 + 4 * i + j: (length * i / cells, y, z)
        for i in range(cells + 1)
        for j, (y, z) in enumerate(corners)
    }
    shells = [
        Element("quad", (1 + n + j, 5 + n + j, 5 + n + (j + 1) % 4, 1 + n + (j + 1) % 4), "plate")
        for n in range(0, 4 * cells, 4)
        for j in range(4)
    ]
    model = Model("tube", nodes, {"plate": Plate(thickness, NO_CONTRACTION)}, shells)
    found = free_modes(assembled(model), 3).frequencies
    second = 2 / 3 * thickness * side**3
    expected = bending_frequency(2.0e11, second, 7850 * 4 * side * thickness, length)
    assert found[:2] == pytest.approx([expected] * 2, rel=0.01)


def test_the_reports_factor_69_of_its_beam_formula_is_69_97():  # erratum 19
    young, second, weight, length = 29e6, 3.0e4, 80.0, 517.0
    inch, pound_force = 0.0254, 4.4482216152605
    mass = weight * pound_force / inch / 9.80665
    si = bending_frequency(young * pound_force / inch**2, second * inch**4, mass, length * inch)
    factor = si / np.sqrt(young * second / (weight * length**4))
    assert factor == pytest.approx(69.97, abs=0.005)


def test_mass_and_centre_are_those_of_the_parts():
    model = replace(square(6), masses=[Mass(1, 20.0, (1.0, 1.0, 1.0))])
    found = mass_properties(assembled(model))
    mass, centre = properties_of_parts(parts_of(model))
    assert found.mass == pytest.approx(mass, rel=1e-9)
    assert found.centre == pytest.approx(centre, abs=1e-9)


NODES = {1: (0.0, 0.0, 0.0), 2: (1.0, 0.0, 0.0), 3: (1.0, 1.0, 0.0), 4: (0.0, 1.0, 0.0)}
PLATE = {"plate": Plate(0.01, STEEL)}
WHOLE = Element("quad", (1, 2, 3, 4), "plate", "floor")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"nodes": NODES | {9: (3.0, 0.0, 0.0), 8: (4.0, 0.0, 0.0)}},
            "wrong: 2 nodes belong to no element (9, 8): connect them, or leave them out",
        ),
        (
            {"elements": [replace(WHOLE, nodes=(1, 2, 3, 7))]},
            "wrong: element 1 (quad, floor) refers to node 7, which there is not",
        ),
        (
            {"elements": [replace(WHOLE, section="steel")]},
            "wrong: element 1 (quad, floor) refers to section 'steel'; the sections are plate",
        ),
        (
            {"elements": [WHOLE, Element("beam", (1, 2), "plate", "sill")]},
            "wrong: element 2 (beam, sill) needs a beam section; 'plate' is none",
        ),
        (
            {"elements": [replace(WHOLE, nodes=(1, 2, 3))]},
            "wrong: element 1 (quad, floor) has 3 nodes; it needs 4",
        ),
        (
            {"sections": {"plate": Plate(0.0, STEEL)}},
            "wrong: section 'plate' has the thickness 0; it must be above 0",
        ),
        (
            {"masses": [Mass(5, 10.0)]},
            "wrong: a mass of 10 kg is on node 5, which there is not",
        ),
        (
            {"sections": {"plate": Plate(10.0, Material(2.0e5, 0.3, 7.85e-9))}},
            "wrong: section 'plate' has Young's modulus 200000 Pa and density 7.85e-09 kg/m3: "
            "these are not SI. Steel has Young's modulus 2e+11 in m, kg, N; 2.9e+07 in in, "
            "lb*s2/in, lbf; 200000 in mm, t, N; say the model's units",
        ),
        ({"elements": []}, "wrong: there are no elements; a structure needs some"),
        (
            {"nodes": NODES | {3: (1.0, float("nan"), 0.0)}},
            "wrong: node 3 lies at (1.0, nan, 0.0); give x, y, z as numbers",
        ),
        ({"places": {"front": 9}}, "wrong: the place front is node 9, which there is not"),
        (
            {"nodes": NODES | {3: (0.1, 0.1, 0.0)}},
            "wrong: element 1 (quad, floor) on nodes (1, 2, 3, 4) is not convex: give its corners "
            "in order around it, or cut it into triangles",
        ),
        (
            {"sections": PLATE | {"sill": Beam(0.01, -1e-6, 1e-6, 1e-6, STEEL)}},
            "wrong: section 'sill' has second_y -1e-06; it is not below 0",
        ),
        (
            {
                "sections": PLATE | {"sill": Beam(0.01, 1e-6, 1e-6, 1e-6, STEEL)},
                "elements": [WHOLE, Element("beam", (1, 2), "sill", up=(1.0, 0.0, 0.0))],
            },
            "wrong: element 2 (beam) on nodes (1, 2) has its up (1.0, 0.0, 0.0) along itself; "
            "give another",
        ),
        (
            {"masses": [Mass(1, float("nan"))]},
            "wrong: the mass on node 1 is nan kg with inertias (0.0, 0.0, 0.0); they are numbers "
            "from 0",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_is_named_with_its_place(change, message):
    given = {"nodes": NODES, "sections": PLATE, "elements": [WHOLE]} | change
    with pytest.raises(StructureError) as caught:
        Model("wrong", **given)
    assert str(caught.value) == message


FLAT = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.1, 0.9, 0.0), (0.0, 1.0, 0.0))
WARPED = (*FLAT[:2], (1.1, 0.9, 0.2), FLAT[3])


@pytest.mark.parametrize("corners", [FLAT, WARPED])
def test_a_quadrilateral_has_no_motion_without_stiffness_but_the_six_rigid_ones(corners):
    nodes = dict(enumerate(corners, start=1))
    structure = assembled(Model("one", nodes, PLATE, [replace(WHOLE, part="")]))
    own = np.linalg.eigvalsh(structure.stiffness.toarray())
    assert np.abs(own[:6]).max() < 1e-12 * own[-1]
    assert own[6] > 1e-7 * own[-1]
    assert grounding(structure).degrees == ()


@pytest.mark.parametrize("count", [5, 9])
def test_a_free_plate_rings_as_leissa_says(count):
    """Square, free all around, Poisson 0.3: w a^2 sqrt(rho h/D) = 13.489, 19.789, 24.432.

    A. W. Leissa, The free vibration of rectangular plates, Journal of Sound and Vibration 31, 1973.
    """
    model = square(count)
    h = 0.01
    stiffness = STEEL.young * h**3 / (12 * (1 - STEEL.poisson**2))
    wanted = np.array([13.489, 19.789, 24.432]) / (2 * pi) * np.sqrt(stiffness / STEEL.density / h)
    found = free_modes(assembled(model), 3).frequencies
    assert found == pytest.approx(wanted, rel=2.5 / count**2)


@pytest.mark.parametrize("count", [3, 90])
def test_a_chain_of_bars_is_a_mechanism(count):
    """Found by dense matrices, and by sparse ones."""
    nodes = {n: (float(n), 0.0, 0.0) for n in range(count)}
    bars = [Element("bar", (n, n + 1), "bar") for n in range(count - 1)]
    model = Model("chain", nodes, {"bar": Beam(1e-3, 1e-6, 1e-6, 1e-6, STEEL)}, bars)
    with pytest.raises(StructureError, match="chain is a mechanism: "):
        free_modes(assembled(model), 2)


def test_one_point_mass_is_no_structure_with_inertia():
    light = {"plate": Plate(0.01, replace(STEEL, density=0.0))}
    model = Model("light", NODES, light, [WHOLE], [Mass(1, 10.0)])
    with pytest.raises(StructureError, match="its 10 kg have no inertia about some axis"):
        free_modes(assembled(model), 2)


def test_first_bending_wave_number_is_that_of_the_free_beam():
    assert bending_frequency(1.0, 1.0, 1.0, 1.0) == pytest.approx(22.3733 / (2 * pi), rel=1e-5)
