"""The car on a track of a file."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from fmus.track.recorded_data import TrackData, as_text
from orchestrator import Experiment, simulate
from tracktrain.car.hopper import hopper_car
from tracktrain.car.track import track_for, with_track
from tracktrain.cli.main import main

SPEED, WAVE, LENGTH = 18.288, 12.0, 160.0


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A sinusoid of both rails' height."""
    station = 0.25 * np.arange(round(LENGTH / 0.25) + 1)
    values = np.zeros((4, len(station)))
    values[1] = 3e-3 * np.sin(2 * np.pi * station / WAVE)
    path = tmp_path_factory.mktemp("own track") / "waves.csv"
    path.write_text(as_text(TrackData("waves", 0.0, 0.25, values)))
    return path


def run(*arguments):
    return CliRunner().invoke(main, ["run", "--quiet", *map(str, arguments)])


def test_the_car_answers_a_sinusoid_at_its_speed_over_the_wave(file):
    car, _ = with_track(hopper_car("empty", SPEED), file)
    dataset = simulate(car, duration=8.0, step=2e-3).dataset
    z = dataset["carbody.cg.z"].values[1000:]
    window = np.hanning(len(z))
    spectrum = np.abs(np.fft.rfft((z - z.mean()) * window, 16 * len(z)))
    frequency = np.fft.rfftfreq(16 * len(z), 2e-3)
    assert frequency[spectrum.argmax()] == pytest.approx(SPEED / WAVE, rel=0.01)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--duration", "9s"), "ends at station 160 m.* and the run is 164.592 m long"),
        (("--set", "track.start=50 m"), "110 m from where the run starts"),
        (("--seed", "3"), "leave out --seed"),
    ],
)
def test_a_run_that_does_not_fit_the_track_is_refused_before_it_starts(file, arguments, message):
    result = run("--track", file, "--speed", "60 ft/s", *arguments)
    assert result.exit_code != 0
    assert "Traceback" not in result.output
    assert re.search(message, result.output.replace("\n", " "))


def test_a_spectrum_in_a_file_becomes_a_track_as_long_as_the_run(tmp_path):
    path = tmp_path / "spectrum.csv"
    path.write_text("# density = one-sided\nfrequency [1/m],profile [m^3]\n0.03,1e-4\n0.3,1e-6\n")
    system = replace(hopper_car("empty", SPEED), experiment=Experiment(0.0, 4.0, 1e-3))
    first, again, other = (track_for(system, path, seed) for seed in (1, 1, 2))
    assert 0 < first.last - 4.0 * SPEED < 12.0
    assert np.array_equal(first.values, again.values)
    assert not np.array_equal(first.values, other.values)
