"""The rotation of the wheelset: the creepage of all contacts that balances their forces, (22)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import reduce
from typing import Any

import casadi as ca

from .creep import Contact, Law
from .creep.contact import TINY

EVALUATIONS = 30
"""Of the law at most. Two are taken as a rule, the forces apart."""

BALANCED = 1e-9
"""Product of the last two steps of a secant, each over the creepage by which the linear theory
reaches the friction limit,
at which the next creepage is taken unseen: about a hundredth of it is left."""

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
    return _free(wheels, [grips[i] * wheel.f11 for i, wheel in enumerate(wheels)], wanted)


def _free(wheels: list[Contact], stiffnesses: Any, wanted: Any) -> Any:
    """The common creepage of contacts of these longitudinal stiffnesses [N]."""
    forces = [stiffnesses[i] * w.leverage * w.creep_x for i, w in enumerate(wheels)]
    return -(sum(forces) + wanted) / _stiffness(wheels, stiffnesses)


def _stiffness(wheels: list[Contact], stiffnesses: Any) -> Any:
    """Of all contacts against a common creepage [N]."""
    return ca.fmax(sum(stiffnesses[i] * w.leverage**2 for i, w in enumerate(wheels)), 1e-9)


def common_creepage(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(contacts, grips, wanted) -> the creepage that all contacts have in common.

    Between the creepages at which each contact alone rolls freely. The first guess is Kalker's,
    the second takes each contact for as stiff as it was found there; then by secants, with halving
    where they do not help. Not to be differentiated: see `differentiable`.
    """
    net = net_force(law, kind, count)
    contacts, grips, wanted = _symbols(ca.MX, count)
    wheels = _contacts(contacts)
    creeps = [wheel.creep_x / wheel.leverage for wheel in wheels]
    limit = sum(grips[i] * w.leverage * w.friction * w.load for i, w in enumerate(wheels))
    reach = SLIDING * (wanted != 0)
    low, high = -reduce(ca.fmax, creeps) - reach, -reduce(ca.fmin, creeps) + reach
    guess = in_proportion(contacts, grips, ca.MX(0))
    force, stiffnesses = net(guess, contacts, grips)
    excess = force - wanted
    nearer = ca.fmin(ca.fmax(_free(wheels, stiffnesses, wanted), low), high)
    scale = limit / _stiffness(wheels, [grips[i] * wheel.f11 for i, wheel in enumerate(wheels)])
    state = ca.vertcat(low, high, guess, excess, nearer, scale * (nearer - guess))
    narrowed = _narrowed(net, count)
    for _ in range(EVALUATIONS - 1):
        state = narrowed(state, contacts, grips, wanted, scale)
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
    better = root - (net(root, contacts, grips)[0] - wanted) / falling
    return ca.Function("improved", symbols, [better])


def net_force(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(common creepage, contacts, grips) -> sum of the longitudinal forces [N], at the nominal
    radius; and each one's force per creepage [N]."""
    common = kind.sym("common")
    contacts, grips, _ = _symbols(kind, count)
    wheels = [wheel.rolling(common) for wheel in _contacts(contacts)]
    forces = [grips[i] * law(wheel)[0] for i, wheel in enumerate(wheels)]
    total = sum(wheel.leverage * force for wheel, force in zip(wheels, forces, strict=True))
    # without creepage as stiff as Kalker has it
    stiffnesses = [
        (TINY**2 * grips[i] * w.f11 - forces[i] * w.creep_x) / (TINY**2 + w.creep_x**2)
        for i, w in enumerate(wheels)
    ]
    found = [total, ca.vertcat(*stiffnesses)]
    return ca.Function("net_force", [common, contacts, grips], found, {"never_inline": True})


def _narrowed(net: ca.Function, count: int) -> ca.Function:
    """(state, contacts, grips, wanted, scale) -> state after one more evaluation, if it is needed.

    state: low and high end of the bracket, the creepage evaluated last and its excess of force,
    the creepage to take next, and the product of its distances from the last two. The excess
    falls with the creepage.
    """
    state = ca.MX.sym("state", 6)
    contacts, grips, wanted = _symbols(ca.MX, count)
    scale = ca.MX.sym("scale")
    low, high, last, at_last, guess, product = ca.vertsplit(state)
    excess = net(guess, contacts, grips)[0] - wanted
    low, high = ca.if_else(excess > 0, guess, low), ca.if_else(excess > 0, high, guess)
    fall = at_last - excess
    secant = guess + excess * (guess - last) / ca.if_else(fall == 0, 1, fall)
    helps = ca.logic_and(
        2 * ca.fabs(excess) <= ca.fabs(at_last), (secant - low) * (high - secant) >= 0
    )
    nearer = ca.if_else(helps, secant, (low + high) / 2)
    product = ca.if_else(helps, (secant - guess) * (secant - last), scale**2)
    found = ca.vertcat(low, high, guess, excess, nearer, product)
    arguments = [state, contacts, grips, wanted, scale]
    better, same = (
        ca.Function(name, arguments, [end]) for name, end in (("better", found), ("same", state))
    )
    choose = ca.Function.if_else("better_or_same", better, same)
    needed = ca.fabs(state[5]) > BALANCED * scale**2
    return ca.Function("narrowed", arguments, [choose(needed, *arguments)], {"never_inline": True})
