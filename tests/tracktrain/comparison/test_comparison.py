"""Runs beside each other: what differs, what came out, and one page of both."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from orchestrator import simulate
from tracktrain.car.hopper import hopper_car
from tracktrain.cli.main import main
from tracktrain.comparison import compare, write_comparison
from tracktrain.comparison.differences import differences
from tracktrain.comparison.numbers import numbers
from tracktrain.errors import TracktrainError
from tracktrain.quantities import shown_quantities
from tracktrain.statistics import dominant, swaying

TIME = np.linspace(0.0, 10.0, 1001)


def run(
    folder: Path, amplitude: float, frequency: float = 2.0, rows: int = 1001, **values: float
) -> Path:
    """A run of a pump that shakes, in a folder."""
    folder.mkdir()
    time = TIME[:rows]
    curve = amplitude * np.sin(2 * np.pi * frequency * time)
    attributes = {"parameters": json.dumps(values), "step": 0.01, "master": "one-pass"}
    xr.Dataset(
        {"pump.shaft.y": ("time", curve, {"units": "m"})},
        {"time": ("time", time, {"units": "s"})},
        attributes,
    ).to_netcdf(folder / "results.nc", engine="netcdf4")
    return folder


def test_what_differs_is_told_once_for_all_instances_that_share_it(tmp_path: Path) -> None:
    given = {"pump.mass": 2.0, "left.gain": 1.0, "right.gain": 1.0}
    first = run(tmp_path / "a", 0.001, **given)
    second = run(tmp_path / "b", 0.001, **{**given, "left.gain": 3.0, "right.gain": 3.0})
    found = compare([first, second]).differences
    assert found.index.tolist() == [("parameter", "gain", "left, right")]
    assert found.loc[("parameter", "gain", "left, right")].tolist() == ["1", "3"]


def test_a_parameter_that_only_one_run_has_differs(tmp_path: Path) -> None:
    runs = {"a": xr.Dataset(coords={"time": TIME}), "b": xr.Dataset(coords={"time": TIME})}
    runs["b"].attrs["parameters"] = json.dumps({"pump.mass": 2.0})
    assert differences(runs).loc[("parameter", "mass", "pump")].tolist() == ["-", "2"]


def test_a_tracks_spectrum_differs_by_its_name_and_the_speed_has_its_unit() -> None:
    cars = [hopper_car("loaded", speed, track) for speed, track in ((10.0, "fra4"), (12.0, "fra5"))]
    runs = {f"{n}": simulate(car, duration=0.01, step=1e-3).dataset for n, car in enumerate(cars)}
    found = differences(runs)
    assert found.loc[("parameter", "spectrum", "track")].tolist() == ["fra4", "fra5"]
    assert found.loc[("parameter", "speed [m/s]", "track")].tolist() == ["10", "12"]


def test_numbers_stand_side_by_side_in_units_that_suit(tmp_path: Path) -> None:
    first, second = run(tmp_path / "a", 0.001), run(tmp_path / "b", 0.003, frequency=4.0)
    found = compare([first, second / "results.nc"]).numbers
    rms = found.loc[("pump.shaft.y", "rms [mm]")]
    assert rms["a"] == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert rms["b / a"] == pytest.approx(3.0, rel=1e-3)
    frequency = found.loc[("pump.shaft.y", "dominant frequency [Hz]")]
    assert frequency[["a", "b", "b / a"]].tolist() == pytest.approx([2.0, 4.0, 2.0], rel=1e-2)


@pytest.mark.parametrize(("factor", "answer"), [(1.02, "no"), (3.0, "yes")])
def test_a_difference_counts_when_it_is_larger_than_the_intervals(
    factor: float, answer: str
) -> None:
    """Noise of two realisations, whose rms scatters by 2 %."""
    time = np.linspace(0.0, 20.0, 2001)
    curves = [np.random.default_rng(n).normal(size=time.size) for n in (1, 2)]
    runs = {
        name: xr.Dataset({"y": ("time", curve, {"units": "m"})}, {"time": time})
        for name, curve in zip("ab", (curves[0], factor * curves[1]), strict=True)
    }
    found = numbers(runs, shown_quantities(runs)).iloc[:1]
    assert found["b differs"].tolist() == [answer]
    assert 0.5 < float(found["a ± [%]"].iloc[0]) < 10.0


def test_equal_numbers_do_not_differ_though_their_intervals_are_not_known() -> None:
    time = np.linspace(0.0, 2.0, 201)
    one = xr.Dataset({"y": ("time", np.sin(9.0 * time), {"units": "m"})}, {"time": time})
    found = numbers({"a": one, "b": one.copy()}, shown_quantities({"a": one, "b": one}))
    assert set(found["b differs"]) == {"no"}


def test_the_dominant_frequency_of_a_run_through_a_curve_is_that_of_the_motion() -> None:
    time = np.linspace(0.0, 40.0, 4001)
    curve = np.clip(np.minimum(time - 8.0, 30.0 - time) / 4.0, 0.0, 1.0)
    motion = 8.0 * curve + np.sin(2.0 * np.pi * time)
    columns = {"track.curvature": curve / 600.0, "wheelset_11.y_rel": motion}
    data = xr.Dataset({k: ("time", v, {"units": "m"}) for k, v in columns.items()}, {"time": time})
    assert dominant(data["wheelset_11.y_rel"]).value < 0.1
    assert dominant(swaying(data, "wheelset_11.y_rel")).value == pytest.approx(1.0, rel=0.01)
    straight = data.assign({"track.curvature": 0.0 * data["track.curvature"]})
    np.testing.assert_array_equal(swaying(straight, "wheelset_11.y_rel").values, motion)


def test_a_run_that_still_grows_is_said_and_its_numbers_are_its_own_span(tmp_path: Path) -> None:
    first, second = run(tmp_path / "a", 0.001), run(tmp_path / "b", 0.001)
    data = xr.load_dataset(second / "results.nc")
    data["pump.shaft.y"] = data["pump.shaft.y"] * np.exp(0.4 * data["time"])
    data["pump.shaft.y"].attrs["units"] = "m"
    data.to_netcdf(second / "results.nc", engine="netcdf4")
    notes = compare([first, second]).notes
    assert any(n.startswith("b has not settled (pump.shaft.y growing)") for n in notes)
    assert not any(n.startswith("a has not settled") for n in notes)


def test_spans_that_differ_are_said_and_can_be_made_alike(tmp_path: Path) -> None:
    long, short = run(tmp_path / "a", 0.001), run(tmp_path / "b", 0.001, rows=501)
    assert any(
        "the spans differ: a 0 to 10 s, b 0 to 5 s" in n for n in compare([long, short]).notes
    )
    assert any("same values to the last bit" in n for n in compare([long, short], end=5.0).notes)


def test_a_folder_without_its_name_in_common_tells_runs_apart(tmp_path: Path) -> None:
    for name in ("soft", "stiff"):
        (tmp_path / name).mkdir()
        run(tmp_path / name / "out", 0.001)
    places = [tmp_path / "soft" / "out", tmp_path / "stiff" / "out"]
    assert list(compare(places).runs) == ["soft/out", "stiff/out"]


@pytest.mark.parametrize(
    ("places", "asked", "begin", "said"),
    [
        (["a"], [], None, "needs two runs or more"),
        (["a", "a/results.nc"], [], None, "is named twice"),
        (["a", "c"], [], None, "there is no results.nc in"),
        (["a", "b"], ["pump.shaft.x"], None, "did you mean pump.shaft.y"),
        (["a", "b"], [], 11.0, "run a goes from 0 to 10 s and has 0 rows"),
    ],
)
def test_what_cannot_be_compared_is_named(
    tmp_path: Path, places: list[str], asked: list[str], begin: float | None, said: str
) -> None:
    run(tmp_path / "a", 0.001)
    run(tmp_path / "b", 0.001)
    with pytest.raises(TracktrainError, match=said):
        compare([tmp_path / place for place in places], asked, begin)


def test_the_page_needs_nothing_else(tmp_path: Path) -> None:
    found = compare([run(tmp_path / "a", 0.001, **{"p.k": 1.0}), run(tmp_path / "b", 0.002)])
    page, *others = write_comparison(found, tmp_path)
    text = page.read_text()
    assert "://" not in text.replace("http://www.w3.org/2000/svg", "")
    known = json.loads(text.partition('id="known">')[2].partition("</script>")[0])
    assert known["runs"] == ["a", "b"] and known["first"] == ["pump.shaft.y"]
    assert {"signals0", "signals1", "density0", "density1"} <= known["arrays"].keys()
    assert text.index("What differs") < text.index("Numbers") < text.index("Signals")
    assert all(path.stat().st_size for path in others)


def test_the_command_prints_what_differs_first(tmp_path: Path) -> None:
    places = [run(tmp_path / "a", 0.001, **{"p.k": 1.0}), run(tmp_path / "b", 0.002)]
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["compare", *map(str, places), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert result.output.index("what differs") < result.output.index("what came out")
    assert (out / "comparison.html").is_file()


def test_a_parameter_without_a_say_and_a_signal_at_rest_are_told(tmp_path: Path) -> None:
    first = run(tmp_path / "a", 0.001, **{"pump.colour": 1.0})
    second = run(tmp_path / "b", 0.001, **{"pump.colour": 2.0})
    said = compare([first, second]).notes
    assert any("to the last bit" in note and "pump colour had no say" in note for note in said)
    still = run(tmp_path / "c", 0.0)
    assert "not excited in c: pump.shaft.y" in compare([first, still]).notes
