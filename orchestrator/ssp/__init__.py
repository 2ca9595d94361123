"""Systems as files of the standard SSP (System Structure and Parameterization), 1.0 and 2.0."""

from __future__ import annotations

from .mapping import MapEntry, read_mapping
from .reader import read_ssp
from .writer import write_ssp

__all__ = ["MapEntry", "read_mapping", "read_ssp", "write_ssp"]
