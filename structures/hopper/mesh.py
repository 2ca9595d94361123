"""Patches and lines cut into elements; nodes that meet are one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..model import Element

Array = NDArray[np.float64]
Place = tuple[float, float, float]

MERGED = 1e-6
"""Nodes closer than this [m] are one."""


@dataclass
class Mesh:
    """Collects nodes and elements. cuts: into how many elements each side of a patch is cut."""

    cuts: int
    nodes: dict[int, Place] = field(default_factory=dict)
    elements: list[Element] = field(default_factory=list)
    _known: dict[tuple[int, int, int], int] = field(default_factory=dict)

    def node(self, place: Sequence[float] | Array) -> int:
        """The number of the node at a place [m], from 1."""
        x, y, z = (float(value) for value in place)
        key = (round(x / MERGED), round(y / MERGED), round(z / MERGED))
        if key not in self._known:
            self._known[key] = len(self.nodes) + 1
            self.nodes[self._known[key]] = (x, y, z)
        return self._known[key]

    def patch(self, corners: Sequence[Sequence[float]], section: str, part: str) -> None:
        """A quadrilateral by its corners in order, cut evenly; two corners may be one place.

        Then it is a triangle, whose elements at that place are triangles.
        """
        a, b, c, d = (np.array(corner, float) for corner in corners)
        share = np.linspace(0.0, 1.0, self.cuts + 1)
        grid = [
            [
                self.node((1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d)
                for u in share
            ]
            for v in share
        ]
        for i in range(self.cuts):
            for j in range(self.cuts):
                ring = [grid[i][j], grid[i][j + 1], grid[i + 1][j + 1], grid[i + 1][j]]
                own = tuple(dict.fromkeys(ring))
                kind = {3: "triangle", 4: "quad"}.get(len(own))
                if kind:
                    self.elements.append(Element(kind, own, section, part))

    def line(
        self,
        ends: tuple[Sequence[float], Sequence[float]],
        section: str,
        part: str,
        up: Place = (0.0, 0.0, 1.0),
    ) -> None:
        """Beams along a straight line, as many as a patch has elements along its side."""
        a, b = (np.array(end, float) for end in ends)
        nodes = [self.node(a + u * (b - a)) for u in np.linspace(0.0, 1.0, self.cuts + 1)]
        for first, second in pairwise(nodes):
            self.elements.append(Element("beam", (first, second), section, part, up))
