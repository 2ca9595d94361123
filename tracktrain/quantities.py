"""Which signals of runs are shown, and in which units."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from orchestrator import Responses, choices, picked

from .car.hopper import layout_of
from .car.layout import Shown
from .errors import TracktrainError
from .scales import Scale

SHOWN_UNITS = {
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "m/s2": ("m/s²", 1.0),
    "rad": ("mrad", 1e3),
    "rad/s": ("mrad/s", 1e3),
    "N": ("kN", 1e-3),
    "N.m": ("kN·m", 1e-3),
    "1": ("1", 1.0),
}
"""Units that values are shown in, and their factors."""

LARGEST = 5e3
"""Of a value as shown, above which it stays in the recorded unit."""

MOST = 12
"""Signals of a system that is no car."""


def shown_quantities(
    runs: Mapping[str, Responses], asked: Sequence[str] = (), only: bool = False
) -> list[Shown]:
    """The car's quantities that any run has, else their first signals; then those asked for.

    runs: by name. asked: names as `picked` reads them, or what the car's quantities are called.
    only: those asked for and no others. Raises TracktrainError for a signal that no run has.
    """
    present = dict.fromkeys(str(name) for data in runs.values() for name in data.data_vars)
    usual = {
        shown.variable: shown
        for data in runs.values()
        for shown in layout_of(data).quantities.values()
        if shown.variable in data
    }
    called = {shown.label: shown for shown in usual.values()}
    found = {} if only else dict(usual)
    typed = [
        name for one in asked for name in signals_meant(one, [*called, *present], ", ".join(runs))
    ]
    for name in typed if found or asked else list(present)[:MOST]:
        shown = called.get(name) or _shown(name, runs)
        found.setdefault(shown.variable, shown)
    return list(found.values())


def _shown(name: str, runs: Mapping[str, Responses]) -> Shown:
    """A signal in a unit that suits its largest value."""
    present_in = [data[name] for data in runs.values() if name in data]
    largest = max(float(np.abs(response.values).max()) for response in present_in)
    unit, factor = shown_unit(str(present_in[0].attrs.get("units", "1")), largest)
    return Shown(name, name, Scale("" if unit == "1" else unit, factor))


def signals_meant(asked: str, names: Collection[str], where: str) -> list[str]:
    """The signals that are meant; raises TracktrainError where none is. where: they were sought."""
    found = picked(asked, names)
    if not found:
        raise TracktrainError(f"there is no signal '{asked}' in {where}; {choices(asked, names)}")
    return found


def shown_unit(unit: str, largest: float) -> tuple[str, float]:
    """The unit that values of a unit are shown in, and its factor; largest: of their sizes."""
    shown, factor = SHOWN_UNITS.get(unit, (unit, 1.0))
    return (unit, 1.0) if factor > 1.0 and largest * factor > LARGEST else (shown, factor)
