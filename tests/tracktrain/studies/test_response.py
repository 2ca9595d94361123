"""Response to irregular track: spectra against the linear model, Parseval, friction and flanges."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import tolerances
from orchestrator import System, linearise, simulate
from tracktrain.car.hopper import HOPPER, hopper_car
from tracktrain.cli.main import main
from tracktrain.scales import FOOT
from tracktrain.studies.common.car import StudiedCar
from tracktrain.studies.response.study import response, responses

SPEED = 40 * FOOT
TINY = ("track", "report_rms", "1e-4 mm")


@pytest.fixture(scope="module")
def tiny():
    """A stable speed, on track so smooth that friction sticks and no flange touches."""
    smooth = StudiedCar(settings=[TINY])
    return response(smooth, speeds=[SPEED], duration=30.0, seeds=2).dataset


def band(data, name):
    """Where the track has waves that excite something, away from the first, steep lines."""
    return data[name].isel(speed=0).sel(frequency=slice(2.0, 8.0))


def test_small_motion_follows_the_track_alone(tiny):
    coherence = band(tiny, "displacement_coherence")
    assert float(coherence.min()) > 1 - tolerances.SMALL_MOTION_COHERENCE


@pytest.mark.parametrize("name", ["displacement", "truck_yaw"])
def test_transfer_function_is_that_of_the_linearised_fmus(tiny, name):
    gain = band(tiny, f"{name}_gain").sel(frequency=slice(2.0, 3.0))
    output = responses(HOPPER)[name].variable
    exact = np.array([linear_gain(output, f) for f in gain.frequency.values])
    assert gain.values == pytest.approx(exact, rel=tolerances.WELCH_GAIN)


def linear_gain(output: str, frequency: float) -> float:
    """|output/alignment| of the car without its track, the axles one after the other.

    From the FMUs' directional derivatives in model exchange: no co-simulation, no Welch.
    """
    car = hopper_car(speed=SPEED, track="perfect")
    ports = {c.target for c in car.connections if c.source == "track.speed_out"}
    free = System(
        {name: c for name, c in car.components.items() if name != "track"},
        tuple(c for c in car.connections if not c.source.startswith("track.")),
    )
    for port in ports:
        free = free.with_value(port, SPEED)
    model = _linear(free)
    lag = {"11": 0.0, "12": 68.0, "21": 406.0, "22": 474.0}  # behind the leading axle [in]
    u = np.zeros(len(model.inputs), complex)
    for place, name in enumerate(model.inputs):
        if ".rail_y_" in name:
            delay = lag[name[9:11]] * 0.0254 / SPEED
            u[place] = np.exp(-2j * np.pi * frequency * delay)
    s = 2j * np.pi * frequency * np.eye(len(model.a))
    row = model.outputs.index(output)
    return abs(model.c[row] @ np.linalg.solve(s - model.a, model.b @ u) + model.d[row] @ u)


_found = {}


def _linear(system):
    if "model" not in _found:
        _found["model"] = linearise(system)
    return _found["model"]


def test_spectrum_holds_the_variance_of_the_history(tiny):
    for name in ("displacement", "truck_yaw"):
        history = tiny[name].isel(speed=0)
        density = tiny[f"{name}_density"].isel(speed=0).sel(seed=1)
        step = float(density.frequency[1] - density.frequency[0])
        assert float(density.sum()) * step == pytest.approx(
            float(history.var()), rel=tolerances.WELCH_VARIANCE
        )


@pytest.fixture(scope="module")
def usual():
    return response(speeds=[60 * FOOT, 100 * FOOT], seeds=3)


def test_hunting_takes_the_track_out_of_the_response(usual):
    near = usual.dataset["displacement_coherence"].sel(frequency=slice(2.0, 4.0)).mean("frequency")
    assert float(near[0]) > 0.9 > float(near[1]) + 0.2


def test_faster_means_harsher_in_every_realisation(usual):
    for name in ("force", "lateral_acceleration"):  # displacement ends at the flange
        rms = usual.dataset[f"{name}_rms"]
        assert (rms[1] > rms[0]).all()


def test_the_reports_figures_are_drawn_and_envelopes_are_ordered(usual, tmp_path):
    names = {path.name for path in usual.write(tmp_path)}
    figures = {f"figure_6_{n}.png" for n in (1, 2, 5, 6)}
    assert figures | {"spectra.png", "transfer_functions.png", "envelopes.png"} <= names
    table = usual.tables["rms_envelope"]
    assert (table["5%"] <= table["50%"]).all() and (table["50%"] <= table["95%"]).all()
    assert len(table) == 2 * len(responses(HOPPER))


def test_the_command_says_what_is_wrong_with_a_setting(tmp_path):
    arguments = ["study", "response", "--set", "track.report_rms=0.05", "--out", str(tmp_path)]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 2 and "unit is missing" in result.output


LINE = """\
kind,length [m],radius [m],direction,cant [mm]
straight,10,,,
transition,15,,,
curve,20,400,{way},30
"""


def test_cones_on_straight_track_are_no_profiles_and_no_line():
    options = {"wheel": "cones", "rail": "crown", "layout": Path("straight"), "speed": 20.0}
    assert StudiedCar.taken(options) == StudiedCar() and options == {"speed": 20.0}


def test_a_line_turned_the_other_way_is_the_same_motion_mirrored(tmp_path):
    forces = []
    for way in ("left", "right"):
        line = tmp_path / f"{way}.csv"
        line.write_text(LINE.format(way=way))
        car = StudiedCar(layout=line)
        assert str(car) == f"loaded car along {way}.csv"
        system = car.system(speed=15.0, track="perfect")
        assert system.experiment.stop == pytest.approx(45.0 / 15.0)
        run = simulate(system, duration=system.experiment.stop, record=["*.force_y"])
        forces.append(run.dataset["wheelset_11.force_y"].values)
    assert np.abs(forces[0]).max() > 1e3
    assert forces[0] == pytest.approx(-forces[1], rel=1e-6, abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--wheel", "worn"], "--wheel alone makes no contact; give --rail, too"),
        (["--wheel", "wron", "--rail", "crown"], "did you mean worn"),
        (["--layout", "lost.toml"], "the layout 'lost.toml' cannot be read"),
    ],
)
@pytest.mark.parametrize("study", ["response", "uncertainty"])
def test_profiles_and_lines_are_refused_in_the_words_of_a_run(tmp_path, study, arguments, said):
    for command in (["study", study], ["run"]):
        result = CliRunner().invoke(main, [*command, *arguments, "--out", str(tmp_path)])
        assert result.exit_code == 2 and said in " ".join(result.output.split())
