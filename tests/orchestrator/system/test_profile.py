"""Inputs that follow a table: what a table must be, and that the system moves as it says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.catalogue import fmu_path
from orchestrator import (
    Component,
    Connection,
    CouplingError,
    InlineModel,
    Profile,
    ProfileError,
    System,
    read_profile,
    resume,
    simulate,
)
from orchestrator.errors import OrchestratorError

RUN_DOWN = Profile("speed", "m/s", (0.0, 1.0, 3.0), (20.0, 20.0, 8.0))
DISTANCE = 20.0 + 2.0 * 14.0
"""Area below RUN_DOWN [m]."""


def table(folder, text):
    path = folder / "profile.csv"
    path.write_text(text)
    return path


def rolling() -> System:
    return System({"track": Component(fmu_path("track"), {"spectrum": "perfect", "speed": 5.0})})


@pytest.mark.parametrize("master", ["one-pass", "iterated"])
@pytest.mark.parametrize("step", [0.1, 0.05])
def test_distance_is_the_area_below_the_speed(master, step):
    run = simulate(rolling().driven("track.speed", RUN_DOWN), master, duration=3.0, step=step)
    assert run.completed, run.message
    assert run.dataset["track.distance"][-1] == pytest.approx(DISTANCE, rel=1e-13)
    speed = run.dataset["track.speed_out"]
    assert speed.values == pytest.approx(np.interp(speed.time, (0, 1, 3), (20, 20, 8)), rel=1e-13)


def test_a_table_is_known_by_its_numbers_wherever_it_was_read():
    hashes = [
        replace(RUN_DOWN, **changes).description.sha256
        for changes in ({}, {"origin": "elsewhere.csv"}, {"unit": "km/h"}, {"times": (0, 1, 4.0)})
    ]
    assert hashes[0] == hashes[1] != "" and len(set(hashes)) == 3


def test_corners_between_macro_steps_cost_the_square_of_the_step():
    corner = Profile("speed", "m/s", (0.0, 1.0 / 3.0, 1.0), (0.0, 20.0, 0.0))
    errors = []
    for step in (0.02, 0.01, 0.005):
        run = simulate(rolling().driven("track.speed", corner), duration=1.0, step=step)
        errors.append(abs(float(run.dataset["track.distance"][-1]) - 10.0))
    assert max(e / s**2 for e, s in zip(errors, (0.02, 0.01, 0.005), strict=True)) < 45.0


def test_a_table_that_ends_with_the_run_gives_no_cause_for_doubt():
    system = rolling().driven("track.speed", RUN_DOWN)
    run = simulate(system, duration=3.0, step=0.1, self_test=True)
    assert run.completed, run.message
    assert "self-test failed" not in str(run.verdict)
    assert not any("self-test" in note for note in run.notes)


def test_an_oscillator_driven_by_a_table_converges_with_second_order():
    """x'' = u - x with u a ramp: x = t - sin t."""

    def step(x, u, rate, p, time, step):
        # exact for an input that is linear over the step
        c, s, r = np.cos(step), np.sin(step), rate["u"]
        a, b = x[0] - u["u"], x[1] - r
        return (u["u"] + r * step + a * c + b * s, r - a * s + b * c)

    oscillator = InlineModel(
        inputs={"u": "1"},
        outputs={"x": "1"},
        initial=lambda p: (0.0, 0.0),
        step=step,
        output=lambda x, u, p: {"x": x[0]},
    )
    ramp = Profile("u", "1", (0.0, 5.0), (0.0, 5.0))
    run = simulate(
        System({"osc": Component(oscillator)}).driven("osc.u", ramp), duration=5.0, step=0.1
    )
    time = run.dataset.time.values
    assert run.dataset["osc.x"].values == pytest.approx(time - np.sin(time), abs=1e-12)


def test_units_of_the_columns_are_converted(tmp_path):
    path = table(tmp_path, "# run-down\ntime [min]; speed [km/h]\n0;72\n0.05;36\n")
    profile = read_profile(path)
    assert profile.times == (0.0, pytest.approx(3.0))
    run = simulate(rolling().driven("track.speed", profile), duration=3.0, step=0.1)
    assert run.dataset["track.distance"][-1] == pytest.approx(45.0)


def test_a_column_is_chosen_by_name(tmp_path):
    path = table(tmp_path, "time [s],force [N],speed [m/s]\n0,1,10\n1,2,20\n")
    assert read_profile(path, "force").values == (1.0, 2.0)
    assert read_profile(path, likely=("track.speed", "speed")).values == (10.0, 20.0)
    with pytest.raises(ProfileError, match=r"no column 'mass'; .*force, speed"):
        read_profile(path, "mass")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must name the columns, time first"),
        ("0,1\n1,2\n", "must name the columns, time first"),
        ("time [s],speed\n0,1\n1,2\n", "column 'speed' has no unit"),
        ("time [s],speed [frog]\n0,1\n1,2\n", "'frog' is not a known unit"),
        ("time [m],speed [m/s]\n0,1\n1,2\n", "in m, which is no time"),
        ("time [s],speed [m/s]\n0,1\n", "at least two points"),
        ("time [s],speed [m/s]\n0,1\n2,2\n1,3\n", "must increase: 1 of line 4 follows 2"),
        ("time [s],speed [m/s]\n0,1\n0,2\n", "must increase"),
        ("time [s],speed [m/s]\n0,1\n1,\n", "line 3: a cell is empty: a gap"),
        ("time [s],speed [m/s]\n0,1\n1\n", "line 3 has 1 cells, and the first line 2"),
        ("time [s],speed [m/s]\n0,1\n1,fast\n", "line 3: 'fast' is no number"),
        ("time [s],speed [m/s]\n0,nan\n1,2\n", "line 2: .* is not finite"),
    ],
)
def test_a_bad_table_is_refused_with_what_is_wrong(tmp_path, text, said):
    with pytest.raises(ProfileError, match=said) as caught:
        read_profile(table(tmp_path, text))
    assert "profile.csv" in str(caught.value)


def test_a_missing_table_is_named(tmp_path):
    with pytest.raises(ProfileError, match=r"none\.csv cannot be read: no such file"):
        read_profile(tmp_path / "none.csv")


def test_a_table_in_python_is_checked_too():
    with pytest.raises(ProfileError, match="point 1 is"):
        Profile("speed", "m/s", (0.0, 1.0), (1.0, float("nan")))
    with pytest.raises(ProfileError, match="2 times and 1 values"):
        Profile("speed", "m/s", (0.0, 1.0), (1.0,))


def test_a_run_longer_than_its_table_is_refused_before_it_begins():
    system = rolling().driven("track.speed", RUN_DOWN)
    with pytest.raises(ProfileError, match=r"goes from 0 to 3 s.*track_speed from 0 to 4 s"):
        simulate(system, duration=4.0, step=0.1)
    late = Profile("speed", "m/s", (0.5, 4.0), (1.0, 1.0))
    with pytest.raises(ProfileError, match=r"from 0\.5 to 4 s"):
        simulate(rolling().driven("track.speed", late), duration=2.0, step=0.1)


def test_a_table_of_another_quantity_is_refused_with_both_ends():
    mass = Profile("mass", "kg", (0.0, 1.0), (1.0, 1.0))
    with pytest.raises(OrchestratorError, match=r"track\.speed.*track_speed\.mass"):
        simulate(rolling().driven("track.speed", mass), duration=1.0, step=0.1)


def test_an_input_is_driven_once():
    system = rolling().driven("track.speed", RUN_DOWN)
    with pytest.raises(CouplingError, match=r"driven by track_speed\.speed"):
        system.driven("track.speed", RUN_DOWN)
    both = System(
        {**rolling().components, "axle": Component(fmu_path("wheelrail"))},
        (Connection("track.speed_out", "axle.speed"),),
    )
    with pytest.raises(CouplingError, match=r"driven by track\.speed_out"):
        both.driven("axle.speed", RUN_DOWN)


def test_a_driven_run_goes_on_from_its_checkpoint(tmp_path):
    system = rolling().driven("track.speed", RUN_DOWN)
    whole = simulate(system, duration=3.0, step=0.1)

    def stop(time, wall):
        if time > 1.0:
            raise KeyboardInterrupt

    cut = simulate(system, duration=3.0, step=0.1, out=tmp_path, checkpoint=0.2, progress=stop)
    if not cut.completed:
        cut = resume(tmp_path)
    assert np.array_equal(cut.dataset["track.distance"], whole.dataset["track.distance"])
