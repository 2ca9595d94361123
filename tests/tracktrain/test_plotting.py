"""Signals of runs in a picture, named and shown as people ask for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from tracktrain import plot
from tracktrain.cli.main import main
from tracktrain.errors import TracktrainError

TIME = np.linspace(0.0, 4.0, 401)


def run(amplitude: float = 0.001) -> xr.Dataset:
    """A pump whose shaft shakes at 5 Hz, beside a speed that goes over it."""
    curve = amplitude * np.sin(10 * np.pi * TIME)
    signals = {"pump.shaft.y": (curve, "m"), "pump.shaft.force_y": (3e4 * curve, "N")}
    signals |= {"track.distance": (20.0 * TIME, "m")}
    return xr.Dataset(
        {name: ("time", values, {"units": unit}) for name, (values, unit) in signals.items()},
        {"time": ("time", TIME, {"units": "s"})},
    )


def test_a_signal_is_drawn_in_the_unit_that_was_asked_for():
    (axes,) = plot(run(), "Pump shaft force y in lbf").axes
    assert axes.get_ylabel() == "pump.shaft.force_y\n[lbf]"
    assert max(axes.lines[0].get_ydata()) == pytest.approx(30.0 / 4.4482216152605, rel=1e-3)


def test_runs_lie_over_each_other_and_are_named():
    (axes,) = plot({"weak": run(), "strong": run(0.002)}, "pump.shaft.y").axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["weak", "strong"]
    assert [max(line.get_ydata()) for line in axes.lines] == pytest.approx([1.0, 2.0], rel=1e-3)


def test_two_signals_against_each_other_are_the_law_between_them():
    (axes,) = plot(run(), "force_y in N", over="shaft.y in m").axes
    x, y = axes.lines[0].get_data()
    np.testing.assert_allclose(y, 3e4 * x, rtol=1e-12)


@pytest.mark.parametrize(("over", "peak", "unit"), [("time", 5.0, "Hz"), ("distance", 0.25, "1/m")])
def test_the_spectrum_of_a_shake_peaks_at_its_frequency(over: str, peak: float, unit: str):
    """5 Hz at 20 m/s are 0.25 waves a metre."""
    (axes,) = plot(run(), "pump.shaft.y", over=over, spectrum=True).axes
    frequency, density = axes.lines[0].get_data()
    assert frequency[np.argmax(density)] == pytest.approx(peak, rel=0.1)
    assert unit in axes.get_xlabel() and unit in axes.get_ylabel()


@pytest.mark.filterwarnings("error")
def test_a_spectrum_of_what_does_not_vary_says_so():
    (axes,) = plot({"a": run(0.0), "b": run(0.0)}, "pump.shaft.y", spectrum=True).axes
    assert [text.get_text() for text in axes.texts] == ["does not vary: no spectrum"]


def test_signals_of_one_unit_share_a_panel():
    figure = plot(run(), ["pump.shaft.*", "track.distance"], together=True)
    assert [len(axes.lines) for axes in figure.axes] == [1, 1, 1]
    figure = plot(run(), ["pump.shaft.y in m", "track.distance in m"], together=True)
    assert [len(axes.lines) for axes in figure.axes] == [2]


def test_a_legend_of_many_signals_names_the_first_and_counts_the_others():
    many = run().assign({f"fan.y{n}": run()["pump.shaft.y"] for n in range(30)})
    (axes,) = plot(many, "fan.*", together=True).axes
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert len(axes.lines) == 30 and len(names) == 12
    assert names[0] == "fan.y0" and names[-1] == "and 19 more"


@pytest.mark.parametrize(
    ("of", "options", "said"),
    [
        ("pump.shaft.x", {}, "no signal 'pump.shaft.x' in run 1; did you mean pump.shaft.y"),
        ("shaft.y in lbf", {}, "a signal in m cannot be shown in lbf"),
        ("shaft.y in glug", {}, "'glug' is not a known unit"),
        ("shaft.y", {"over": "pump.shaft.*"}, "is not one signal that every run has"),
        ("shaft.y", {"over": "force_y", "spectrum": True}, "over time or distance"),
        ("shaft.y", {"end": 0.05, "spectrum": True}, "6 rows there, and a spectrum takes 16"),
    ],
)
def test_what_cannot_be_drawn_is_named(of: str, options: dict, said: str):
    with pytest.raises(TracktrainError, match=said):
        plot(run(), of, **options)


def test_the_command_writes_the_picture(tmp_path: Path):
    run().to_netcdf(tmp_path / "results.nc", engine="netcdf4")
    file = tmp_path / "new" / "shaft.svg"
    arguments = ["plot", str(tmp_path), "--of", "*shaft.*", "--out", str(file)]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert result.output.strip() == str(file) and "<svg" in file.read_text()
    result = CliRunner().invoke(main, ["plot", str(tmp_path), "--out", "shaft.doc"])
    assert result.exit_code == 2 and ".png, .svg, .pdf" in result.output
