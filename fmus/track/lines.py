"""The waves that a track's irregularities are the sum of."""

from __future__ import annotations

import numpy as np

from ..describe.variables import Values
from .block import Track
from .irregularity import LINE_ROWS, LINES
from .spectra import CHANNELS


def lines(values: Values) -> dict[str, np.ndarray]:
    """Frequency [cycle/m], phase [turn], amplitude [m] of each channel's lines, (3, 300).

    values: all parameter values of the block [SI].
    """
    derived = np.array(derived_values(values)[: len(LINE_ROWS) * LINES * len(CHANNELS)])
    table = derived.reshape(len(CHANNELS), LINES, len(LINE_ROWS))
    return {channel: table[i, :, :3].T for i, channel in enumerate(CHANNELS)}


def derived_values(values: Values) -> np.ndarray:
    block = Track()
    return np.array(block.derived_function()(block.parameter_vector(values))).ravel()
