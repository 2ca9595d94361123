"""A sheet is what matplotlib's own figure makes of the same artists."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.markers import TICKLEFT
from matplotlib.text import Text
from matplotlib.transforms import Affine2D
from PIL import Image

from tracktrain.sheets import INCH, Sheet

DPI = 120


@pytest.mark.parametrize(
    "height",
    [2.0, 0.8 + 1.58 - 0.18 + 0.5, 2.48],
    ids=["whole pixels", "whole pixels but for rounding", "0.6 of a pixel more"],
)
def test_a_sheet_has_the_pixels_of_a_figure(height: float, tmp_path: Path) -> None:
    sheet, figure = Sheet(5.0, height, DPI), Figure(figsize=(5.0, height))
    for artist in _artists():
        sheet.add(artist)
    points = Affine2D().scale(1.0 / INCH) + figure.dpi_scale_trans
    for artist in _artists():
        artist.set_transform(points)
        figure.add_artist(artist)
    sheet.savefig(tmp_path / "sheet.png")
    figure.savefig(tmp_path / "figure.png", dpi=DPI)
    drawn = imread(tmp_path / "sheet.png")
    assert np.array_equal(drawn, imread(tmp_path / "figure.png"))
    assert 0.01 < np.mean(drawn.min(axis=-1) < 0.9) < 0.5
    with Image.open(tmp_path / "sheet.png") as image:
        assert image.info["dpi"] == pytest.approx((DPI, DPI), abs=0.02)


def _artists() -> Iterator[Artist]:
    """A wave over a grid that is given later, marks, and lines of text that are turned."""
    x = np.linspace(20.0, 300.0, 500)
    yield Line2D(x, 70.0 + 50.0 * np.sin(x), color="red")
    yield Line2D([20.0, 300.0], [70.0, 70.0], linewidth=9.0, zorder=0.5)
    places = np.linspace(20.0, 120.0, 6)
    yield Line2D(np.full(6, 20.0), places, linestyle="none", marker=TICKLEFT)
    yield Text(12.0, 70.0, "force\n[kN]", rotation=90, rotation_mode="anchor", ha="center")
    yield Text(200.0, 130.0, "0.5 mm²", va="top")
