"""Where a wheelset on profiles touches, as CasADi functions that read its tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import casadi as ca

from ..describe.block import Signals
from .block import SIDES, by_name
from .columns import ELASTIC, KINEMATIC, LINEAR, Columns
from .touching import Wheels

OfSignals = Callable[..., ca.Function]
"""As of `WheelRail`: CasADi function of u, p, d and more, out of one of their signals."""


class Spots:
    """The spots at which these patches of both wheels touch.

    law: `linear`, or any other. columns: by side.
    """

    def __init__(
        self, of_signals: OfSignals, columns: dict[str, Columns], law: str, patches: Sequence[str]
    ) -> None:
        self.of_signals, self.columns, self.law = of_signals, columns, law
        self.names = KINEMATIC + ELASTIC * (law != LINEAR)
        self.spots = [(side, patch) for patch in patches for side in SIDES]
        self.splines = [columns[side].spline(patch, self.names) for side, patch in self.spots]

    def wheels(self, u: Signals, p: Signals, d: Signals) -> Wheels:
        return Wheels(self.law, self.columns, u, p, d)

    def named(self, columns: Any) -> dict[tuple[str, str], Signals]:
        """Columns of the tables by side and patch, and by name."""
        each = (by_name(self.names, column) for column in ca.horzsplit(columns))
        return dict(zip(self.spots, each, strict=True))

    def rows(self, u: ca.MX, p: ca.MX, d: ca.MX) -> tuple[ca.MX, list[ca.MX]]:
        """Part of its interval that lies before each spot, and the interval's coefficients."""
        numbers, parts = self._places(u, p, d)
        each = zip(self.splines, ca.vertsplit(numbers), strict=True)
        return parts, [spline.row(number) for spline, number in each]

    def looked_up(self, u: Any, p: Any, d: Any, parts: Any, *rows: Any) -> list[Any]:
        """The columns (column, spot)."""
        yaw = self.wheels(u, p, d).yaw
        values = (s.value(parts[i], rows[i]) for i, s in enumerate(self.splines))
        at_yaw = (self.columns[side].at_yaw for side, _ in self.spots)
        return [ca.horzcat(*(at(value, yaw) for at, value in zip(at_yaw, values, strict=True)))]

    def met(self, u: ca.MX, p: ca.MX, d: ca.MX) -> list[ca.MX]:
        """Columns at the spots, then what `Wheels.rotation` has of the contacts there."""
        parts, rows = self.rows(u, p, d)
        columns = self._looked_up(u, p, d, parts, *rows)
        return [columns, *self._contacts(u, p, d, columns)]

    @cached_property
    def _places(self) -> ca.Function:
        def places(*at: Any) -> list[Any]:
            found = self.wheels(*at).places()
            pairs = [spline.place(found[i]) for i, spline in enumerate(self.splines)]
            return [ca.vertcat(*half) for half in zip(*pairs, strict=True)]

        return self.of_signals("places", ca.SX, places)

    @cached_property
    def _looked_up(self) -> ca.Function:
        return self.of_signals("columns", ca.SX, self.looked_up, **self.shapes)

    @cached_property
    def _contacts(self) -> ca.Function:
        def contacts(u: Any, p: Any, d: Any, columns: Any) -> list[Any]:
            wheels = self.wheels(u, p, d)
            return wheels.rotation(wheels.touches(self.named(columns)))

        shape = (len(self.names), len(self.spots))
        return self.of_signals("contacts", ca.SX, contacts, columns=shape)

    @property
    def shapes(self) -> dict[str, tuple[int, int]]:
        """Of what `looked_up` takes."""
        rows = {f"row{i}": (s.table.size1(), 1) for i, s in enumerate(self.splines)}
        return {"parts": (len(self.spots), 1), **rows}
