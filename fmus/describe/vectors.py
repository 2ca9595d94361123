"""Signals by name as vectors in the order of a block's variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from .variables import Variable


def flat(constants: Mapping[str, ca.SX]) -> ca.SX:
    """All constants in one column."""
    return ca.vertcat(*[ca.vec(ca.SX(v)) for v in constants.values()]) if constants else ca.SX(0, 1)


def symbols(variables: Sequence[Variable]) -> dict[str, ca.SX]:
    return {v.name: ca.SX.sym(v.name) for v in variables}


def vector(signals: Mapping[str, ca.SX]) -> ca.SX:
    return ca.vertcat(*signals.values()) if signals else ca.SX(0, 1)


def ordered(variables: Sequence[Variable], values: Mapping[str, ca.SX]) -> ca.SX:
    """The expressions in the variables' order; every variable must have one, and no other."""
    names = [v.name for v in variables]
    if set(names) != set(values):
        missing = sorted(set(names) - set(values))
        unknown = sorted(set(values) - set(names))
        raise ValueError(f"expressions missing for {missing}, not declared: {unknown}")
    return ca.densify(ca.vertcat(*[ca.SX(values[n]) for n in names])) if names else ca.SX(0, 1)
