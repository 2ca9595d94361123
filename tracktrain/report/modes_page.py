"""A structure's modes as one page: each moves, with tables and pictures below; no network."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fmus.carbody.modal_data import ModalData

from . import as_json
from .packing import packed
from .rendering import rendered
from .sheet import parts, png

Array = NDArray[Any]
SCRIPTS = ("common.js", "data.js", "scene.js", "player.js", "mesh.js", "modes.js")
"""In the order in which they need each other."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A structure to draw, and how its modes move it.

    points: (points, 3) [m]. faces: (faces, 5), four points and a part; a triangle has its last
    point twice. lines: (lines, 3), two points and a part. parts: names. shapes: (modes, points, 3).
    """

    points: Array
    shapes: Array
    parts: Sequence[str]
    faces: Array = field(default_factory=lambda: np.zeros((0, 5), int))
    lines: Array = field(default_factory=lambda: np.zeros((0, 3), int))

    @classmethod
    def of(cls, data: ModalData) -> Drawing:
        """The points of modal data and the lines between them."""
        lines = [(data.index(a), data.index(b), 0) for a, b in data.edges]
        return cls(
            np.array([point.position for point in data.points]),
            data.shapes[:, :, :3],
            ("carbody",),
            lines=np.array(lines, int).reshape(-1, 3),
        )

    @property
    def moved(self) -> Array:
        """Shapes whose largest displacement is 1 m."""
        most = np.linalg.norm(self.shapes, axis=2).max(axis=1)
        return self.shapes / np.where(most > 0, most, 1.0)[:, None, None]


def modes_page(
    title: str,
    drawing: Drawing,
    modes: Sequence[tuple[str, str]],
    tables: Mapping[str, pd.DataFrame],
    pictures: Mapping[str, Figure],
    notes: Sequence[str] = (),
) -> str:
    """The text of the page. modes: name of each, and what is said below it."""
    arrays = {"points": drawing.points, "motions": drawing.moved}
    arrays |= {"faces": drawing.faces} if len(drawing.faces) else {}
    arrays |= {"lines": drawing.lines} if len(drawing.lines) else {}
    index, blob = packed(arrays)
    known = {
        "parts": list(drawing.parts),
        "modes": [{"name": name, "said": said} for name, said in modes],
        "arrays": index,
    }
    return rendered(
        "modes.html",
        SCRIPTS,
        title=title,
        notes=notes,
        index=as_json(known),
        blob=blob,
        **parts(tables, {name: png(figure) for name, figure in pictures.items()}),
    )
