"""Pictures show what the dataset holds, to the eye and in figures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.text import Text

from tracktrain import plots
from tracktrain.sheets import Sheet

RAILS = ("y_left", "y_right", "z_left", "z_right")


@pytest.fixture
def dataset() -> xr.Dataset:
    """A car that sways at 1 Hz on a sinusoidal alignment of 2 mm amplitude, at 60 ft/s."""
    time = np.arange(0.0, 8.0, 1e-3)
    wave = np.sin(2.0 * np.pi * time)
    variables = {
        "wheelset_11.force_y": 10e3 * wave,
        "wheelset_11.y_rel": 5e-3 * wave,
        "track.speed_out": np.full_like(time, 18.288),
        "track.distance": 18.288 * time,
        **{f"track.axle[1].rail_{rail}": 2e-3 * wave * rail.startswith("y") for rail in RAILS},
        **{f"carbody.cg.{name}": wave for name in ("y", "roll", "yaw", "ay", "az")},
    }
    return xr.Dataset({n: ("time", v) for n, v in variables.items()}, coords={"time": time})


def test_lateral_force_picture_gives_rms_and_peak_in_both_units(dataset: xr.Dataset) -> None:
    (title,) = (text for text in _texts(plots.plot_lateral_force(dataset)) if "rms" in text)
    assert "40.9 mph (60 ft/s)" in title
    assert "rms (dashed) 7.07 kN (1,590 lb)" in title
    assert "peak 10 kN (2,250 lb)" in title


def test_track_picture_leaves_out_channels_that_are_perfect(dataset: xr.Dataset) -> None:
    texts = _texts(plots.plot_track(dataset))
    assert [text for text in texts if "[mm]" in text] == ["alignment\n[mm]"]


def test_perfect_track_is_drawn_as_such(dataset: xr.Dataset) -> None:
    perfect = dataset.assign({f"track.axle[1].rail_{r}": dataset["time"] * 0 for r in RAILS})
    assert any(": perfect" in text for text in _texts(plots.plot_track(perfect)))


def test_long_run_keeps_its_peaks_in_a_picture_of_few_points() -> None:
    time = np.arange(200_003) * 1e-3
    force = np.sin(time)
    force[123_457], force[-1] = 9e3, -8e3
    x, y = plots.envelope(time, force)
    assert len(x) < 2 * plots.POINTS
    assert np.max(y) == 9e3
    assert x[np.argmax(y)] == pytest.approx(123.457)
    assert np.min(y) == -8e3
    assert np.all(np.diff(x) >= 0.0)


def test_a_curve_meets_the_numbers_of_both_rulers_where_it_has_their_values(
    dataset: xr.Dataset,
) -> None:
    sheet = plots.plot_track(dataset)
    curve = max(_of(Line2D, sheet), key=lambda line: len(line.get_xdata()))
    height = {
        text.get_text(): text.get_position()[1]
        for text in _of(Text, sheet)
        if text.get_ha() in ("left", "right")
    }
    middle = height["0"]
    top = np.max(curve.get_ydata()) - middle  # 2 mm
    assert top == pytest.approx(height["2"] - middle, rel=1e-4)
    assert top == pytest.approx((height["0.05"] - middle) * 2 / (0.05 * 25.4), rel=1e-4)


def _texts(sheet: Sheet) -> list[str]:
    return [text.get_text() for text in _of(Text, sheet)]


def _of(kind: type[Any], sheet: Sheet) -> list[Any]:
    return [artist for artist in sheet.artists if isinstance(artist, kind)]


def test_written_pictures_have_curves_in_them(dataset: xr.Dataset, tmp_path: Path) -> None:
    files = plots.write_pictures(dataset, tmp_path)
    assert {file.name for file in files} == set(plots.PICTURES)
    for file in files:
        image = imread(file)[..., :3]
        inked = np.mean(image.min(axis=-1) < 0.9)
        assert image.shape[1] > 800
        assert 0.01 < inked < 0.5


def test_pictures_of_missing_variables_are_left_out(dataset: xr.Dataset, tmp_path: Path) -> None:
    without = dataset.drop_vars(["track.distance", "carbody.cg.az"])
    names = [file.name for file in plots.write_pictures(without, tmp_path)]
    assert names == ["lateral_force.png", "displacement.png"]
