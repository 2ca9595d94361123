"""Systems as files of the standard SSP (System Structure and Parameterization), 1.0 and 2.0."""

from __future__ import annotations

from .mapping import MapEntry, read_mapping

__all__ = ["MapEntry", "read_mapping"]
