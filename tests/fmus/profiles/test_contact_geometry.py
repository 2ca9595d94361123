"""Contact geometry against closed forms: cones and circles on circles, mirrored, yawed."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq, root

from fmus.errors import ParameterError
from fmus.profiles.conicity import RadiusDifference
from fmus.profiles.flange import flange_of
from fmus.profiles.geometry import (
    Track,
    Wheelset,
    climbing_geometry,
    contact_geometry,
    level_difference,
)
from fmus.profiles.profile import Profile
from fmus.profiles.shapes import shape, shapes
from fmus.profiles.tables import contact_table, flange_begins
from fmus.wheelrail.columns import KINEMATIC, Columns
from fmus.wheelrail.contact_table import as_text, of_text

RADIUS, SPACING, GAUGE = 0.46, 1.5, 1.435
SHIFTS = np.linspace(-8e-3, 8e-3, 33)


def cone(taper: float) -> Profile:
    y = np.linspace(-0.06, 0.06, 241)
    return Profile("wheel", f"cone of {taper}", np.column_stack([y, taper * y]))


def hollow(taper: float, radius: float) -> Profile:
    """A circle about a centre below the tread; its tangent at the tape circle has the taper."""
    y = np.linspace(-0.06, 0.06, 481)
    turn = np.arcsin(np.sin(np.arctan(taper)) - y / radius)
    z = radius * (np.cos(turn) - np.cos(turn[240]))
    return Profile("wheel", "hollow", np.column_stack([y, z]))


def round_rail(radius: float) -> Profile:
    angle = np.linspace(-1.2, 1.2, 4001) * min(1.0, 0.03 / radius)
    points = radius * np.column_stack([np.sin(angle), np.cos(angle) - 1])
    return Profile("rail", f"round {radius}", points)


def on_circles(taper: float, radius: float, centre: float, shift: np.ndarray):
    """Roll, and radius left and right, of cones on circles whose tops are at +-centre."""
    steep = np.hypot(1.0, taper)
    const = -radius * steep - RADIUS - taper * SPACING / 2
    roll = np.zeros_like(shift)
    for _ in range(20):
        c, s = np.cos(roll), np.sin(roll)
        down = (const + taper * centre * c - shift * s) / c
        roll = np.arctan(taper * shift / (centre + taper * down))
    c, s = np.cos(roll), np.sin(roll)
    heights = [-sign * (centre - sign * shift) * s + down * c for sign in (1, -1)]
    return roll, *(-(height + radius / steep) for height in heights)


@pytest.mark.parametrize("crown", [0.012, 0.3])
def test_cones_on_circles_roll_and_grow_as_in_closed_form(crown):
    rail = round_rail(crown)
    width = float(np.ptp(rail.points[:, 0])) / 2
    geometry = contact_geometry(
        Wheelset(cone(0.05), RADIUS, SPACING), Track(rail, GAUGE, 1.0), SHIFTS
    )
    roll, left, right = on_circles(0.05, crown, GAUGE / 2 + width, SHIFTS)
    np.testing.assert_allclose(geometry.roll, roll, atol=1e-12)
    np.testing.assert_allclose(geometry.left.radius, left, atol=1e-12)
    np.testing.assert_allclose(geometry.right.radius, right, atol=1e-12)
    np.testing.assert_allclose(geometry.left.angle, np.arctan(0.05) + roll, atol=1e-12)
    np.testing.assert_allclose(geometry.left.rail_curvature, 1 / crown, rtol=1e-5)
    assert np.abs(geometry.left.wheel_curvature).max() < 1e-8
    assert geometry.jumps == ()


def on_circles_unlike(tapers, radii, crown: float, centre: float, shift: float):
    """Roll, and radius left and right, of two unlike cones on circles: of each line the distance
    from the circle's centre is the circle's radius."""
    below = [np.hypot(1.0, taper) for taper in tapers]

    def centres(roll, lift):
        c, s = np.cos(roll), np.sin(roll)
        for sign in (1, -1):
            across, up = sign * centre - shift, -crown - lift
            yield sign * (across * c + up * s), -across * s + up * c

    def misses(q):
        sides = zip(centres(*q), tapers, radii, below, strict=True)
        return [
            taper * (y - SPACING / 2) - radius - z - crown * steep
            for (y, z), taper, radius, steep in sides
        ]

    roll, lift = root(misses, [0.0, RADIUS], tol=1e-14).x
    ends = [-(z + crown / steep) for (_, z), steep in zip(centres(roll, lift), below, strict=True)]
    return roll, *ends


TAPERS, RADII = (0.04, 0.07), (RADIUS, RADIUS - 1.5e-4)


@pytest.fixture(scope="module")
def unlike():
    """Cones of unlike taper and radius on round rails, and their table."""
    rail = round_rail(0.3)
    wheelset = Wheelset(cone(TAPERS[0]), RADII[0], SPACING, cone(TAPERS[1]), RADII[1])
    track = Track(rail, GAUGE, 1.0)
    return wheelset, track, contact_table(wheelset, track)


def test_a_table_of_unlike_cones_has_both_sides_in_closed_form(unlike):
    _, track, table = unlike
    centre = GAUGE / 2 + float(np.ptp(track.left.points[:, 0])) / 2
    assert table.rolling_radius == pytest.approx(np.mean(RADII))
    assert table.name == "cone of 0.04 on round 0.3, right cone of 0.07 on round 0.3"
    for shift in (-6e-3, 0.0, 5e-3):
        roll, *radii = on_circles_unlike(TAPERS, RADII, 0.3, centre, shift)
        for sign, own, radius in zip((1, -1), table.different, radii, strict=True):
            row = np.abs(own.tread.over - sign * shift).argmin()
            assert own.tread.roll[row] == pytest.approx(sign * roll, abs=1e-11)
            assert own.tread.radius[row] == pytest.approx(radius, abs=1e-11)


def test_unlike_cones_run_where_radii_are_equal_in_closed_form(unlike):
    _, track, table = unlike
    centre = GAUGE / 2 + float(np.ptp(track.left.points[:, 0])) / 2

    def difference(shift):
        _, left, right = on_circles_unlike(TAPERS, RADII, 0.3, centre, shift)
        return left - right

    line, found = brentq(difference, -0.01, 0.01), RadiusDifference.of_table(table)
    assert found.middle == pytest.approx(line, abs=1e-7)
    assert abs(line) > 5e-3
    slope = (difference(line + 1e-3) - difference(line - 1e-3)) / 2e-3
    assert found.by_integration(1e-3) == pytest.approx(slope / 2, rel=1e-4)


def test_the_table_of_a_mirrored_wheelset_has_its_sides_exchanged(unlike):
    wheelset, track, table = unlike
    other = contact_table(wheelset.mirrored, track.mirrored)
    for one, mirrored in zip(table.different, other.different[::-1], strict=True):
        for name, column in one.tread.columns().items():
            np.testing.assert_allclose(getattr(mirrored.tread, name), column, atol=1e-13)


def test_sides_that_are_given_alike_have_one_table_to_the_bit():
    track = Track(round_rail(0.3), GAUGE, 1.0)
    plain = contact_table(Wheelset(cone(0.05), RADIUS, SPACING), track)
    both = contact_table(Wheelset(cone(0.05), RADIUS, SPACING, cone(0.05)), track)
    assert plain.different == (plain,)
    for own in both.different:
        assert as_text(replace(own, name=plain.name, said=plain.said)) == as_text(plain)


def test_unlike_sides_come_back_from_their_text(unlike):
    table = unlike[2]
    again = of_text(as_text(table))
    assert as_text(again) == as_text(table)
    assert [own.clearance for own in again.different] == [own.clearance for own in table.different]


def test_a_flange_on_one_side_alone_is_refused():
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    with pytest.raises(ParameterError, match="one wheel has a flange and the other has none"):
        contact_table(Wheelset(shape("conical"), 0.4191, 1.5113, cone(0.05)), track)


def test_circles_on_circles_have_wickens_conicity():
    taper, wheel, rail = 0.02, 0.5, 0.3
    geometry = contact_geometry(
        Wheelset(hollow(taper, wheel), RADIUS, SPACING),
        Track(round_rail(rail), GAUGE, 1.0),
        SHIFTS / 40,
    )
    half = geometry.left.place[16]
    slope = geometry.left.angle[16]  # where they touch when centred
    found = RadiusDifference(geometry.shift, geometry.radius_difference).by_integration(1e-4)
    expected = wheel * slope / (wheel - rail) * (half + rail * slope) / (half - RADIUS * slope)
    assert found == pytest.approx(expected, rel=2 * slope**2)
    np.testing.assert_allclose(geometry.left.wheel_curvature, -1 / wheel, rtol=1e-4)


def test_a_mirrored_wheelset_on_a_mirrored_track_has_mirrored_contacts():
    conical, worn, rail = shape("conical"), shape("worn"), shape("crown")
    one = contact_geometry(
        Wheelset(conical, RADIUS, SPACING, worn, RADIUS - 1e-3),
        Track(rail, GAUGE, inclination=(1 / 40, 1 / 20), right=shape("60e1")),
        SHIFTS,
        0.005,
    )
    other = contact_geometry(
        Wheelset(worn, RADIUS - 1e-3, SPACING, conical, RADIUS),
        Track(shape("60e1"), GAUGE, inclination=(1 / 20, 1 / 40), right=rail),
        -SHIFTS[::-1],
        -0.005,
    )
    np.testing.assert_allclose(one.roll, -other.roll[::-1], atol=1e-12)
    np.testing.assert_allclose(one.left.radius, other.right.radius[::-1], atol=1e-12)
    np.testing.assert_allclose(one.right.ahead, other.left.ahead[::-1], atol=1e-9)


def test_two_points_of_one_wheel_touch_where_the_contact_jumps_to_the_flange():
    wheelset = Wheelset(shape("conical"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    coarse = contact_geometry(wheelset, track, np.linspace(7e-3, 10e-3, 31))
    (jump,) = coarse.jumps
    assert jump.side == "left"
    at = contact_geometry(wheelset, track, [jump.shift - 1e-6])
    assert abs(at.left_second.gap[0]) < 1e-6
    assert at.left_second.on_wheel[0] == pytest.approx(jump.after.on_wheel, abs=1e-4)
    assert np.degrees(jump.after.angle) == pytest.approx(70, abs=0.5)


def test_a_yawed_flange_touches_ahead_of_its_axle():
    wheelset = Wheelset(shape("conical"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    straight, yawed = (contact_geometry(wheelset, track, [9e-3], yaw).left for yaw in (0.0, 0.01))
    assert straight.ahead[0] == 0.0
    assert yawed.ahead[0] + np.sin(0.01) * yawed.place[0] == pytest.approx(
        yawed.radius[0] * np.tan(straight.angle[0]) * np.sin(0.01), rel=0.05
    )


def test_yaw_of_a_cone_shifts_its_contact_by_the_taper():
    taper, yaw = 0.05, 0.01
    track = Track(round_rail(0.3), GAUGE, 1.0)
    found = contact_geometry(Wheelset(cone(taper), RADIUS, SPACING), track, [0.0], yaw)
    spoke = found.left.radius[0] * taper * np.sin(yaw)
    axle = -np.sin(yaw) * (SPACING / 2 + found.left.on_wheel[0])
    assert found.left.ahead[0] == pytest.approx(spoke + axle, abs=1e-12)


def yawed_cone(taper: float, crown: float, centre: float, yaw: float) -> dict[str, float]:
    """A centred cone on circles whose tops are at +-centre. Seen along the track a cone's outline
    is a straight line through its apex, as steep as the cone over the cosine of the yaw."""
    half = np.arctan(taper)  # angle between the cone and its axle
    angle = np.arcsin(np.sin(half) / np.cos(yaw))
    apex = SPACING / 2 + RADIUS / taper  # along the axle
    place = centre - crown * np.sin(angle)
    seen = (apex * np.cos(yaw) - place) / np.cos(angle)
    length = seen / np.sqrt(1 - (np.sin(yaw) / np.cos(half)) ** 2)  # of the line itself
    return {
        "angle": angle,
        "place": place,
        "radius": length * np.sin(half),
        "ahead": np.sin(yaw) * (length / np.cos(half) - apex),
    }


@pytest.mark.parametrize("crown", [0.012, 0.3])
def test_a_yawed_cone_touches_a_circle_as_in_closed_form(crown):
    rail = round_rail(crown)
    track = Track(rail, GAUGE, 1.0)
    centre = GAUGE / 2 + float(np.ptp(rail.points[:, 0])) / 2
    for yaw in (0.0, 0.02, 0.06):
        found = contact_geometry(Wheelset(cone(0.05), RADIUS, SPACING), track, [0.0], yaw).left
        for name, value in yawed_cone(0.05, crown, centre, yaw).items():
            assert getattr(found, name)[0] == pytest.approx(value, abs=1e-9), name


def test_a_yawed_wheelset_rises_along_its_contact_planes():
    """A point ahead of the axle goes sideways as the wheelset yaws, and must climb its plane."""
    wheelset = Wheelset(shape("worn"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    step = 1e-5
    before, here, after = (
        contact_geometry(wheelset, track, [0.0], 0.03 + s) for s in (-step, 0.0, step)
    )
    rise = (after.lift[0] - before.lift[0]) / (2 * step)
    assert rise == pytest.approx(np.tan(here.left.angle[0]) * here.left.ahead[0], rel=1e-5)


def test_yaw_changes_contacts_evenly_and_sends_them_ahead_oddly():
    wheelset = Wheelset(shape("worn"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    one, other = (contact_geometry(wheelset, track, SHIFTS, yaw) for yaw in (0.02, -0.02))
    for name in ("radius", "angle", "place"):
        np.testing.assert_allclose(getattr(one.left, name), getattr(other.left, name), atol=1e-12)
    np.testing.assert_allclose(one.roll, other.roll, atol=1e-12)
    np.testing.assert_allclose(one.left.ahead, -other.left.ahead, atol=1e-12)


FLANGE_OF_CONTACT = {
    8.0: (719.8316, 0.9501, 0.9036),
    9.0: (720.4903, 0.8676, 3.2265),
    10.0: (721.0880, 0.7992, 5.2821),
}
"""Shift [mm]: place on the rail [mm], angle [rad], distance before or behind the axle's middle [mm]
of the Manchester benchmark's case A-2.2, yawed by 2.4 mrad/mm: eve70a/CONTACT, mbench_a22_right."""


@pytest.mark.parametrize("shift", FLANGE_OF_CONTACT)
def test_s1002_touches_uic_60_with_its_flange_where_contact_has_it(shift):
    place, angle, ahead = FLANGE_OF_CONTACT[shift]
    wheelset = Wheelset(shape("s1002"), 0.46, 1.5)
    track = Track(shape("60e1"), 1.435, 0.014, 1 / 40)
    found = contact_geometry(wheelset, track, [shift * 1e-3], -2.4e-3 * shift).left[0]
    assert found.place * 1e3 + shift == pytest.approx(place, abs=0.01)
    assert found.angle == pytest.approx(angle, abs=1e-3)
    assert abs(found.ahead) * 1e3 == pytest.approx(ahead, abs=0.05)


def test_the_wheelset_slides_along_the_contact_planes():
    at = np.array([-6e-3, 6e-3, 9e-3])  # tread, tread, flange
    step = 1e-7
    wheelset = Wheelset(shape("conical"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    before, here, after = (contact_geometry(wheelset, track, at + s) for s in (-step, 0, step))
    roll, lift = (
        (getattr(after, name) - getattr(before, name)) / (2 * step) for name in ("roll", "lift")
    )
    for points, sign in ((here.left, 1), (here.right, -1)):
        up = lift + points.place * sign * roll
        out = sign * (1 + (0.4191 + here.lift - points.height) * roll)
        np.testing.assert_allclose(up, np.tan(points.angle) * out, atol=1e-6)


def test_a_table_has_the_contacts_of_its_geometry():
    wheelset = Wheelset(shape("conical"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    table = contact_table(wheelset, track, 1e-3)
    assert table.clearance == pytest.approx(8.4586e-3, abs=1e-6)
    assert np.degrees(table.tread.angle.max()) < 5 < 55 < np.degrees(table.flange.angle.min())
    at = contact_geometry(
        wheelset, track, [table.tread.over[50], table.clearance + table.flange.over[-1]]
    )
    np.testing.assert_allclose(
        [table.tread.radius[50], table.flange.radius[-1]], at.left.radius, atol=1e-12
    )
    np.testing.assert_allclose([table.tread.roll[50], table.flange.roll[-1]], at.roll, atol=1e-12)


@pytest.fixture(scope="module")
def over_yaw():
    wheelset = Wheelset(shape("worn"), 0.4191, 1.5113)
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    return wheelset, track, contact_table(wheelset, track, 1e-3, yaw=0.03)


def looked_up(columns, patch, names, at):
    spline = columns.spline(patch, names)
    number, part = spline.place(ca.DM(at))
    return spline.value(part, ca.evalf(spline.row(ca.MX(number))))


@pytest.mark.parametrize("yaw", [0.015, 0.026])
def test_a_table_over_yaw_has_the_contacts_between_its_yaw_angles(over_yaw, yaw):
    wheelset, track, table = over_yaw
    assert table.said[-1].startswith("yaw from 0 to 30 mrad")
    columns = Columns(table, 0.28)
    names = ("widening", "sine", "arm", "ahead")
    earlier, clearance = float(columns.earlier(yaw)), flange_begins(wheelset, track, yaw)[0]
    assert table.clearance - earlier == pytest.approx(clearance, abs=3e-7)
    assert earlier > 5e-5
    for patch, shift, at in (
        ("tread", 4e-3, 4e-3 + earlier),
        ("tread", -6e-3, -6e-3 + earlier),
        ("flange", clearance + 8e-4, 8e-4 - np.argmax(table.flange.angle) * table.flange.over[1]),
    ):
        direct = contact_geometry(wheelset, track, [shift], yaw).left[0]
        there = columns.at_yaw(looked_up(columns, patch, names, at), yaw)
        found = dict(zip(names, ca.vertsplit(there), strict=True))
        assert float(found["widening"]) == pytest.approx(direct.radius / 0.4191 - 1, abs=1e-7)
        assert float(found["sine"]) == pytest.approx(np.sin(direct.angle), abs=1.7e-6)
        assert float(found["arm"]) == pytest.approx(direct.place, abs=1.5e-7)
        assert float(found["ahead"]) * yaw == pytest.approx(direct.ahead, rel=2e-3)


def test_without_yaw_a_table_over_yaw_is_the_one_that_has_none(over_yaw):
    wheelset, track, table = over_yaw
    plain = contact_table(wheelset, track, 1e-3)
    assert as_text(replace(table, said=plain.said, yawed={})) == as_text(plain)
    again = of_text(as_text(table))
    assert as_text(again) == as_text(table)
    assert again.yawed[0.03].clearance == table.yawed[0.03].clearance
    straight, yawed = Columns(plain, 0.28), Columns(table, 0.28)
    one, other = (looked_up(columns, "tread", KINEMATIC, 2e-3) for columns in (straight, yawed))
    one, other = straight.at_yaw(one, 0.0), yawed.at_yaw(other, 0.0)
    np.testing.assert_allclose(one.full(), other.full(), rtol=1e-14, atol=1e-16)
    assert float(yawed.earlier(0.0)) == 0.0


def test_a_table_of_a_contact_that_jumps_on_the_tread_goes_from_one_place_to_the_other():
    wheelset, track = (
        Wheelset(shape("s1002"), 0.46, 1.5),
        Track(shape("60e1"), 1.435, 0.014, 1 / 40),
    )
    table = contact_table(wheelset, track, 1e-3)
    assert "the contact jumps on the tread at shifts of 0.225, 4.99 mm" in table.said[-1]
    over, place = table.tread.over, table.tread.place
    rigid = contact_geometry(wheelset, track, [-4e-3, 3e-3]).left
    np.testing.assert_allclose(np.interp([-4e-3, 3e-3], over, place), rigid.place, atol=6e-4)
    assert 0.744 < np.interp(0.225e-3, over, place) < 0.751  # between 0.742 and 0.753 m
    assert np.abs(np.diff(place)).max() < 3e-3


def test_a_wheel_without_a_flange_has_a_table_of_its_tread():
    track = Track(shape("crown"), 1.4351, 0.015875, 1 / 40)
    table = contact_table(Wheelset(cone(0.05), 0.4191, 1.5113), track)
    assert table.flange is None
    assert table.clearance == pytest.approx(8e-3)
    np.testing.assert_allclose(table.tread.wheel_curvature, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", shapes())
def test_a_shape_is_where_its_drawing_puts_it_without_gaps(name):
    drawing, found = shapes()[name], shape(name)
    y, z = found.points.T
    level = np.interp(0.0, y, z) if found.kind == "wheel" else z.max()
    assert level == pytest.approx(0.0, abs=1e-6)
    assert all(drawing[key] for key in ("unit", "basis", "source", "description"))
    assert np.hypot(*np.diff(found.points, axis=0).T).max() < 5e-4


def test_the_flange_of_s1002_is_as_its_standard_names_it():
    flange = flange_of(shape("s1002"))
    assert flange.thickness * 1e3 == pytest.approx(32.5, abs=0.01)
    assert flange.height * 1e3 == pytest.approx(28.0, abs=0.001)
    with pytest.raises(ParameterError, match=r"cone of 0.05 has no flange"):
        flange_of(cone(0.05))


def test_apta_220_is_arcs_and_tangents_through_the_points_of_its_drawing():
    """Points of the drawing (flange upwards, from its own origin) [in]; a flange of 75 degrees."""
    drawn = np.array([[-0.8501, 0.2407], [-0.5625, 0.375], [-0.1403, 0.2301], [-0.0084, 0.0312],
                      [0.0286, -0.1069], [0.2840, -0.4445], [0.7485, -0.6250], [0.9771, -0.6542],
                      [3.7499, -0.7927]])  # fmt: skip
    wheel = shape("apta220")
    y, z = wheel.points.T / 0.0254
    here = drawn * (1, -1) - np.array([1.6875, 0.6897])
    away = [np.hypot(y - a, z - b).min() for a, b in here]
    assert max(away) < 6e-3  # points stand 0.01 in apart
    angle = np.unwrap(np.arctan2(np.diff(z), np.diff(y)))
    length = np.hypot(np.diff(y), np.diff(z))
    turn = 2 * np.abs(np.diff(angle)) / (length[1:] + length[:-1])
    assert turn.max() == pytest.approx(1 / 0.375, rel=0.03)  # nowhere more than its smallest radius
    flange = (y[1:] > -2.0) & (y[1:] < -1.0)
    assert np.degrees(angle[flange].max()) == pytest.approx(75.0, abs=0.01)


def test_apta_220_on_a_crown_has_the_conicity_of_its_taper():
    """A cone of slope g and radius r on crowns of radius R, half a distance l of contacts apart:
    conicity g (l + R g)/(l - r g)."""
    wheelset, track = Wheelset(shape("apta220"), 0.4191, 1.5), Track(shape("crown"), 1.4351)
    geometry = contact_geometry(wheelset, track, np.linspace(-2e-3, 2e-3, 9))
    half = geometry.left.place[4]
    expected = 0.05 * (half + 0.254 * 0.05) / (half - 0.4191 * 0.05)
    conicity = np.polyfit(geometry.shift, geometry.radius_difference, 1)[0] / 2
    assert conicity == pytest.approx(expected, rel=2e-3)


def test_a_cone_that_does_not_roll_differs_by_twice_its_slope():
    """A cone on any crown, whatever its radius: the contact goes with the wheel."""
    wheelset, track = Wheelset(shape("apta220"), 0.4191, 1.5), Track(shape("60e1"), 1.435)
    shift = np.linspace(-2e-3, 2e-3, 9)
    difference = level_difference(wheelset, track, shift)
    np.testing.assert_allclose(difference, 2 * 0.05 * shift, atol=1e-7)


def test_a_flange_steeper_than_the_wheelset_rolls_is_met_steep_and_left_at_once():
    """Up a flange of 75 degrees the axle moves back by its roll more than outwards."""
    wheelset, track = Wheelset(shape("apta220"), 0.4191, 1.5), Track(shape("crown"), 1.4351)
    begins = flange_begins(wheelset, track)
    climbed = begins[0] + np.arange(6) * 1e-4
    flange = climbing_geometry(wheelset, track, climbed)
    angle = np.degrees(np.abs(flange.left.angle))
    assert angle[0] == pytest.approx(75.0, abs=0.5)  # with the wheelset's roll
    assert (np.diff(angle) < 0).all() and 60 < angle[1] < 70
    assert np.abs(flange.left.gap).max() < 1e-9 and np.abs(flange.right.gap).max() < 1e-9
    stable = climbing_geometry(
        Wheelset(shape("s1002"), 0.46, 1.5), Track(shape("60e1"), 1.435), climbed
    )
    plain = contact_geometry(stable.wheelset, stable.track, climbed)
    np.testing.assert_array_equal(stable.roll, plain.roll)


def test_a_wheel_beside_its_rail_is_refused():
    with pytest.raises(ParameterError, match="does not touch 60e1 at a shift of 0 mm"):
        contact_geometry(Wheelset(shape("conical"), 0.46, 1.75), Track(shape("60e1"), 1.435), [0.0])
