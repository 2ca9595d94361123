"""The rotation of the wheelset: the creepage of all contacts that balances their forces, (22)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import cache, reduce
from typing import Any

import casadi as ca

from .creep import SHARES, Contact, Law
from .creep.contact import TINY

STATE, GUESS, LEFT = 6, 4, 5
"""Values of the search's state, and places of the creepage to take next and of what it leaves."""

SELDOM = 27
"""Evaluations of the law after the third. Two are taken as a rule, the forces apart."""

BALANCED = 1e-7
"""Product of the last two steps of a secant, each over the creepage by which the linear theory
reaches the friction limit, at which the next creepage is taken unseen: about a hundredth of it is
left."""

LEAST = 0.02
"""Share of its secant's that a contact's stiffness is taken for at least."""

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


def contacts_of(columns: Any) -> list[Contact]:
    """The contacts of the columns that a rotation takes."""
    return [Contact(*ca.vertsplit(columns[:, i])) for i in range(columns.size2())]


def in_proportion(contacts: Any, grips: Any, wanted: Any) -> Any:
    """The common creepage in closed form where forces are f11 times the creepage."""
    wheels = contacts_of(contacts)
    return _free(wheels, [grips[i] * wheel.f11 for i, wheel in enumerate(wheels)], wanted)


def _free(wheels: list[Contact], stiffnesses: Any, wanted: Any) -> Any:
    """The common creepage of contacts of these longitudinal stiffnesses [N]."""
    forces = [stiffnesses[i] * w.leverage * w.creep_x for i, w in enumerate(wheels)]
    return -(sum(forces) + wanted) / _stiffness(wheels, stiffnesses)


def _stiffness(wheels: list[Contact], stiffnesses: Any) -> Any:
    """Of all contacts against a common creepage [N]."""
    return ca.fmax(sum(stiffnesses[i] * w.leverage**2 for i, w in enumerate(wheels)), 1e-9)


@cache
def common_creepage(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(contacts, grips, wanted) -> the creepage that all contacts have in common.

    Between the creepages at which each contact alone rolls freely. The first guess takes each
    contact for as stiff as its law is halfway, where that is known, else for as stiff as Kalker has
    it; the second for as stiff as its force tells. Then by secants, with halving where they do not
    help. Not to be differentiated: see `differentiable`.
    """
    begun, nearer = _begun(law, kind, count), _nearer(law, kind, count)
    once, arguments = _unless_found("once", nearer), _arguments(nearer)
    rest = arguments[0]
    for _ in range(SELDOM):
        rest = once(rest, *arguments[1:])
    often = _unless_found("often", ca.Function("rest", arguments, [rest]))
    third = ca.Function("third", arguments, [often(nearer(*arguments), *arguments[1:])])
    symbols = _symbols(ca.MX, count)
    found = _unless_found("found", third, GUESS)(*begun(*symbols), *symbols)
    return ca.Function(
        "common_creepage",
        symbols,
        [found],
        {"is_diff_in": [False] * 3, "is_diff_out": [False]},
    )


@cache
def differentiable(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """The same with its derivatives.

    One Newton step from a creepage that is taken for a constant: by the theorem of implicit
    functions its derivatives are those of the root.
    """
    return _improved(law, kind, common_creepage(law, kind, count), count)


@cache
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


@cache
def net_force(law: Law, kind: Any, count: int = 2) -> ca.Function:
    """(common creepage, contacts, grips) -> sum of the longitudinal forces [N], at the nominal
    radius."""
    common = kind.sym("common")
    contacts, grips, _ = _symbols(kind, count)
    total, _ = _pull(law, contacts_of(contacts), grips, common)
    return ca.Function("net_force", [common, contacts, grips], [total], {"never_inline": True})


def _pull(law: Law, wheels: list[Contact], grips: Any, common: Any) -> tuple[Any, Any]:
    """Sum of the longitudinal forces, at the nominal radius, and about how fast it falls [N]."""
    rolling = [wheel.rolling(common) for wheel in wheels]
    forces = [grips[i] * law(wheel)[0] for i, wheel in enumerate(rolling)]
    stiffnesses = [_stiff(w, grips[i], forces[i]) for i, w in enumerate(rolling)]
    pull = sum(w.leverage * force for w, force in zip(wheels, forces, strict=True))
    return pull, _stiffness(wheels, stiffnesses)


def _stiff(contact: Contact, grip: Any, force: Any) -> Any:
    """About how fast the force on a contact falls with its creepage [N].

    As a share 1/sqrt(1 + demand^2) of the linear force does; without creepage as Kalker has it.
    """
    c = contact
    secant = (TINY**2 * grip * c.f11 - force * c.creep_x) / (TINY**2 + c.creep_x**2)
    return secant * ca.fmax(1 - (force / (c.friction * c.load)) ** 2, LEAST)


def _begun(law: Law, kind: Any, count: int) -> ca.Function:
    """(contacts, grips, wanted) -> the search's state after two evaluations, and its scale:
    the creepage by which the linear theory reaches the friction limit.

    state: low and high end of the bracket, the creepage evaluated last and its excess of force,
    the creepage to take next, and the product of its distances from the last two.
    """
    contacts, grips, wanted = symbols = _symbols(kind, count)
    wheels = contacts_of(contacts)
    creeps = [wheel.creep_x / wheel.leverage for wheel in wheels]
    limit = sum(grips[i] * w.leverage * w.friction * w.load for i, w in enumerate(wheels))
    linear = [grips[i] * wheel.f11 for i, wheel in enumerate(wheels)]
    scale = limit / _stiffness(wheels, linear)
    reach = SLIDING * (wanted != 0)
    low, high = -reduce(ca.fmax, creeps) - reach, -reduce(ca.fmin, creeps) + reach
    middle = (low + high) / 2
    shares = [SHARES[law](wheel.rolling(middle)) if law in SHARES else 1 for wheel in wheels]
    guess = _free(wheels, [linear[i] * share for i, share in enumerate(shares)], kind(0))
    force, fall = _pull(law, wheels, grips, guess)
    nearer = ca.fmin(ca.fmax(guess + (force - wanted) / fall, low), high)
    state = ca.vertcat(low, high, guess, force - wanted, nearer, 0)
    found = _bracketed(law, state, scale, wheels, grips, wanted)
    return ca.Function("begun", symbols, [found, scale], {"never_inline": True})


def _nearer(law: Law, kind: Any, count: int) -> ca.Function:
    """(state, scale, contacts, grips, wanted) -> state after one more evaluation."""
    state, scale = kind.sym("state", STATE), kind.sym("scale")
    contacts, grips, wanted = symbols = _symbols(kind, count)
    found = _bracketed(law, state, scale, contacts_of(contacts), grips, wanted)
    return ca.Function("nearer", [state, scale, *symbols], [found], {"never_inline": True})


def _bracketed(
    law: Law, state: Any, scale: Any, wheels: list[Contact], grips: Any, wanted: Any
) -> Any:
    """The state after one more evaluation. The excess of force falls with the creepage."""
    low, high, last, at_last, guess, _ = ca.vertsplit(state)
    excess = _pull(law, wheels, grips, guess)[0] - wanted
    low, high = ca.if_else(excess > 0, guess, low), ca.if_else(excess > 0, high, guess)
    fall = at_last - excess
    secant = guess + excess * (guess - last) / ca.if_else(fall == 0, 1, fall)
    helps = ca.logic_and(
        2 * ca.fabs(excess) <= ca.fabs(at_last), (secant - low) * (high - secant) >= 0
    )
    nearer = ca.if_else(helps, secant, (low + high) / 2)
    product = ca.if_else(helps, (secant - guess) * (secant - last), scale**2)
    return ca.vertcat(low, high, guess, excess, nearer, product)


def _unless_found(name: str, improved: ca.Function, part: Any = slice(None)) -> ca.Function:
    """A function of the state, while what the search would leave is not small; else the state.
    part: of the state that is given."""
    state, scale, *_ = arguments = _arguments(improved)
    same = ca.Function("same", arguments, [state[part]])
    other = ca.Function("other", arguments, [improved(*arguments)[part]])
    choose = ca.Function.if_else("better_or_same", other, same)
    needed = ca.fabs(state[LEFT]) > BALANCED * scale**2
    return ca.Function(name, arguments, [choose(needed, *arguments)], {"never_inline": True})


def _arguments(function: ca.Function) -> list[ca.MX]:
    """Symbols for those of a function."""
    return [ca.MX.sym(function.name_in(i), *function.size_in(i)) for i in range(function.n_in())]
