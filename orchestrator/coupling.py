"""How the one-pass master brings each input over a macro step, and in which order slaves step.

Only the FMUs' descriptions are asked. In order of preference an input of a slave that takes input
derivatives is led by
- a tangent: the source gives directional derivatives, and the slave takes the partial derivatives
  of this input with respect to its own outputs which drive that source;
- its known end: the source has stepped before;
- a declared rate: the source has an output that is the derivative of this one. Where that has a
  declared derivative itself, the input moves along the line that has the mean of its parabola over
  the step, and stands at the parabola's end when the slave's outputs are read: held to its first
  rate, a stiff centre plate would push its two sides with forces that differ by K a H^2/12;
- extrapolation of the last two values.
An input of any other slave is held.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise

from .description import Description, Tangent, Variable
from .errors import UnitError
from .plan import Link, Plan
from .units import conversion, scale_of


class Way(Enum):
    """How an input is brought over a step; the value says it in a note."""

    TANGENT = "follow a tangent of their source"
    KNOWN_END = "are linear between the known ends of the step"
    DECLARED_RATE = "follow the rate that their source declares"
    EXTRAPOLATED = "are extrapolated from the last two values"
    HELD = "are held, since the FMU takes no input derivatives"


@dataclass
class Coupling:
    """Order of the slaves, way of each link, and for a tangent the partials that are wanted.

    rates: for a declared rate its name and the factor to the output's unit per second; the same of
    the rate's own rate where that is declared, too.
    """

    order: list[int]
    ways: dict[Link, Way]
    tangents: dict[Link, list[Tangent]]
    rates: dict[Link, list[tuple[str, float]]]
    notes: list[str] = field(default_factory=list)

    def stepped_before(self, first: int, second: int) -> bool:
        """Whether one slave steps before another."""
        return self.order.index(first) < self.order.index(second)


def couple(plan: Plan) -> Coupling:
    """Classify the links of a plan and order its slaves."""
    tangents = {k: found for k in plan.links if (found := _tangents(plan, k))}
    rates = {k: chain for k in plan.links if (chain := _rates(plan, k))}
    strong: dict[tuple[int, int], list[Link]] = {}
    weak: set[tuple[int, int]] = set()
    fixed: set[tuple[int, int]] = set()
    for link in plan.links:
        if link not in tangents:
            needed = [(link.source, link)] if _interpolates(plan, link) else []
        else:
            fixed.add((link.target, link.source))
            needed = [(k.source, k) for k in uncovered(plan, link, tangents[link])]
        for source, behind in needed:
            if source == link.target:
                continue
            if behind in rates:
                weak.add((source, link.target))
            elif behind not in (links := strong.setdefault((source, link.target), [])):
                links.append(behind)
    notes = []
    while True:
        order, cycle = _order(len(plan.names), {*strong, *fixed}, weak)
        if not cycle:
            break
        breakable = [edge for edge in cycle if edge in strong] or [e for e in cycle if e in fixed]
        edge = min(breakable, key=lambda e: (_harm(strong.get(e, [])), cycle.index(e)))
        fixed.discard(edge)
        if edge in strong:
            broken = ", ".join(plan.name(k.target, k.input) for k in strong.pop(edge))
            notes.append(
                f"{' -> '.join(plan.names[a] for a, _ in [*cycle, cycle[0]])} wait for each other: "
                f"{plan.names[edge[1]]} steps first, with {broken} extrapolated"
            )
    place = {slave: n for n, slave in enumerate(order)}
    ways: dict[Link, Way] = {}
    for link in plan.links:
        stepped_before = place[link.source] < place[link.target]
        if not _interpolates(plan, link):
            ways[link] = Way.HELD
        elif link in tangents and not stepped_before:
            ways[link] = Way.TANGENT
        elif stepped_before:
            ways[link] = Way.KNOWN_END
        else:
            ways[link] = Way.DECLARED_RATE if link in rates else Way.EXTRAPOLATED
    return Coupling(order, ways, tangents, rates, [*_notes(plan, ways), *notes])


def _interpolates(plan: Plan, link: Link) -> bool:
    return link.output.kind == "real" and plan.descriptions[link.target].interpolates(link.input)


def _tangents(plan: Plan, link: Link) -> list[Tangent]:
    """The tangents of a link's target that its source can fill."""
    source, target = plan.descriptions[link.source], plan.descriptions[link.target]
    depends = link.output.dependencies
    if not source.gives_derivatives or not depends or not target.interpolates_inputs:
        return []
    return [
        tangent
        for tangent in target.tangents
        if tangent.input == link.input.name
        and (link.target, tangent.partial) not in plan.link_of
        and any(k.input.name in depends for k in drives(plan, link, tangent.output))
    ]


def drives(plan: Plan, link: Link, output: str) -> list[Link]:
    """The links by which an output of a link's target drives the link's source."""
    return [
        k
        for k in plan.links
        if (k.source, k.target, k.output.name) == (link.target, link.source, output)
    ]


def uncovered(plan: Plan, link: Link, tangents: list[Tangent]) -> list[Link]:
    """What else drives the source of a link on which the output depends: it enters as a rate."""
    covered = {k for tangent in tangents for k in drives(plan, link, tangent.output)}
    return [
        k
        for k in plan.links_of(link.source)
        if k.input.name in (link.output.dependencies or ()) and k not in covered
    ]


def _rates(plan: Plan, link: Link) -> list[tuple[str, float]]:
    """Names of the declared rate of a link's output and of that rate's own, with their factors."""
    found, output = [], link.output
    for _ in range(2):
        rate = plan.descriptions[link.source].rate_of(output.name)
        if rate is None or rate.kind != "real":
            break
        factor = _per_second(plan.descriptions[link.source], output, rate)
        if factor is None:
            break
        found.append((rate.name, factor))
        output = rate
    return found


def _per_second(description: Description, output: Variable, rate: Variable) -> float | None:
    """What a rate's value is to be multiplied with to be in the output's unit per second."""
    unit, given = output.unit or "1", rate.unit or "1"
    per_second = {"1": "1/s"}.get(unit, f"{unit}/s")
    if given == per_second or given == unit.replace("/s", "/s2"):
        return 1.0
    try:
        found = conversion(given, per_second, description.units, description.units)
        if found is None and unit.endswith("/s"):
            found = conversion(given, f"{unit}2", description.units, description.units)
    except UnitError:
        return None
    return found[0] if found else None


def _harm(links: Iterable[Link]) -> int:
    """How much it hurts to extrapolate these: a motion is smoother than a force."""
    return sum(10 if _is_force(link) else 1 for link in links)


def _is_force(link: Link) -> bool:
    try:
        return "[mass]" in scale_of(link.output.unit or "1").dimension
    except UnitError:
        return True


def _order(
    count: int, strong: set[tuple[int, int]], weak: set[tuple[int, int]]
) -> tuple[list[int], list[tuple[int, int]]]:
    """Slaves with every source of a strong edge first; or a cycle, as edges.

    Where there is a choice, the slave goes first that has the fewest sources still to step.
    """
    left = set(range(count))
    order: list[int] = []
    while left:
        ready = [n for n in left if not any(a in left and a != n for a, b in strong if b == n)]
        if not ready:
            return order, _cycle(left, strong)
        chosen = min(ready, key=lambda n: (sum(a in left - {n} for a, b in weak if b == n), n))
        order.append(chosen)
        left.remove(chosen)
    return order, []


def _cycle(left: set[int], strong: set[tuple[int, int]]) -> list[tuple[int, int]]:
    path = [min(left)]
    while True:
        previous = min(a for a, b in strong if b == path[-1] and a in left and a != b)
        if previous in path:
            path = [*path[path.index(previous) :], previous][::-1]
            return list(pairwise(path))
        path.append(previous)


def _notes(plan: Plan, ways: dict[Link, Way]) -> list[str]:
    """One line for each way; names for those that cost accuracy."""
    notes = []
    for way in Way:
        links = [link for link in plan.links if ways[link] is way]
        if links:
            names = ", ".join(plan.name(k.target, k.input) for k in links)
            degraded = way in (Way.EXTRAPOLATED, Way.HELD)
            notes.append(
                f"{len(links)} of {len(plan.links)} inputs {way.value}"
                + (f": {names}" if degraded else "")
            )
    return notes
