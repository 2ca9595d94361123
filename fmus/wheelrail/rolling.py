"""The rotation of the wheelset: the creepage of both wheels at which their forces balance, (22)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import casadi as ca

from .creep import Contact, Law

EVALUATIONS = 30
"""Of the law at most. A few are taken; none beyond the first where the guess is right."""

BALANCED = 1e-11
"""Net force, over the friction limit of both wheels, that counts as none."""

SLIDING = 0.1
"""Creepage by which driven or braked wheels may spin or slide."""

Rotation = Callable[[Law, Any], ca.Function]
"""From a law and the kind of its symbols to (contacts, grips, wanted) -> common creepage."""

FIELDS = len(fields(Contact))
SYMBOLS = {"contacts": (FIELDS, 2), "grips": (2, 1), "wanted": (1, 1)}
"""Both contacts with nothing in common yet; factors on their forces; the net force wanted [N]."""


def common_creepage(law: Law, kind: Any) -> ca.Function:
    """(contacts, grips, wanted) -> the creepage that both wheels have in common.

    Between the creepages at which either wheel alone rolls freely, by false position with halving
    (Illinois; Dowell and Jarratt, BIT 11, 1971). Not to be differentiated: see `differentiable`.
    """
    net = net_force(law, kind)
    contacts, grips, wanted = (ca.MX.sym(name, *shape) for name, shape in SYMBOLS.items())
    rows: list[Any] = [ca.vertsplit(contacts[:, i]) for i in range(2)]
    wheels: list[Any] = [Contact(*row) for row in rows]
    creeps = [wheel.creep_x for wheel in wheels]
    weights = [grips[i] * wheels[i].f11 for i in range(2)]
    balance = sum(weight * creep for weight, creep in zip(weights, creeps, strict=True))
    guess = -balance / ca.fmax(sum(weights), 1e-9)
    limit = sum(grips[i] * wheels[i].friction * wheels[i].load for i in range(2))
    reach = SLIDING * (wanted != 0)
    ends = ca.vertcat(-ca.fmax(*creeps) - reach, -ca.fmin(*creeps) + reach)
    forces = ca.vertcat(limit - wanted, -limit - wanted)
    at_guess = net(guess, contacts, grips) - wanted
    state = ca.vertcat(ends, forces, guess, at_guess, 0)
    narrowed = _narrowed(net)
    for _ in range(EVALUATIONS):
        state = narrowed(state, contacts, grips, wanted, limit)
    return ca.Function(
        "common_creepage",
        [contacts, grips, wanted],
        [state[4]],
        {"is_diff_in": [False] * 3, "is_diff_out": [False]},
    )


def differentiable(law: Law, kind: Any) -> ca.Function:
    """The same with its derivatives.

    One Newton step from a creepage that is taken for a constant: by the theorem of implicit
    functions its derivatives are those of the root.
    """
    return _improved(law, kind, common_creepage(law, kind))


def at_rest(law: Law, kind: Any) -> ca.Function:
    """(contacts, grips, wanted) -> the common creepage near straight running with equal loads."""
    symbols = [ca.MX.sym(name, *shape) for name, shape in SYMBOLS.items()]
    return _improved(law, kind, ca.Function("none", symbols, [ca.MX(0)]))


def _improved(law: Law, kind: Any, guess: ca.Function) -> ca.Function:
    """A guess with a Newton step after it."""
    net = net_force(law, kind)
    slope = net.factory("slope", net.name_in(), [f"jac:{net.name_out(0)}:{net.name_in(0)}"])
    contacts, grips, wanted = symbols = [ca.MX.sym(n, *shape) for n, shape in SYMBOLS.items()]
    root = guess(*symbols)
    falling = ca.fmin(slope(root, contacts, grips), -1e-9)
    better = root - (net(root, contacts, grips) - wanted) / falling
    return ca.Function("improved", symbols, [better])


def net_force(law: Law, kind: Any) -> ca.Function:
    """(common creepage, contacts, grips) -> sum of the longitudinal forces [N]."""
    common = kind.sym("common")
    contacts, grips = (kind.sym(name, *SYMBOLS[name]) for name in ("contacts", "grips"))
    wheels = (Contact(*ca.vertsplit(contacts[:, i])).rolling(common) for i in range(2))
    total = sum(grips[i] * law(wheel)[0] for i, wheel in enumerate(wheels))
    return ca.Function("net_force", [common, contacts, grips], [total], {"never_inline": True})


def _narrowed(net: ca.Function) -> ca.Function:
    """(state, contacts, grips, wanted, limit) -> state after one more evaluation, if it is needed.

    state: low and high end of the bracket, the excess of force there, the last guess and its
    excess, and which end moved last. The excess falls with the creepage.
    """
    state = ca.MX.sym("state", 7)
    contacts, grips, wanted = (ca.MX.sym(name, *shape) for name, shape in SYMBOLS.items())
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
