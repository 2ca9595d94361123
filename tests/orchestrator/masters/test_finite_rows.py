"""When a row of the record ends a run."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrator.masters.loop.record import record_of
from orchestrator.masters.loop.refresh import all_finite


@pytest.mark.parametrize(
    ("row", "finite"),
    [
        ([1.0, -2.0], True),
        ([1e308, 1e308], True),  # their sum is not
        ([1.0, np.nan], False),
        ([np.inf, 0.0], False),
        ([np.inf, -np.inf], False),
    ],
)
def test_a_row_is_finite_where_each_of_its_numbers_is(row: list[float], finite: bool) -> None:
    record = record_of(np.array([row]), np.zeros((0, 0)))
    with np.errstate(all="ignore"):
        assert bool(all_finite(record, 0)) is finite
