"""Unit names as FMI writes them, such as `N.m/rad` or `m/s2`, read with pint."""

from __future__ import annotations

import pint

REGISTRY: pint.UnitRegistry = pint.UnitRegistry()


def parse(unit: str) -> pint.Unit:
    """The unit of an FMI name; `1` is a plain number. Raises what pint raises for no unit."""
    if unit == "1":
        return REGISTRY.Unit("")
    parts = ("*".join(_power(factor) for factor in part.split(".")) for part in unit.split("/"))
    return REGISTRY.Unit("/".join(parts))


def _power(factor: str) -> str:
    stem = factor.rstrip("0123456789")
    return f"{stem}**{factor[len(stem) :]}" if stem and len(stem) < len(factor) else factor
