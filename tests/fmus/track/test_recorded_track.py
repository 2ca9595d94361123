"""A track that is given station by station, under the axles of a car."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.describe.twin import Twin
from fmus.errors import ParameterError
from fmus.track.block import Track
from fmus.track.realisation import realisation
from fmus.track.recorded import RecordedTrack
from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS
from support.track_values import L_C, L_X, track_values

SPACING = 0.25
PLACED = {"fade_length": 0.0, "half_truck_spacing": L_C, "half_wheelbase": L_X}
WAVES = {"alignment": 12.0, "profile": 9.0, "cross_level": 7.0, "gauge": 15.0}
SIZE = 4e-3


def waves(station):
    """The four channels [m] in closed form."""
    return np.array([SIZE * np.sin(2 * np.pi * station / wave) for wave in WAVES.values()])


@pytest.fixture(scope="module")
def recorded():
    return RecordedTrack(TrackData("waves", 1000.0, SPACING, waves(SPACING * np.arange(801))))


def rails(block, distance, axle=1, **changes):
    """The four rails under an axle, and their vertical accelerations."""
    scales = {f"{channel}_scale": 1.0 for channel in CHANNELS}
    twin = Twin(block, {**PLACED, **scales, "start": 1000.0, **changes}, {"speed": distance})
    twin.initialize()
    twin.step(1.0)
    return twin.outputs()[2:18].reshape(4, 4)[axle - 1]


@pytest.mark.parametrize("distance", [31.4, 77.77, 150.0])
def test_wheels_follow_the_closed_form_of_what_was_sampled(recorded, distance):
    """A cubic spline misses a sinusoid by (k h)^4/384, that is 6e-6 of it at 7 m."""
    a, v, xl, g = waves(distance)
    expected = [a + g / 2, a - g / 2, v + xl / 2, v - xl / 2]
    assert rails(recorded, distance) == pytest.approx(expected, abs=1e-5 * SIZE)


def test_the_start_is_a_station_of_the_record(recorded):
    later = rails(recorded, 20.0, start=1040.0)
    assert later == pytest.approx(rails(recorded, 60.0), abs=1e-15)
    assert rails(recorded, 20.0, axle=2, start=1040.0) == pytest.approx(
        rails(recorded, 60.0 - 2 * L_X), abs=1e-15
    )


def test_beyond_its_end_the_track_stays_as_it_ends(recorded):
    at_end = rails(recorded, 200.0)
    assert np.abs(at_end).max() > 0.1 * SIZE
    for beyond in (201.0, 300.0, 5000.0):
        assert rails(recorded, beyond) == pytest.approx(at_end, abs=1e-15)


def test_a_channels_scale_multiplies_it_alone(recorded):
    plain, doubled = rails(recorded, 33.0), rails(recorded, 33.0, gauge_scale=3.0)
    assert doubled[0] - doubled[1] == pytest.approx(3 * (plain[0] - plain[1]), rel=1e-12)
    assert doubled[2:] == pytest.approx(plain[2:], abs=0.0)


def test_a_drawn_track_in_a_file_is_the_drawn_track():
    """Its stations every 0.1 m, of waves from 3 m: the spline's slopes miss by 1e-5 of the rms."""
    values = track_values("fra5", fade_length=0.0)
    drawn = realisation(values, length=120.0)
    stations = np.array([drawn[channel].values for channel in CHANNELS])
    block = RecordedTrack(TrackData("drawn", 0.0, 0.1, stations))
    built_in = Track()
    for distance in (35.03, 60.55, 99.98):
        twin = Twin(built_in, values, {"speed": distance})
        twin.initialize()
        twin.step(1.0)
        expected = twin.outputs()[2:18].reshape(4, 4)[0]
        found = rails(block, distance, start=0.0)
        assert found == pytest.approx(expected, abs=1e-5 * np.abs(stations).std())


@pytest.mark.parametrize(
    "values", [np.zeros((3, 9)), np.zeros((4, 3)), np.full((4, 9), np.nan)], ids=str
)
def test_what_is_no_track_is_refused(values):
    with pytest.raises(ParameterError, match="give"):
        TrackData("none", 0.0, 0.1, values)
