"""The linearised car against one written apart and against runs of the FMUs; its derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from fmus.export.wheelrail import wheelrail_fmu
from support.contact_tables import circles
from tracktrain.car.hopper import HOPPER
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds, follow, growing
from tracktrain.errors import HopperError, TracktrainError
from tracktrain.scales import FOOT, INCH, POUND_FORCE
from tracktrain.studies.common.car import StudiedCar
from tracktrain.studies.sensitivity import sensitivity
from tracktrain.studies.stability import RingDown, stability

REPORT_BODY = {
    "roll_inertia": 9.0e5 * POUND_FORCE * INCH,
    "gravity_centre_height": 48.3 * INCH,
}
"""Roll inertia and height of the carbody under which the report's roll and torsion are met."""


@pytest.fixture(scope="module")
def car():
    return LinearCar()


@pytest.mark.parametrize(("speed", "growth"), [(60, 0.0664), (100, 1.0440)])
def test_growth_is_that_of_the_car_written_apart(car, speed, growth):
    assert car.growth(speed * FOOT) == pytest.approx(growth, abs=5e-5)


def roll_and_torsion(changes):
    """Frequencies [Hz] of the car with linear trucks at 60 ft/s."""
    linear = LinearCar("loaded", changes, "report")
    roots, shapes = linear.modes(60 * FOOT)
    frequency = roots.imag / (2 * np.pi)
    energies = [linear.energies(shape) for shape in shapes.T]
    roll = [f for f, e in zip(frequency, energies, strict=True) if e["carbody.q[3]"] > 0.3]
    torsion = [f for f, e in zip(frequency, energies, strict=True) if e["carbody.q[6]"] > 0.3]
    return roll[0], torsion[0]


def test_roll_and_torsion_of_the_report_are_met_within_5_percent():
    assert roll_and_torsion(REPORT_BODY) == pytest.approx((1.25, 3.76), rel=0.05)


def test_shipped_body_has_roll_and_torsion_where_its_source_line_says():
    assert roll_and_torsion(None) == pytest.approx((1.125, 3.333), rel=1e-3)


def test_both_printed_frequencies_ask_for_a_body_14_inches_lower():
    body = {
        "roll_inertia": 8.329e5 * POUND_FORCE * INCH,
        "gravity_centre_height": 44.36 * INCH,
    }
    assert roll_and_torsion(body) == pytest.approx((1.25, 3.76), rel=1e-3)


def test_hunting_begins_where_growth_changes_its_sign(car):
    ((speed, root, name),) = critical_speeds(car, np.arange(20, 141, 4) * FOOT)
    assert abs(root.real) < 1e-9
    assert car.growth(0.999 * speed) < 0 < car.growth(1.001 * speed)
    assert name == "lateral"


def test_modes_are_followed_without_a_jump(car):
    for branch in follow(car, np.arange(40, 101, 1.0) * FOOT):
        step = np.abs(np.diff(branch.roots))
        assert step.max() < 0.2 * np.abs(branch.roots).mean()


def test_free_friction_gives_the_springs_alone():
    free = LinearCar(friction="free")
    none = {f"{e}.friction_stiffness": 0.0 for e in free.friction}
    assert np.allclose(free.matrix(20.0), LinearCar(changes=none).matrix(20.0), atol=1e-9)


def test_equivalent_damper_takes_as_much_energy_as_friction():
    omega = 5.0
    damper, free = (
        LinearCar(friction={"warp": "damper"}, omega=omega),
        LinearCar(friction={"warp": "free"}),
    )
    # A rate of warp alone feels c/(what the warp's spring moves): compare with a unit spring.
    places = [damper.states.index(f"truck_front.{q}[4]") for q in ("q", "qd")]
    spring = (LinearCar().matrix(20.0) - free.matrix(20.0))[:, places[0]]
    force = (damper.matrix(20.0) - free.matrix(20.0))[:, places[1]]
    truck = damper.values("truck")
    c = 4 * truck["warp.friction_limit"] / (np.pi * omega * truck["warp.free_play"])
    assert np.allclose(force, spring * c / truck["warp.friction_stiffness"], rtol=1e-9)


def test_ring_down_of_the_fmus_tells_the_same_growth_as_the_eigenvalues():
    outcome = stability(
        speeds=np.array([50.0, 60.0]) * FOOT,
        ring_down=RingDown((50 * FOOT, 60 * FOOT, 100 * FOOT)),
        animate=False,
    )
    table = outcome.tables["ring_down"]
    assert table["growth, run [1/s]"].to_numpy() == pytest.approx(
        table["growth, exact [1/s]"].to_numpy(), abs=tolerances.RING_DOWN
    )
    assert table["frequency, run [Hz]"].to_numpy() == pytest.approx(
        table["frequency, exact [Hz]"].to_numpy(), rel=tolerances.RING_DOWN
    )


def test_every_derivative_of_the_growth_is_that_by_differences():
    table = sensitivity(speed=80 * FOOT).tables["for_one_percent"]
    assert len(table) > 30
    difference = table["growth [1/s]"] - table["differences [1/s]"]
    assert difference.abs().max() < tolerances.SLOPE * table["growth [1/s]"].abs().max()


def test_derivative_of_the_critical_speed_is_that_by_differences():
    table = sensitivity(speed=80 * FOOT, check=False).tables["for_one_percent"]
    grid = np.arange(40, 71, 2) * FOOT
    for name in ("conicity", "body_mass", "warp.friction_stiffness"):
        value = LinearCar().values("wheelrail" if name == "conicity" else "truck").get(name)
        value = value or LinearCar().values("carbody")[name]
        ends = [
            critical_speeds(LinearCar(changes={name: factor * value}), grid)[0][0]
            for factor in (1.005, 0.995)
        ]
        assert table.loc[name, "critical speed [m/s]"] == pytest.approx(
            ends[0] - ends[1], rel=1e-3, abs=1e-6
        )


def test_car_that_is_unstable_at_every_speed_is_not_called_stable():
    worn = {"wheelrail.conicity": 0.3, "truck.centre_plate_yaw.friction_stiffness": 0.0}
    linear = LinearCar("empty", worn)
    grid = np.array([60.0, 80.0]) * FOOT
    assert growing(linear, grid[0]) is not None and not critical_speeds(linear, grid)
    said = stability(car="empty", changes=worn, speeds=grid, animate=False).notes
    assert any("at 60 ft/s already: the critical speed is below that" in note for note in said)


def steep(conicity):
    """The car with other cones, as one of FMUs with --set."""
    wheelsets = [axle.wheelset for axle in HOPPER.axles]
    return StudiedCar(settings=[(name, "conicity", conicity) for name in wheelsets])


@pytest.mark.parametrize("friction", ["stuck", "damper"])
def test_a_car_of_fmus_has_the_sensitivities_of_the_equations(friction):
    found, expected = (
        sensitivity(car, friction, changes=changes, check=car == "loaded").tables["for_one_percent"]
        for car, changes in ((steep("0.1"), None), ("loaded", {"wheelrail.conicity": 0.1}))
    )
    largest = expected["growth [1/s]"].abs().max()
    expected = expected[expected["growth [1/s]"].abs() > tolerances.SLOPE * largest]
    for column in {*found.columns}:
        known = expected[column]
        assert found.loc[known.index, column].to_numpy() == pytest.approx(
            known.to_numpy(), abs=tolerances.SLOPE * known.abs().max()
        )


def test_a_car_of_fmus_has_the_modes_of_the_equations():
    (found, body), (expected, _) = (
        (outcome.tables["modes"], outcome.pictures)
        for outcome in (
            stability(car, "damper", changes, speeds=[16.0, 17.0], animate=False)
            for car, changes in ((steep("0.1"), None), ("loaded", {"wheelrail.conicity": 0.1}))
        )
    )
    assert list(found.index) == list(expected.index) and "figure_7_16" in body
    assert found.to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    "half", [{"rail": "crown"}, {"right_wheel": "worn"}, {"right_radius": 0.418}]
)
def test_half_a_pair_of_profiles_is_refused_and_not_left_out(half):
    for study in (stability, sensitivity):
        with pytest.raises(TracktrainError, match="alone makes no contact; give --wheel"):
            study(StudiedCar(**half))


@pytest.fixture(scope="module")
def rounded():
    """Of hollow wheels on round rails the FMU of a wheelset, and one with the right side moved."""
    plain = circles(0.4, 0.3, 0.05)
    other = replace(plain.tread, over=plain.tread.over - 1e-3)
    unlike = replace(plain, right=replace(plain, tread=other))
    law = [("*", "creep_law", "linear")]
    return [StudiedCar(wheel=str(wheelrail_fmu(t)), settings=law) for t in (plain, unlike)]


@pytest.mark.slow
def test_ring_down_on_profiles_tells_the_growth_of_the_eigenvalues(rounded):
    outcome = stability(
        rounded[0],
        speeds=np.array([50.0, 60.0]) * FOOT,
        ring_down=RingDown((100 * FOOT,)),
        animate=False,
    )
    (row,) = outcome.tables["ring_down"].to_dict("records")
    assert row["growth, exact [1/s]"] > 0.1
    for what in ("growth", "frequency"):
        run, exact = (v for name, v in row.items() if name.startswith(what))
        assert run == pytest.approx(exact, rel=tolerances.RING_DOWN)


@pytest.mark.slow
def test_a_ring_down_of_sides_that_differ_is_refused(rounded):
    with pytest.raises(TracktrainError, match="begins at rest in the middle, where the loaded car"):
        stability(rounded[1], speeds=[16.0, 17.0], ring_down=RingDown((20.0,)), animate=False)


def test_pictures_and_animations_of_the_modes_are_written(tmp_path):
    outcome = stability(speeds=np.array([55.0, 60.0]) * FOOT, friction="report")
    written = {path.name for path in outcome.write(tmp_path)}
    assert {"figure_7_14.png", "figure_7_15.png", "figure_7_16.gif", "modes.csv"} <= written
    assert outcome.files["figure_7_15.gif"].startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"friction": "sticky"},
            "there is no friction 'sticky'; did you mean stuck?",
        ),
        ({"friction": {"wrap": "free"}}, "a truck has no element 'wrap'; did you mean warp?"),
        ({"friction": {"warp": "fre"}}, "warp cannot have the friction 'fre'; did you mean free?"),
        (
            {"changes": {"conicty": 0.1}},
            "the car has no parameter 'conicty'; did you mean conicity?",
        ),
    ],
)
def test_what_is_not_known_is_named(arguments, message):
    with pytest.raises(HopperError, match=message.replace("?", r"\?")):
        LinearCar(**arguments)
