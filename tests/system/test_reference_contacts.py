"""The reference's contacts only push: equilibrium, statics, rocking, and energy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import tolerances
from reference.car_data import EMPTY, FOOT, FREE, LOADED, CarData
from reference.integration import VERTICAL_RAILS, Motion, initial_state, integrate
from reference.irregular_rails import irregular_rails
from reference.monolithic_car import COORDINATES, ELEMENTS, MonolithicCar
from reference.one_sided import EDGES, PLATE, RELIEF, WHEELS

SPEED = 60 * FOOT
TOSSED = initial_state(
    carbody_roll=0.02, carbody_vertical=0.03, carbody_lateral=0.03, front_lateral=0.004
)


@cache
def rough() -> Motion:
    """An empty car that is thrown about: wheels lift, plates rock and lift, side bearings close."""
    data = replace(EMPTY, plate_friction_by_load=True, wedges_by_load=True)
    rails = 30 * irregular_rails(data, SPEED, 3.0, 1e-3)
    accelerations = np.gradient(np.gradient(rails, 1e-3, axis=0), 1e-3, axis=0)
    return integrate(
        MonolithicCar(data, SPEED),
        3.0,
        start={},
        rails=rails,
        rail_accelerations=accelerations[:, VERTICAL_RAILS],
        rail_step=1e-3,
    )


def edge_loads(motion: Motion) -> np.ndarray:
    """Loads of the plates' left and right edge (n, 2, 2) [N]."""
    vertical, moment = np.moveaxis(motion.contacts[:, :, PLATE], 2, 0)
    moment = moment / motion.car.data.centre_plate_radius
    return np.stack([vertical + moment, vertical - moment], axis=2) / 2


def gaps(motion: Motion) -> np.ndarray:
    """Gaps under the left and right wheels (n, 2, 2) [m]."""
    raised, lean = np.moveaxis(motion.contacts[:, :, RELIEF], 2, 0)
    lean = motion.car.data.half_gauge * lean
    return np.stack([raised + lean, raised - lean], axis=2)


def test_the_rails_carry_weight_and_inertia_of_the_whole_car():
    """Vertical forces and moments about the track's middle, from the accelerations alone."""
    motion = rough()
    data, p = motion.car.data, motion.accelerations
    rails = motion.rail_accelerations @ motion.car.strain[1].T
    bolsters = p[:, [10, 16]].sum(axis=1), p[:, [13, 19]].sum(axis=1)  # roll, vertical
    left, right = motion.contacts[:, :, WHEELS].sum(axis=1).T
    weight = 4 * data.axle_weight
    inertia = data.body_mass * p[:, 1] + data.bolster_mass * bolsters[1]
    inertia += data.unsprung_mass * rails[:, 3::ELEMENTS].sum(axis=1)
    assert np.abs(left + right - weight - inertia).max() < 1e-9 * weight
    height = data.gravity_centre_height + data.centre_plate_height
    moment = data.roll_inertia * p[:, 2] - height * data.body_mass * p[:, 0]
    moment += data.bolster_roll_inertia * bolsters[0]
    moment += data.unsprung_roll_inertia * rails[:, 2::ELEMENTS].sum(axis=1)
    arm = data.half_gauge
    assert np.abs((left - right) * arm - moment).max() < 1e-9 * weight * arm


def test_a_contact_is_open_or_loaded_and_never_pulls():
    motion = rough()
    weight = 2 * motion.car.data.axle_weight
    for load, opening in (
        (motion.contacts[:, :, WHEELS], gaps(motion)),
        (edge_loads(motion), motion.contacts[:, :, EDGES]),
    ):
        assert (opening > 0).any(axis=(0, 1)).all()
        assert opening.min() > -tolerances.ROUNDING
        assert load.min() > -1e-9 * weight
        assert np.abs(load[opening > tolerances.ROUNDING]).max() < 1e-9 * weight
    assert (motion.contacts[:, :, 4:6] > 0).any(axis=(0, 1)).all()  # side bearings


def at_rest(car: MonolithicCar, push: np.ndarray, state: np.ndarray, slip: np.ndarray) -> Motion:
    """Equilibrium under a push (20,) near a state, by Newton's method on pieces of lines.

    A little stiffness against the last guess and short steps lead over where the body rocks freely.
    """

    def still(states: np.ndarray) -> Motion:
        n = len(states)
        none = np.zeros((n, 16))
        over = np.tile(slip, (n, 1)), none, none, np.tile(push, (n, 1))
        return Motion(car, np.zeros(n), states, *over)

    steps = 1e-9 * np.eye(COORDINATES, 2 * COORDINATES)
    for _ in range(300):
        force = still(np.vstack([state, state + steps])).accelerations @ car.mass
        if np.abs(force[0]).max() < 1e-6 * np.abs(push).max():
            break
        jacobian = (force[1:] - force[0]).T / 1e-9
        step = np.linalg.solve(jacobian - 0.1 * car.mass, force[0])
        step *= min(1.0, 5e-3 / np.abs(step[:5]).max())
        state = state - np.append(step, np.zeros(COORDINATES))
    return still(state[None])


def roll_test(data: CarData, force: float, steps: int = 40) -> Motion:
    """The car at rest under a lateral force at its centre of gravity that was raised in steps."""
    car = MonolithicCar(data, SPEED)
    state, slip, push = np.zeros(2 * COORDINATES), np.zeros(2 * ELEMENTS), np.zeros(COORDINATES)
    stretch = np.tile(np.array(data.friction_limit) / data.friction_stiffness, 2)
    for part in range(1, steps + 1):
        push[0] = force * part / steps
        motion = at_rest(car, push, state, slip)
        state, strain = motion.state[0], motion.element_strain[0]
        slip = np.clip(slip, strain - stretch, strain + stretch)
    return motion


def without_plate_yaw(data: CarData) -> CarData:
    """Nothing turns the carbody, so that both trucks carry the same share."""
    sideways, _, *others = data.friction_limit
    return replace(data, friction_limit=(sideways, 0.0, *others))


def test_a_slow_lateral_force_lifts_the_wheels_where_statics_says():
    """F (h + h_cp) = 4 W_axle L_Y, on plates that rock and side bearings that close."""
    data = without_plate_yaw(LOADED)
    height = data.gravity_centre_height + data.centre_plate_height
    lifting = 4 * data.axle_weight * data.half_gauge / height
    before, after = (roll_test(data, part * lifting) for part in (0.999, 1.001))
    assert np.abs(before.accelerations).max() < 1e-3
    assert (before.contacts[0, :, 3] > 0).all()  # plates rock on their left edges
    assert (before.contacts[0, :, 4] > 0).all()  # on their left side bearings, too
    right = before.wheel_load[0, 1::2]
    assert right.mean() == pytest.approx(1e-3 * data.axle_weight / 2, rel=1e-3)
    assert gaps(before).max() == 0 and gaps(after)[0, :, 1].min() > 0.1


def test_an_empty_body_tips_over_its_side_bearings_before_the_wheels_lift():
    """F h = m g b; below, the plate carries (m g b - F h)/(b - r) on its rim."""
    data = without_plate_yaw(EMPTY)
    arm, height = data.half_side_bearing_spacing, data.gravity_centre_height
    tipping = 2 * data.plate_weight * arm / height
    before, after = (roll_test(data, part * tipping) for part in (0.999, 1.001))
    assert np.abs(before.accelerations).max() < 1e-3
    plates = before.contacts[0, :, PLATE][:, 0].sum()
    expected = 1e-3 * tipping * height / (arm - data.centre_plate_radius)
    assert plates == pytest.approx(expected, rel=1e-3)
    assert before.contacts[0, :, 3].max() < 0.02 and after.contacts[0, :, 3].min() > 0.1
    assert gaps(before).max() == 0


def test_a_body_rocks_on_its_rim_under_a_constant_moment():
    """Quarter of a period: sqrt(2 (I + m r^2) A/(W r)), W on both plates; hard contacts."""
    amplitude, radius = 0.05, LOADED.centre_plate_radius
    data = replace(
        FREE,
        spring=(0.0, 0.0, *(1e3 * k for k in LOADED.spring[2:4]), *LOADED.spring[4:]),
        stop_stiffness=(0.0,) * 6,
        contact_stiffness=tuple(100 * k for k in LOADED.contact_stiffness),
        contact_damping_ratio=LOADED.contact_damping_ratio,
        side_bearing_gap=1.0,
    )
    start = initial_state(carbody_roll=amplitude, carbody_vertical=radius * amplitude)
    motion = integrate(MonolithicCar(data, SPEED), 1.5, start=start, step=2e-5)
    roll = motion.coordinates[:, 2]
    last = np.flatnonzero(roll > 0)[-1] if (roll > 0).all() else np.flatnonzero(roll <= 0)[0]
    quarter = np.interp(0.0, -roll[last - 1 : last + 1], motion.time[last - 1 : last + 1])
    inertia = data.roll_inertia + data.body_mass * radius**2
    expected = np.sqrt(2 * inertia * amplitude / (2 * data.plate_weight * radius))
    assert quarter == pytest.approx(expected, rel=tolerances.ROCKING)
    assert np.abs(edge_loads(motion)[: last - 10, :, 0]).max() < 1e-9 * data.plate_weight


def test_lifting_rocking_and_blows_conserve_energy():
    motion = integrate(MonolithicCar(FREE, SPEED), 2.0, start=TOSSED, step=2e-5)
    assert gaps(motion).max() > 0.05 and motion.contacts[:, :, EDGES].max() > 0.05
    assert motion.contacts[:, :, 4:6].max() > FREE.plate_weight
    assert np.ptp(motion.energy) < tolerances.REFERENCE_ENERGY_AT_STOPS * motion.energy[0]


def test_sliders_and_bearings_take_energy_and_never_give_it():
    data = replace(
        FREE,
        friction_limit=LOADED.friction_limit,
        side_bearing_damping=LOADED.side_bearing_damping,
        side_bearing_friction=LOADED.side_bearing_friction,
    )
    energy = integrate(MonolithicCar(data, SPEED), 2.0, start=TOSSED, step=2e-5).energy
    assert np.diff(energy).max() < tolerances.REFERENCE_ENERGY_AT_STOPS * energy[0]
    assert energy[-1] < 0.7 * energy[0]


def test_a_wheelset_without_traction_spins_freely():
    motion = rough()
    force = motion.wheel_longitudinal.reshape(-1, 4, 2)
    size = np.abs(force).max()
    assert size > 1e3
    assert np.abs(force.sum(axis=2)).max() < tolerances.ROUNDING * size
    moment = motion.car.data.half_gauge * (force[:, :, 1] - force[:, :, 0])
    assert np.abs(moment - motion.wheel_force[1]).max() < 1e-9 * np.abs(moment).max()
