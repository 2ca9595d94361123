"""The rows of an assessment in the order in which they matter, and what they come to in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

Row = Mapping[str, Any]

COUNTED, COMPARED, UNLIMITED = "limits for this run", "for comparison", "without a limit"
"""Groups of rows: what counts, rules for other vehicles, track or speeds, and mere numbers."""

MOST = 3
"""Quantities that the words name."""


def grouped(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """The rows that have a value, by group, what is used most first; no group that is empty."""
    groups: dict[str, list[Row]] = {COUNTED: [], COMPARED: [], UNLIMITED: []}
    for row in rows:
        if row["share"] == row["share"]:
            groups[COUNTED if row["applies"] else COMPARED].append(row)
        elif row["value"] == row["value"]:
            groups[UNLIMITED].append(row)
    for name in (COUNTED, COMPARED):
        groups[name].sort(key=lambda row: -row["share"])
    return {name: found for name, found in groups.items() if found}


def left_out(rows: Iterable[Row]) -> dict[str, list[str]]:
    """Why rows have no value, and of what quantities."""
    reasons: dict[str, list[str]] = {}
    for row in rows:
        if row["value"] != row["value"]:
            reasons.setdefault(str(row["result"]), []).append(str(row["quantity"]))
    return reasons


def summed_up(rows: Iterable[Row]) -> str:
    """How many limits are exceeded, by what; empty where nothing was judged."""
    groups = grouped(rows)
    sentences = []
    if counted := groups.get(COUNTED):
        sentences.append(f"{_said(counted)}.")
    if compared := groups.get(COMPARED):
        sentences.append(f"For comparison: {_said(compared)}.")
    return " ".join(sentences)


def _said(rows: list[Row]) -> str:
    over = [row for row in rows if row["share"] > 1.0]
    named = [
        f"{row['quantity']} ({row['share']:.0%})" for row in (over or rows)[: MOST if over else 1]
    ]
    if not over:
        return f"all {len(rows)} kept, most used {named[0]}"
    more = f" and {len(over) - MOST} more" if len(over) > MOST else ""
    return f"{len(over)} of {len(rows)} exceeded: {', '.join(named)}{more}"
