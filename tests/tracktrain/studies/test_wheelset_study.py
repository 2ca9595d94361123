"""The wheelset alone, run as an FMU: Klingel's wave and the closed form of the critical speed."""

from __future__ import annotations

import pytest

import tolerances
from tracktrain.scales import FOOT
from tracktrain.studies.wheelset import wheelset

PUBLISHED = {
    "wheelset_mass": 1200.0,
    "wheelset_yaw_inertia": 760.0,
    "longitudinal_creep_coefficient": 7.5e6,
    "lateral_creep_coefficient": 7e6,
    "half_contact_spacing": 0.7557,
    "conicity": 0.05,
    "rolling_radius": 0.4191,
}
"""A restrained wheelset whose critical speed is known: 117.561558 m/s at 46.448221 rad/s."""


@pytest.fixture(scope="module")
def tables():
    return wheelset(settings=PUBLISHED).tables


def test_free_wheelset_rolls_in_klingels_wave(tables):
    wave = tables["wavelength"].loc["free wheelset"]
    assert wave["found [m]"] == pytest.approx(wave["Klingel [m]"], rel=tolerances.WAVELENGTH)
    assert wave["found [m]"] == pytest.approx(51.9 * FOOT, rel=1e-2)


def test_rigid_truck_rolls_in_a_longer_wave(tables):
    wave = tables["wavelength"].loc["rigid truck"]
    assert wave["found [m]"] == pytest.approx(wave["Klingel [m]"], rel=tolerances.WAVELENGTH)
    # 78.8 ft with equal creep coefficients; the frame's yaw creeps laterally, in 7.0 : 7.5 here.
    assert wave["found [m]"] == pytest.approx(78.8 * FOOT * 0.981, rel=2e-3)


def test_restrained_wheelset_becomes_unstable_at_the_speed_of_the_closed_form(tables):
    found = tables["critical_speed"].loc["run of the FMU"]
    assert found["critical speed [m/s]"] == pytest.approx(117.561558, rel=tolerances.CRITICAL_SPEED)
    assert found["frequency [Hz]"] == pytest.approx(46.448221 / 6.283185307, rel=1e-3)
