"""Assessment of a run of the car against the limits of the field, each with its source.

table = assess(run.dataset)
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestrator import Responses, Run

from ..results import responses_of
from .car import Car
from .curving import LIMITS, MEASURES
from .rules import ForeignError, NotApplicableError, Rule, from_si, rules

if TYPE_CHECKING:
    import pandas as pd

PASSED, EXCEEDED, NO_LIMIT = "passed", "exceeded", "no limit"
NOT_EXCITED = "not excited"
COLUMNS = (
    *("quantity", "place", "value", "limit", "at_least", "share", "result", "applies", "scope"),
    *("unit", "statistic", "filter", "window", "formula", "source", "verified", "quote"),
)
NOTHING = {"place": "", "value": float("nan"), "limit": float("nan"), "share": float("nan")}


def assess(run: Responses | Run | Path | str) -> pd.DataFrame:
    """What each rule of limits.toml says about a run, indexed by quantity.

    Rules about what the run's system does not have are left out: all of them, where it is no car.

    run: it, its dataset, or the folder that it wrote.
    Columns: place (of the worst value), value, limit, at_least (whether that is the least value and
    not the largest), unit, share (of the limit; of wheel loads
    that of the admissible unloading), result (passed, exceeded, no limit, not excited where nothing
    moved of what the rule looks at, or not applicable and why), applies (whether the run is what
    the rule is for; else it is shown for comparison), scope, statistic, filter, window, formula,
    source, verified (whether the limit was read there), quote.
    """
    return tabled(judged(run))


def tabled(rows: list[dict[str, Any]]) -> pd.DataFrame:
    """Rows of `judged` as the table of `assess`."""
    import pandas as pd

    return pd.DataFrame(rows, columns=COLUMNS).set_index("quantity")


def judged(run: Responses | Run | Path | str) -> list[dict[str, Any]]:
    """The rows of `assess`, each by its columns."""
    try:
        car: Car | NotApplicableError = Car(responses_of(run))
    except NotApplicableError as reason:
        car = reason
    return [row for rule in rules() if (row := _row(car, rule)) is not None]


def _row(car: Car | NotApplicableError, rule: Rule) -> dict[str, Any] | None:
    """None where the system has nothing that the rule is about."""
    try:
        found = _found(car, rule)
    except ForeignError:
        return None
    except NotApplicableError as reason:
        found = {**NOTHING, "result": f"not applicable: {reason}"}
    return {
        "quantity": rule.quantity,
        **found,
        "at_least": rule.at_least,
        "applies": not isinstance(car, NotApplicableError) and rule.scope.includes(car.speed),
        "scope": rule.scope.text,
        "unit": rule.shown_unit,
        "statistic": rule.statistic,
        "filter": str(rule.band or ""),
        "window": str(rule.window or ""),
        "formula": _formula(car, rule),
        "source": rule.source,
        "verified": rule.verified,
        "quote": rule.quote,
    }


def _formula(car: Car | NotApplicableError, rule: Rule) -> str:
    """How the limit is found; of Nadal's with the numbers of the run's wheels."""
    if rule.key != "wheel_l_over_v" or isinstance(car, NotApplicableError):
        return rule.formula
    return f"{rule.formula}, {car.nadal.given}"


def _found(car: Car | NotApplicableError, rule: Rule) -> dict[str, object]:
    if isinstance(car, NotApplicableError):
        raise car
    if rule.inapplicable:
        raise NotApplicableError(rule.inapplicable)
    worst = min if rule.at_least else max
    car.excited()
    place, value = worst(MEASURES[rule.key](car, rule), key=lambda found: found[1])
    if not car.excited():
        return {**NOTHING, "result": NOT_EXCITED}
    value = from_si(float(value), rule.unit)
    if not rule.judged:
        return {**NOTHING, "place": place, "value": value, "result": NO_LIMIT}
    limit = from_si(LIMITS[rule.key](car), rule.unit) if rule.limit is None else rule.limit
    share = (1 - value) / (1 - limit) if rule.at_least else value / limit
    result = PASSED if share <= 1.0 else EXCEEDED
    return {"place": place, "value": value, "limit": limit, "share": share, "result": result}
