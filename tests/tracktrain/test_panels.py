"""What a panel shows of values."""

from __future__ import annotations

import numpy as np
import pytest

from tracktrain.panels import limits_of


@pytest.mark.parametrize(
    ("values", "limits"),
    [
        ([1.0, 3.0], (1.0, 3.0)),
        ([2.0, 2.0], (0.0, 4.0)),
        ([0.0, 0.0], (-1.0, 1.0)),
        ([-1e-306, 1e-306], (-1.0, 1.0)),
        ([np.nan, np.inf], (-1.0, 1.0)),
    ],
    ids=["apart", "constant", "zero", "too small for numbers", "none"],
)
def test_a_panel_is_never_flat(values, limits):
    assert limits_of(np.array(values)) == limits
