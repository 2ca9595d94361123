"""The co-simulated car that lifts, rocks and strikes moves as the independent reference says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import tolerances
from orchestrator import simulate
from reference import recorded
from reference.car_data import EMPTY, FOOT, LOADED
from reference.integration import Motion, integrate
from reference.monolithic_car import MonolithicCar
from reference.one_sided import BEARINGS, EDGES, RELIEF
from tracktrain.car.hopper import hopper_car

DATA = {"loaded": LOADED, "empty": EMPTY}
ROUGH = {
    # cross-level times four at the speed of resonance, and the empty car at 60 mph
    "loaded": ("fra1", 25 * FOOT, {"track.cross_level_scale": 4.0}, 8.0),
    "empty": ("fra4", 88 * FOOT, {}, 4.0),
}
MOTIONS = (0, 1, 2, 8)  # carbody lateral, vertical, roll; trailing axle of the front truck


@cache
def both(car: str, step: float, duration: float) -> tuple[np.ndarray, np.ndarray, Motion]:
    """Wheel loads (n, 8) [N] and state (n, 40) of a run, and the reference on its rails."""
    track, speed, values, _ = ROUGH[car]
    system = hopper_car(car, speed=speed, track=track, seed=1)
    for name, value in values.items():
        system = system.with_value(name, value)
    run = simulate(system, duration=duration, step=step, master="one-pass")
    assert run.completed, run.message
    results = run.dataset
    motion = integrate(
        MonolithicCar(DATA[car], speed),
        duration,
        start={},
        rails=recorded.rails(results),
        rail_accelerations=recorded.rail_accelerations(results),
        rail_step=step,
        record_step=step,
    )
    return recorded.wheel_load(results), recorded.state(results, DATA[car]), motion


def rms(value: np.ndarray) -> float:
    return float(np.sqrt(np.mean(value**2)))


def errors(car: str, step: float, duration: float) -> tuple[float, float]:
    """Rms error of the wheel loads over the static one, and largest relative one of `MOTIONS`."""
    loads, state, motion = both(car, step, duration)
    each = [rms((state - motion.state)[:, i]) / rms(motion.state[:, i]) for i in MOTIONS]
    return rms(loads - motion.wheel_load) / (DATA[car].axle_weight / 2), max(each)


@pytest.mark.parametrize(("car", "smooth"), [("loaded", 0.55), ("empty", 0.32)])
def test_coupling_is_of_order_two_until_something_strikes_or_opens(car, smooth):
    coarse, fine = (errors(car, step, smooth) for step in (1e-3, 5e-4))
    *_, motion = both(car, 1e-3, smooth)
    assert not motion.contacts[:, :, :6].any() and not motion.flange_force.any()
    for one, other in zip(coarse, fine, strict=True):
        assert np.log2(one / other) == pytest.approx(2.0, abs=tolerances.COUPLING_ORDER)
    assert coarse[0] < tolerances.SMOOTH_LOADS[car]


@pytest.mark.slow
@pytest.mark.parametrize("car", ROUGH)
def test_a_car_that_lifts_and_rocks_follows_the_reference(car):
    duration = ROUGH[car][-1]
    coarse, fine = (errors(car, step, duration) for step in (1e-3, 5e-4))
    for found, allowed in zip(coarse, tolerances.ROUGH_CAR[car], strict=True):
        assert found < allowed
    assert fine[0] < coarse[0] / 2
    loads, _, motion = both(car, 1e-3, duration)
    assert loads.min() >= 0
    assert motion.contacts[:, :, EDGES].any() and motion.contacts[:, :, BEARINGS].any()
    assert motion.contacts[:, :, RELIEF].any() == (car == "loaded")
