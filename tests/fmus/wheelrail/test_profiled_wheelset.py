"""A wheelset on profiles: the coned limit, circles on circles, flange, climb, balance, symmetry."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

import tolerances
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin
from fmus.errors import ParameterError
from fmus.wheelrail.block import CREEP_LAWS
from fmus.wheelrail.contact_table import ContactTable, as_text
from fmus.wheelrail.profiled import ProfiledWheelRail
from fmus.wheelrail.profiled_experiment import reference
from support.contact_tables import CLEARANCE, RADIUS, SPACING, circles, cone, cone_at

POISSON = 0.28
SIDES = {"left": 1, "right": -1}
FLANGE = np.radians(70.0)
TAPER = 0.05
CONE = {
    "conicity": TAPER,
    "rolling_radius": RADIUS,
    "half_contact_spacing": SPACING,
    "flange_clearance": CLEARANCE,
    "wheel_transverse_curvature": 0.0,
    "rail_transverse_radius": 0.254,
    "poisson_ratio": POISSON,
}
STATIC = parameter_set("loaded").entry("axle_load").to("N") / 2


def block(table, **more):
    return ProfiledWheelRail(table, POISSON, "profiled", **more)


def twin(made, law="linear", inputs=None, **changes):
    values = parameter_set("loaded").values(made)
    values |= {"creep_law": 1.0 + CREEP_LAWS.index(law), **changes}
    found = Twin(made, values, {"load_left": STATIC, "load_right": STATIC, **(inputs or {})})
    found.initialize()
    return found


def outputs(of):
    return dict(zip((v.name for v in of.block.outputs), of.outputs(), strict=True))


@pytest.fixture(scope="module")
def coned():
    return block(cone())


@pytest.fixture(scope="module")
def small():
    return block(cone(), small_angles=True)


@pytest.fixture(scope="module")
def round_wheels():
    return block(circles(0.4, 0.3, TAPER))


def scattered(rng, size=1.0):
    names = {"y": 5e-3, "yaw": 3e-3, "vy": 0.03, "wz": 0.02, "rail_y_left": 1e-3,
             "rail_y_right": 1e-3}  # fmt: skip
    return {name: size * scale * rng.uniform(-1, 1) for name, scale in names.items()}


@pytest.mark.parametrize("law", CREEP_LAWS)
def test_a_cone_of_small_angles_is_the_coned_wheelset(small, twin_of, rng, law):
    """All but l_over_v, in which the cone's own angle counts here."""
    for _ in range(6):
        motion = {**scattered(rng), "speed": 20.0, "load_left": STATIC, "load_right": STATIC}
        plain = outputs(twin_of("wheelrail", motion, creep_law=1.0 + CREEP_LAWS.index(law), **CONE))
        found = outputs(twin(small, law, motion))
        for name, value in plain.items():
            if "l_over_v" not in name:
                assert found[name] == pytest.approx(value, rel=1e-9, abs=1e-12), name


def test_full_angles_of_a_cone_differ_in_the_second_order(twin_of):
    """Halve the taper, and what cosines add to creep forces falls to a quarter."""
    motion = {"yaw": 1e-4, "wz": 1e-3, "speed": 20.0, "load_left": STATIC, "load_right": STATIC}
    gaps = []
    for taper in (0.2, 0.1):
        cones = {**CONE, "conicity": taper, "creep_law": 2.0}
        plain = twin_of("wheelrail", motion, **cones)
        full = twin(block(cone(taper, flange=None)), "kalker", motion)
        gaps.append(full.get("force_y") / plain.get("force_y") - 1)
    assert 1e-4 < abs(gaps[1]) < 1e-2
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.1)


def test_gravity_of_circles_on_circles_is_wickens(round_wheels):
    """Wickens, Fundamentals of Rail Vehicle Dynamics (2003): W/l epsilon, for small angles."""
    wheel, rail = 0.4, 0.3
    widening = (1 + wheel * TAPER / SPACING) / (1 - RADIUS * TAPER / SPACING)
    expected = 2 * STATIC / (wheel - rail) * widening
    found = twin(round_wheels, longitudinal_creep_coefficient=0.0, lateral_creep_coefficient=0.0)
    stiffness = -found.directional({"y": 1.0})[0]
    assert stiffness == pytest.approx(expected, rel=5e-3)


def test_a_free_wheelset_of_circles_winds_as_klingel_says(round_wheels):
    """With the equivalent conicity of circles in closed form, after Wickens."""
    wheel, rail, speed = 0.4, 0.3, 20.0
    conicity = TAPER * wheel / (wheel - rail)
    conicity *= (1 + rail * TAPER / SPACING) / (1 - RADIUS * TAPER / SPACING)
    found = twin(round_wheels, inputs={"speed": speed}, gravity_factor=0.0)
    columns = [found.directional({name: 1.0})[:2] for name in ("y", "yaw", "vy", "wz")]
    stiffness, damping = np.array(columns[:2]).T, np.array(columns[2:]).T
    roots = np.linalg.eigvals(-np.linalg.solve(damping, stiffness))
    length = 2 * np.pi * speed / abs(roots[0].imag)
    assert length == pytest.approx(2 * np.pi * np.sqrt(RADIUS * SPACING / conicity), rel=3e-3)


def test_contact_on_profiles_turns_freely_over_all_contacts(coned, rng):
    """Tread and flange at their own radii: the longitudinal forces hold no torque."""
    for law in CREEP_LAWS:
        for y in (3e-3, 9e-3):
            motion = {**scattered(rng, 0.3), "y": y, "speed": 15.0}
            found = outputs(twin(coned, law, motion))
            if y < CLEARANCE:
                shifts = [s * (y - motion[f"rail_y_{side}"]) for side, s in SIDES.items()]
                radii = [RADIUS + TAPER * shift for shift in shifts]
                torque = sum(r * found[f"{s}.force_x"] for r, s in zip(radii, SIDES, strict=True))
                assert abs(torque) < 1e-9 * STATIC * RADIUS
            else:
                assert found["left.flange_force"] > 0


@pytest.mark.parametrize("law", ["polach", "shen_hedrick_elkins", "fastsim"])
@pytest.mark.parametrize(("friction", "load"), [(0.3, 1.0), (0.5, 0.6)])
def test_a_flange_climbs_at_nadals_limit(coned, law, friction, load):
    """Wheel pushed far up under an angle of attack at which its creep is lateral and full."""
    borne = load * STATIC / (np.cos(FLANGE) + friction * np.sin(FLANGE))
    stiffness = parameter_set("loaded").entry("flange_stiffness", "wheelrail").to("N/m")
    pushed = CLEARANCE + borne * np.sin(FLANGE) / stiffness + 2e-3
    wheels = twin(
        coned,
        law,
        {"y": pushed, "yaw": 0.3, "speed": 15.0, "load_left": load * STATIC},
        friction_coefficient=friction,
        friction_ratio=1.0,
        slip_reduction=1.0,
        creep_reduction=1.0,
    )
    nadal = float(coned.functions.constants(wheels.p, wheels.d)[4])
    assert nadal == pytest.approx((np.tan(FLANGE) - friction) / (1 + friction * np.tan(FLANGE)))
    found = outputs(wheels)
    assert found["left.climb"] == pytest.approx(2e-3, rel=1e-2)
    assert found["left.l_over_v"] == pytest.approx(nadal, rel=tolerances.NADAL)
    assert found["left.normal_force"] == pytest.approx(0.0, abs=1e-9 * STATIC)


def test_past_its_tip_the_flange_holds_less(coned):
    found = [
        twin(coned, "polach", {"y": CLEARANCE + y, "yaw": 0.02, "speed": 15.0}).get("left.l_over_v")
        for y in (0.008, 0.012, 0.0165)
    ]
    assert found[2] < 0.6 * max(found[:2])


def test_before_it_climbs_the_flange_is_the_rails_spring(coned):
    """The lateral part of its normal force is the rail's stiffness times what it gives way."""
    stiffness = parameter_set("loaded").entry("flange_stiffness", "wheelrail").to("N/m")
    wheels = twin(coned, "linear", {"y": CLEARANCE + 1e-3})
    assert wheels.get("left.flange_force") * np.sin(FLANGE) == pytest.approx(stiffness * 1e-3)
    carried = wheels.get("left.flange_force") * np.cos(FLANGE)
    slope = np.arctan(TAPER * (1 + CLEARANCE / SPACING))
    assert wheels.get("left.normal_force") * np.cos(slope) == pytest.approx(STATIC - carried)


@pytest.mark.parametrize("law", CREEP_LAWS)
def test_left_and_right_mirror_each_other(coned, rng, law):
    for y in (4e-3, 9.5e-3):
        motion = {**scattered(rng), "y": y, "rail_y_left": 0.0, "load_left": 0.8 * STATIC}
        mirrored = {name: -value for name, value in motion.items() if "load" not in name}
        mirrored |= {"rail_y_left": -motion["rail_y_right"], "rail_y_right": 0.0}
        mirrored |= {"load_left": STATIC, "load_right": 0.8 * STATIC}
        one, other = (outputs(twin(coned, law, m)) for m in (motion, mirrored))
        for name in ("force_y", "moment_z", "y_rel"):
            assert one[name] == pytest.approx(-other[name], rel=1e-9, abs=1e-9)
        for name in ("force_x", "l_over_v", "normal_force", "flange_force", "climb"):
            assert one[f"left.{name}"] == pytest.approx(other[f"right.{name}"], rel=1e-9, abs=1e-9)


@pytest.fixture(scope="module")
def unlike():
    """Cones of unlike taper, radius and flange, and the same with left and right exchanged."""
    left = cone()
    right = larger(cone(0.1, flange=np.radians(65.0)), 2e-4)
    return block(replace(left, right=right)), block(replace(right, right=left))


def larger(table: ContactTable, radius: float) -> ContactTable:
    """With more radius [m] at the tape circle, and the same nominal one."""
    patches = {n: replace(p, radius=p.radius + radius) for n, p in table.patches().items()}
    return replace(table, **patches)


@pytest.mark.parametrize("law", CREEP_LAWS)
def test_wheels_that_change_sides_give_the_mirrored_forces(unlike, rng, law):
    for y in (4e-3, 9.5e-3, -9.5e-3):
        motion = {**scattered(rng), "y": y, "rail_y_left": 0.0, "load_left": 0.8 * STATIC}
        mirrored = {name: -value for name, value in motion.items() if "load" not in name}
        mirrored |= {"rail_y_left": -motion["rail_y_right"], "rail_y_right": 0.0}
        mirrored |= {"load_left": STATIC, "load_right": 0.8 * STATIC}
        given = zip(unlike, (motion, mirrored), strict=True)
        one, other = (outputs(twin(made, law, moved)) for made, moved in given)
        for name in ("force_y", "moment_z", "y_rel"):
            assert one[name] == pytest.approx(-other[name], rel=1e-9, abs=1e-9)
        for side, opposite in (("left", "right"), ("right", "left")):
            for name in ("force_x", "l_over_v", "normal_force", "flange_force", "climb"):
                expected = other[f"{opposite}.{name}"]
                assert one[f"{side}.{name}"] == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_unlike_cones_roll_where_their_radii_are_equal_and_wind_about_there(unlike):
    """At y0 = (r_right - r_left)/(alpha_left + alpha_right), as Klingel's cones of their mean."""
    tapers, speed = (TAPER, 0.1), 20.0
    line = 2e-4 / sum(tapers)
    made = twin(unlike[0], inputs={"y": line, "speed": speed}, gravity_factor=0.0)
    found = outputs(made)
    assert found["moment_z"] == pytest.approx(0.0, abs=1e-6)
    assert found["left.creep_x"] == pytest.approx(0.0, abs=1e-12)
    columns = [made.directional({name: 1.0})[:2] for name in ("y", "yaw", "vy", "wz")]
    stiffness, damping = np.array(columns[:2]).T, np.array(columns[2:]).T
    roots = np.linalg.eigvals(-np.linalg.solve(damping, stiffness))
    length = 2 * np.pi * speed / abs(roots[0].imag)
    wave = 2 * np.pi * np.sqrt(RADIUS * SPACING / np.mean(tapers))
    assert length == pytest.approx(wave, rel=2e-3)


def test_constants_of_unlike_sides_are_those_of_the_worse_one(unlike):
    made = unlike[0]
    wheels = twin(made)
    found = dict(
        zip(
            (c.name for c in made.constants),
            made.functions.constants(wheels.p, wheels.d).full().ravel(),
            strict=True,
        )
    )
    assert found["flange_angle"] == pytest.approx(np.radians(65.0))
    assert found["flange_clearance"] == pytest.approx(CLEARANCE)


def test_creep_takes_the_power_that_motion_and_train_give(coned, rng):
    """What the forces on the wheelset take from its motion is what slips in the contacts: a
    wheelset that turns freely is drawn by V times the yawed lateral force."""
    for _ in range(5):
        motion = {**scattered(rng), "speed": 20.0}
        found = outputs(twin(coned, "shen_hedrick_elkins", motion, shear_modulus=82e9))
        shifts = {s: sign * (motion["y"] - motion[f"rail_y_{s}"]) for s, sign in SIDES.items()}
        lateral = motion["vy"] - 20.0 * motion["yaw"]
        slipped = given = 0.0
        for side, sign in SIDES.items():
            angle = np.arctan(TAPER * (1 + shifts[side] / SPACING))
            slipped += 20.0 * found[f"{side}.force_x"] * found[f"{side}.creep_x"]
            slipped += 20.0 * found[f"{side}.force_y"] / np.cos(angle) * found[f"{side}.creep_y"]
            arm = SPACING - shifts[side]
            given += found[f"{side}.force_x"] * (20.0 - sign * arm * motion["wz"])
            given += found[f"{side}.force_y"] * lateral / np.cos(angle) ** 2
        assert slipped < 0
        assert slipped == pytest.approx(given, rel=1e-5)  # the rotation's root is so near


@pytest.mark.parametrize("y", [3e-3, 8.6e-3, -0.0195])
def test_derivatives_are_exact_on_tread_flange_and_climb(coned, y):
    motion = {"y": y, "yaw": 2e-3, "vy": 0.01, "wz": 5e-3, "speed": 15.0}
    wheels = twin(coned, "polach", motion)
    for name, step in (("y", 1e-8), ("yaw", 1e-8), ("vy", 1e-7), ("load_left", 1e-1)):
        exact = wheels.directional({name: 1.0})
        ends = [twin(coned, "polach", {**motion, name: wheels.u[wheels._input[name]] + s}).outputs()
                for s in (step, -step)]  # fmt: skip
        found = (ends[0] - ends[1]) / (2 * step)
        assert exact == pytest.approx(found, rel=2e-4, abs=1e-6 * np.abs(found).max())


@pytest.fixture(scope="module")
def over_yaw():
    return block(replace(cone_at(0.0), yawed={yaw: cone_at(yaw) for yaw in (0.01, 0.02)}))


def test_between_its_yaw_angles_a_table_is_that_of_the_yaw(coned, over_yaw):
    """Tread, flange that only a yawed wheel has on its rail, climb. To the square of the yaw, which
    a table of one yaw leaves out between contact plane and axle."""
    at_yaw = block(cone_at(0.015))
    for y, law in ((4e-3, "linear"), (7.98e-3, "polach"), (0.0195, "linear"), (0.0195, "polach")):
        motion = {"y": y, "yaw": 0.017, "path_yaw": 0.002, "vy": 0.01, "speed": 15.0}
        found, expected = (
            outputs(twin(made, law, motion, gravity_yaw=1.0)) for made in (over_yaw, at_yaw)
        )
        assert found["yaw_rel"] == pytest.approx(0.015)
        for name, value in expected.items():
            largest = STATIC if "force" in name or "moment" in name else 1.0
            assert found[name] == pytest.approx(value, rel=1e-3, abs=1e-6 * largest), name
        straight = outputs(twin(coned, law, motion))
        assert found["left.clearance"] == pytest.approx(straight["left.clearance"] - 5.4e-5)
    assert found["left.climb"] > 1e-3


@pytest.mark.parametrize("y", [7.98e-3, 0.0195])
def test_derivatives_by_yaw_are_exact_in_a_table_over_yaw(over_yaw, y):
    motion = {"y": y, "yaw": 0.013, "vy": 0.01, "wz": 5e-3, "speed": 15.0}
    exact = twin(over_yaw, "polach", motion).directional({"yaw": 1.0})
    ends = [twin(over_yaw, "polach", {**motion, "yaw": 0.013 + s}).outputs() for s in (1e-8, -1e-8)]
    found = (ends[0] - ends[1]) / 2e-8
    assert exact == pytest.approx(found, rel=2e-4, abs=1e-6 * np.abs(found).max())


def test_known_results_stay_within_the_yaw_of_the_table():
    narrow = block(replace(cone_at(0.0), yawed={yaw: cone_at(yaw) for yaw in (5e-4, 1e-3)}))
    values = parameter_set("loaded").values(narrow)
    known = reference(narrow, {**values, "creep_law": 1.0})
    stimuli = np.genfromtxt(BytesIO(known.tables["stimuli"]), delimiter=",", names=True)
    assert 5e-4 < np.abs(stimuli["yaw"]).max() <= 1e-3


def test_a_table_holds_for_the_yaw_that_it_has(coned, over_yaw):
    for made, largest in (
        (coned, 0.02),
        (over_yaw, 0.02),
        (block(replace(cone_at(0.0), yawed={0.05: cone_at(0.05)})), 0.05),
    ):
        (limit,) = (limit for limit in made.limits if limit.name == "yaw")
        assert (limit.least, limit.largest) == (-largest, largest)


def test_a_wheel_without_a_flange_holds_for_its_tread_and_has_no_flange_to_be_told_of(coned):
    bare = block(replace(cone(), flange=None))
    flanged = {limit.name for limit in coned.limits}
    assert {limit.name for limit in bare.limits} ^ flanged == {
        "flange", "off_the_flange", "off_the_tread",
    }  # fmt: skip
    (end,) = (limit for limit in bare.limits if limit.name == "off_the_tread")
    assert end.void and end.least == 0.0 and "without a flange" in end.beyond


def test_what_makes_no_table_is_refused():
    good = cone()
    with pytest.raises(ParameterError, match="from 0"):
        ContactTable("late", RADIUS, good.tread, good.tread)
    with pytest.raises(ParameterError, match="both sides of shift 0"):
        ContactTable("one-sided", RADIUS, good.flange)
    with pytest.raises(ParameterError, match="89"):
        cone(flange=np.radians(90.0))
    with pytest.raises(ParameterError, match="sum of the two curvatures"):
        cone(wheel_curvature=-5.0)
    with pytest.raises(ParameterError, match="above zero, rising"):
        replace(good, yawed={-0.01: good})
    with pytest.raises(ParameterError, match="other nodes, patches or another radius"):
        replace(good, yawed={0.01: cone(flange=None)})
    with pytest.raises(ParameterError, match="on the right than on the left; give the same ones"):
        replace(good, right=cone(flange=None))
    assert as_text(good).count("\n") == 2 + 1 + good.tread.over.size + good.flange.over.size
