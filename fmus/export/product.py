"""What an FMU is made of besides code: a block, its numbers, its known results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .. import BLOCKS
from ..describe.block import Block
from ..describe.experiment import Reference
from ..describe.parameters import DEFAULT_SET, ParameterSet, parameter_set
from ..reference import EXPERIMENTS


@dataclass(frozen=True)
class Product:
    """A block with the numbers that its FMU starts with. further: files by place in the archive."""

    block: Block
    parameters: ParameterSet
    reference: Reference
    further: Mapping[str, bytes] = field(default_factory=dict)


def shipped(name: str) -> Product:
    """A block of `BLOCKS` with the default parameter set."""
    return Product(BLOCKS[name](), parameter_set(DEFAULT_SET), EXPERIMENTS[name].reference)
