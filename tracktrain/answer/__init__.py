"""What a run's answer is worth, in parts: its coupling, the answer itself, its range, its numbers.

for part in parts(run.dataset, run.verdict):
    print(part)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from orchestrator import (
    Level,
    Provenance,
    Responses,
    Settling,
    State,
    Verdict,
    from_time,
    settling,
)

from ..car.hopper import layout_of
from ..car.validity import Departure, Range, range_of
from ..events import DERAILMENT, Event, Nadal, events, nadal_rule
from ..quantities import MOST
from ..results import speeds
from ..typed import typed
from .derailed import helps
from .numbers import of_numbers
from .standing import Standing, speed_text, standing

LONG = 600.0
"""The longest run that is asked for, however slowly a mode grows [s]."""

UNKNOWN = "The linear car of this run is not known"

MIXED = (
    "The line goes through curves, so that statistics of the whole mix them with straight track; "
    "`tracktrain assess` has numbers of each curve."
)

ORDER = [Level.BAD, Level.DOUBTFUL, Level.UNKNOWN, Level.GOOD]


@dataclass(frozen=True)
class Part:
    """One part of a verdict: what it is about, its level, and a sentence or two."""

    name: str
    level: Level
    text: str

    def __str__(self) -> str:
        return f"{self.name.capitalize()}: {self.level.value}. {self.text}"


def parts(
    dataset: Responses, verdict: Verdict | None = None, whole: Responses | None = None
) -> list[Part]:
    """The verdict on a run in parts, the worst first; the coupling's where it is given.

    whole: the run with the rows that its statistics leave out.
    """
    whole = dataset if whole is None else whole
    known, found = range_of(whole), [_answer(dataset)]
    if verdict is not None:
        found.insert(0, Part("coupling", verdict.level, verdict.told(typed)))
    if known.looked_at or _is_car(dataset):
        # A run that began outside is not mended by what is said of its coupling.
        began = any(d.row == 0 and not d.at_edge for d in known.departures)
        unsure = verdict is not None and verdict.level is Level.BAD and not began
        found.insert(0 if began else 1, _range(whole, known, events(whole), unsure))
    if _is_car(dataset):
        found.append(Part("numbers", *of_numbers(dataset)))
    return sorted(found, key=lambda part: ORDER.index(part.level))


def outside(dataset: Responses, happened: list[Event]) -> Part | None:
    """What a run left of what its FMUs hold for; None for one that stayed inside or says nothing.

    happened: its events.
    """
    found = _range(dataset, range_of(dataset), happened, False)
    return found if found.level in (Level.BAD, Level.DOUBTFUL) else None


def moving(dataset: Responses) -> dict[str, Settling]:
    """How what is printed of a run settles, by its label; of another system its first outputs."""
    shown = [s for s in layout_of(dataset).quantities.values() if s.variable in dataset]
    named = {s.label: (s.variable, s.scale.rest) for s in shown} or {
        str(name): (str(name), 0.0) for name in list(dataset.data_vars)[:MOST]
    }
    return {label: settling(dataset[name], rest) for label, (name, rest) in named.items()}


def counted(dataset: Responses, start: float | None, settle: bool) -> Responses:
    """The rows of a run that its statistics count.

    start: their first time [s]. settle: leave out the transient, found by MSER-5. Raises ValueError
    where next to nothing is left.
    """
    if start is None and not settle:
        return dataset
    counted_from = float(dataset["time"].values[0])
    if settle:
        counted_from += max((s.transient for s in moving(dataset).values()), default=0.0)
    if start is not None:
        counted_from = max(counted_from, start)
    return from_time(dataset, counted_from)


def _is_car(dataset: Responses) -> bool:
    return any(shown.variable in dataset for shown in layout_of(dataset).quantities.values())


def _answer(dataset: Responses) -> Part:
    if (ends := speeds(dataset)) is not None and _is_car(dataset):
        return Part("answer", Level.UNKNOWN, _under_way(dataset, ends, standing(dataset)))
    if _bends(dataset):
        said = f"{MIXED} {_capital(str(standing(dataset) or UNKNOWN))}."
        return Part("answer", Level.UNKNOWN, said)
    found, stands = moving(dataset), standing(dataset)
    level, text = _settled(found, stands, float(np.ptp(dataset["time"].values)), _laid(dataset))
    if not _is_car(dataset):
        return Part("answer", level, text)
    if stands is None:
        return Part("answer", level, f"{text} {UNKNOWN}.")
    return Part("answer", level, f"{text} {_capital(str(stands))}.")


def _bends(dataset: Responses) -> bool:
    """Whether the line is not as curved at all times of the run."""
    name = f"{layout_of(dataset).track}.curvature"
    return name in dataset and bool(np.ptp(dataset[name].values))


def _under_way(dataset: Responses, ends: tuple[float, float], stands: Standing | None) -> str:
    """Of a run whose speed changes; ends: first and last one [m/s]."""
    said = (
        f"The speed goes from {speed_text(ends[0])} to {speed_text(ends[1])}, so that statistics "
        "of the whole are of no speed; look at the motion over time"
    )
    critical = stands.critical if stands is not None else None
    if critical is None:
        return f"{said}."
    above = dataset[layout_of(dataset).speed].values > critical
    passed = np.flatnonzero(above[1:] != above[:-1])
    when = [f"{t:.3g} s" for t in dataset["time"].values[passed + 1][:3]]
    where = f"at t = {', '.join(when)} it passes" if when else "it does not pass"
    return f"{said}; {where} the critical speed of the linear car, {speed_text(critical)}."


def _laid(dataset: Responses) -> bool:
    """Whether the track is one of stations, which end, and not of a spectrum."""
    known, track = Provenance.of(dataset).parameters, layout_of(dataset).track
    return f"{track}.fade_length" in known and f"{track}.spectrum" not in known


def _settled(
    found: dict[str, Settling], stands: Standing | None, span: float, laid: bool
) -> tuple[Level, str]:
    """span: of the run [s]. laid: whether the track may end before a longer one."""
    alive = {label: s for label, s in found.items() if s.state is not State.STILL}
    still = [label for label in found if label not in alive]
    more = f" Not excited: {', '.join(still)}." if still else ""
    if not alive:
        return Level.UNKNOWN, f"Nothing that is judged moves.{more}"
    if any(s.state is State.BURST for s in alive.values()):
        return Level.BAD, f"The motion grew beyond all numbers; see the coupling.{more}"
    growth = max((s.rate, s.growth) for s in alive.values())[1]
    unsettled = {k: s for k, s in alive.items() if s.state is not State.SETTLED}
    above = stands is not None and stands.above
    grown = min(10.0 / stands.growth, LONG) if stands is not None and above else 0.0
    if not unsettled and span >= grown:
        return Level.GOOD, f"Settled: statistics mean something.{more}"
    needed = max([grown, *(s.needed for s in unsettled.values())])
    states = {s.state for s in unsettled.values()}
    least = _rounded(needed)
    todo = f"run at least {least} s, and leave out the transient (--duration {least}s --settle)"
    if laid:
        todo += "; where the track ends before, take the peaks over its stretches and no rms"
    if State.GROWING in states or (above and growth > 1.0):
        said = f"grew {growth:.2g} times from the first half to the second"
        return Level.DOUBTFUL, f"Not settled: {said}; {todo}.{more}"
    if State.DECAYING in states:
        verb = "decays" if len(unsettled) == 1 else "decay"
        return Level.DOUBTFUL, f"Not settled: {', '.join(unsettled)} {verb}; {todo}.{more}"
    if not unsettled:
        return Level.DOUBTFUL, f"Too short for what grows to grow; {todo}.{more}"
    return Level.DOUBTFUL, f"Too short for statistics of {', '.join(unsettled)}; {todo}.{more}"


def _range(dataset: Responses, known: Range, happened: list[Event], unsure: bool) -> Part:
    """unsure: whether the coupling may have led the run there."""
    beyond = [d for d in known.departures if not d.at_edge]
    derailed = [event for event in happened if event.kind == DERAILMENT]
    unknown = _unknown(known)
    said, told = list[str](), list[Departure]()
    if beyond:
        worst, *others = beyond
        # What came before a derailment may have led there: it is told with its remedy.
        last = worst.time if worst.limit.void else max((e.time for e in derailed), default=0.0)
        before = [d for d in others if d.time < last]
        told = [worst, *before]
        more = [_in_short(d) for d in others if d not in before]
        said.append(f"{_capital(str(worst))}.")
        said += [f"This may have led there: {_in_short(d)}; {d.limit.remedy}." for d in before]
        said += [f"Also outside: {'; '.join(more)}."] if more else []
    if unsure and (beyond or derailed):
        said.append("The coupling may be what led there; mend it first.")
    void = any(d.limit.void for d in beyond)
    if derailed:
        todo = "" if unsure else helps(dataset, derailed[0], told)
        first = _capital(_derailed(derailed, nadal_rule(dataset), todo))
        said.insert(len(said) if void else 0, first)
    if not said and known.looked_at:
        said.append("The run stayed inside the limits that its FMUs state.")
    said += [f"{_capital(str(d))}." for d in known.departures if d.at_edge]
    said += unknown or ([] if said else ["The run does not say what its FMUs hold for."])
    if derailed or void:
        level = Level.BAD
    elif beyond:
        level = Level.DOUBTFUL
    else:
        level = Level.UNKNOWN if unknown or not known.looked_at else Level.GOOD
    return Part("range", level, " ".join(said))


def _in_short(departure: Departure) -> str:
    """What was beyond, since when, how far."""
    return f"{departure.limit.beyond} (from {departure.time:.3g} s, worst {departure.found})"


def _derailed(found: list[Event], rule: Nadal, todo: str) -> str:
    """The first derailment; todo: what helps."""
    more = f", and {len(found) - 1} more" if len(found) > 1 else ""
    return (
        f"{found[0]}{more}; Nadal's limit is {rule.limit:.3g} over {rule.window:.3g} m "
        f"({rule.source}; {rule.given}). "
        f"No flange climbs in this model: what follows means nothing{todo and f'; {todo}'}."
    )


def _unknown(known: Range) -> list[str]:
    """Sentences on what of the range is not known."""
    said = []
    if known.silent:
        said.append(f"Not known for {', '.join(known.silent)}: the FMU states no range.")
    if known.unrecorded:
        first, *others = known.unrecorded
        more = f" and {len(others)} more" if others else ""
        said.append(
            f"Not looked at, as it was not recorded: {first}{more}; record it (--record '{first}')."
        )
    return said


def _capital(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def _rounded(seconds: float) -> int:
    """Upwards to tens of seconds; below ten to seconds."""
    return ceil(seconds) if seconds < 10.0 else 10 * ceil(seconds / 10.0)
