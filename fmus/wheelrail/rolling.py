"""The rotation of the wheelset: the creepage of all contacts that balances their forces, (22)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import reduce
from typing import Any

import casadi as ca

from .creep import Contact, Law

EVALUATIONS = 30
"""Of the law at most. A few are taken; none beyond the first where the guess is right."""

BALANCED = 1e-11
"""Net force, over the friction limit of both wheels, that counts as none."""

SLIDING = 0.1
"""Creepage by which driven or braked wheels may spin or slide."""

Rotation = Callable[[Law, Any, int], ca.Function]
"""From a law, the kind of its symbols and a number of contacts to (contacts, grips, wanted) ->
common creepage."""

FIELDS = len(fields(Contact))


def _symbols(kind: Any, count: int) -> list[Any]:
    """The contacts with nothing in common yet; factors on their forces; the force wanted [N]."""
    shapes = {"contacts": (FIELDS, count), "grips": (count, 1), "wanted": (1, 1)}
    return [kind.sym(name, *shape) for name, shape in shapes.items()]


def _contacts(columns: Any) -> list[Contact]:
    return [Contact(*ca.vertsplit(columns[:, i])) for i in range(columns.size2())]


def in_proportion(contacts: Any, grips: Any, wanted: Any) -> Any:
    """The common creepage in closed form where forces are f11 times the creepage."""
    wheels = _contacts(contacts)
    weights = [grips[i] * wheel.f11 * wheel.leverage for i, wheel in enumerate(wheels)]
    balance = sum(weight * w.creep_x for weight, w in zip(weights, wheels, strict=True))
    total = sum(weight * w.leverage for weight, w in zip(weights, wheels, strict=True))
    return -(balance + wanted) / ca.fmax(total, 1e-9)


def common_creepage(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(contacts, grips, wanted) -> the creepage that all contacts have in common.

    Between the creepages at which each contact alone rolls freely, by false position with halving
    (Illinois; Dowell and Jarratt, BIT 11, 1971). Not to be differentiated: see `differentiable`.
    """
    net = net_force(law, kind, count)
    contacts, grips, wanted = _symbols(ca.MX, count)
    wheels = _contacts(contacts)
    creeps = [wheel.creep_x / wheel.leverage for wheel in wheels]
    guess = in_proportion(contacts, grips, ca.MX(0))
    limit = sum(grips[i] * w.leverage * w.friction * w.load for i, w in enumerate(wheels))
    reach = SLIDING * (wanted != 0)
    ends = ca.vertcat(-reduce(ca.fmax, creeps) - reach, -reduce(ca.fmin, creeps) + reach)
    forces = ca.vertcat(limit - wanted, -limit - wanted)
    at_guess = net(guess, contacts, grips) - wanted
    state = ca.vertcat(ends, forces, guess, at_guess, 0)
    narrowed = _narrowed(net, count)
    for _ in range(EVALUATIONS):
        state = narrowed(state, contacts, grips, wanted, limit)
    return ca.Function(
        "common_creepage",
        [contacts, grips, wanted],
        [state[4]],
        {"is_diff_in": [False] * 3, "is_diff_out": [False]},
    )


def differentiable(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """The same with its derivatives.

    One Newton step from a creepage that is taken for a constant: by the theorem of implicit
    functions its derivatives are those of the root.
    """
    return _improved(law, kind, common_creepage(law, kind, count), count)


def at_rest(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(contacts, grips, wanted) -> the common creepage near straight running with equal loads."""
    return _improved(law, kind, ca.Function("none", _symbols(ca.MX, count), [ca.MX(0)]), count)


def _improved(law: Law, kind: Any, guess: ca.Function, count: int) -> ca.Function:
    """A guess with a Newton step after it."""
    net = net_force(law, kind, count)
    slope = net.factory("slope", net.name_in(), [f"jac:{net.name_out(0)}:{net.name_in(0)}"])
    contacts, grips, wanted = symbols = _symbols(ca.MX, count)
    root = guess(*symbols)
    falling = ca.fmin(slope(root, contacts, grips), -1e-9)
    better = root - (net(root, contacts, grips) - wanted) / falling
    return ca.Function("improved", symbols, [better])


def net_force(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(common creepage, contacts, grips) -> sum of the longitudinal forces [N], at the nominal
    radius."""
    common = kind.sym("common")
    contacts, grips, _ = _symbols(kind, count)
    wheels = [wheel.rolling(common) for wheel in _contacts(contacts)]
    total = sum(grips[i] * wheel.leverage * law(wheel)[0] for i, wheel in enumerate(wheels))
    return ca.Function("net_force", [common, contacts, grips], [total], {"never_inline": True})


def _narrowed(net: ca.Function, count: int) -> ca.Function:
    """(state, contacts, grips, wanted, limit) -> state after one more evaluation, if it is needed.

    state: low and high end of the bracket, the excess of force there, the last guess and its
    excess, and which end moved last. The excess falls with the creepage.
    """
    state = ca.MX.sym("state", 7)
    contacts, grips, wanted = _symbols(ca.MX, count)
    limit = ca.MX.sym("limit")
    low, high, at_low, at_high, guess, at_guess, moved = ca.vertsplit(state)
    above = at_guess > 0
    # An end that stays for a second time counts half, lest it stays for good.
    at_low = ca.if_else(above, at_guess, ca.if_else(moved < 0, at_low / 2, at_low))
    at_high = ca.if_else(above, ca.if_else(moved > 0, at_high / 2, at_high), at_guess)
    low, high = ca.if_else(above, guess, low), ca.if_else(above, high, guess)
    nearer = low + (high - low) * at_low / ca.fmax(at_low - at_high, 1e-30)
    excess = net(nearer, contacts, grips) - wanted
    found = ca.vertcat(low, high, at_low, at_high, nearer, excess, ca.if_else(above, 1, -1))
    arguments = [state, contacts, grips, wanted, limit]
    better, same = (
        ca.Function(name, arguments, [end]) for name, end in (("better", found), ("same", state))
    )
    choose = ca.Function.if_else("better_or_same", better, same)
    needed = ca.fabs(at_guess) > BALANCED * limit
    return ca.Function("narrowed", arguments, [choose(needed, *arguments)], {"never_inline": True})
