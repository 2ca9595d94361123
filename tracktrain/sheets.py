"""A picture by matplotlib's renderer alone: figure and axes take longer to load than to draw."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray
from PIL import Image

INCH = 72.0
"""[pt]"""

COMPRESSION = 1
"""Of 9: less than half the time of the usual 6."""


class Sheet:
    """A white sheet, and the artists that are drawn on it.

    width, height: [in]. dpi: pixels per inch. Artists are placed in points from its lower left
    corner; to them it is the figure that they belong to, of which they ask for its dpi alone.
    """

    def __init__(self, width: float, height: float, dpi: float) -> None:
        self.dpi = dpi
        self.artists: list[Artist] = []
        self._points = Affine2D().scale(1.0 / INCH).scale(dpi)
        self._width, self._height = (int(round(side * dpi, 6)) for side in (width, height))

    def get_figure(self, root: bool = False) -> Sheet:
        """Itself, as matplotlib's figures answer."""
        return self

    def add(self, artist: Artist) -> None:
        """Have an artist drawn, with those of the same zorder in the order given."""
        figure: Any = self
        artist.set_figure(figure)
        artist.set_transform(self._points)
        self.artists.append(artist)

    def pixels(self) -> NDArray[np.uint8]:
        """The picture: rows from above, pixels from the left, red, green, blue and alpha."""
        renderer = RendererAgg(self._width, self._height, self.dpi)
        drawn = np.asarray(renderer.buffer_rgba())
        drawn.fill(255)
        for artist in sorted(self.artists, key=Artist.get_zorder):
            artist.draw(renderer)
        return drawn

    def savefig(self, path: Path) -> None:
        """Write a PNG file, named as that of matplotlib's figures.

        Raises OSError.
        """
        picture = Image.fromarray(self.pixels())
        picture.save(path, "png", compress_level=COMPRESSION, dpi=(self.dpi, self.dpi))
