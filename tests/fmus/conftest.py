"""Values of the blocks' parameters, and instances of their Python twins."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from fmus import BLOCKS
from fmus.describe.block import Block
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin


@cache
def _block(name: str) -> Block:
    """A block, whose functions are built once for all tests."""
    return BLOCKS[name]()


@pytest.fixture
def values_of():
    """Parameter values [SI] of a block, by its name and a parameter set's."""
    return lambda block, name="loaded": parameter_set(name).values(_block(block))


@pytest.fixture
def twin_of(values_of):
    """An initialised twin of a block with changed parameters and inputs."""

    def make(block: str, inputs=None, **changes) -> Twin:
        twin = Twin(_block(block), values_of(block) | changes, inputs)
        twin.initialize()
        return twin

    return make


@pytest.fixture
def rng():
    return np.random.default_rng(1980)
