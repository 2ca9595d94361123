"""What FMUs calculate of their parameters, to be written beside a run's results."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import isfinite

from ..errors import SlaveError
from ..slaves.base import Slave


def constants(slaves: Sequence[Slave]) -> dict[str, float]:
    """Calculated parameters [their units] at the start, by "instance.variable".

    Without those of an FMU that does not let them be read, and such as are no number.
    """
    found: dict[str, float] = {}
    for slave in slaves:
        wanted = [
            v
            for v in slave.description.variables.values()
            if v.causality == "calculatedParameter" and v.kind == "real" and v.coupled
        ]
        if wanted:
            with suppress(SlaveError), slave.watched():
                values = zip(wanted, slave.get_reals(wanted).tolist(), strict=True)
                found |= {f"{slave.name}.{v.name}": x for v, x in values if isfinite(x)}
    return found
