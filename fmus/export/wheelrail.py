"""The FMU of a wheelset on profiles."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path

from ..describe.parameters import DEFAULT_SET, parameter_set
from ..names import identifier
from ..wheelrail.contact_table import IN_FMU, ContactTable, as_text
from ..wheelrail.profiled import ProfiledWheelRail
from ..wheelrail.profiled_experiment import reference
from .product import Product
from .single import build_single, kept


def build_wheelrail(
    table: ContactTable, out: Path, fmi: str = "2.0", platforms: Iterable[str] = ("host",)
) -> Path:
    """Write the FMU of a wheelset on the table to the file `out`, and return its path.

    The table travels in it. platforms: names of compiler.TARGETS, `host` or `all`. Raises
    CompileError, or OSError for a place that cannot be written.
    """
    product = wheelrail_product(table, identifier(out.stem, "wheelrail"))
    return build_single(product, out, fmi, platforms)


def wheelrail_fmu(table: ContactTable) -> Path:
    """The FMU of the table for FMI 2.0 and this machine, built once and kept in the cache."""
    name, text = table.name, as_text(table)
    return kept("wheelsets", "wheelrail", name, text, partial(build_wheelrail, table))


def wheelrail_product(table: ContactTable, name: str) -> Product:
    """A block of this name with the numbers, the known results and the file of the table."""
    parameters = parameter_set(DEFAULT_SET)
    poisson = parameters.entry("poisson_ratio", ProfiledWheelRail.stands_for)
    assert poisson is not None
    block = ProfiledWheelRail(table, poisson.to("1"), name)
    known = reference(block, parameters.values(block))
    return Product(block, parameters, known, {IN_FMU: as_text(table).encode()})
