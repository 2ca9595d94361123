"""How a master brings each input over a macro step, and in which order slaves step.

The one-pass master asks the FMUs' descriptions. In order of preference an input is led by
- a tangent: the source gives directional derivatives, and the slave takes input derivatives and the
  partial derivatives of this input with respect to its own outputs which drive that source;
- its known end: the source has stepped before;
- a declared rate: the source has an output that is the derivative of this one. Where that has a
  declared derivative itself, the input moves along the line that has the mean of its parabola over
  the step, and stands at the parabola's end when the slave's outputs are read: held to its first
  rate, a stiff centre plate would push its two sides with forces that differ by K a H^2/12;
- extrapolation of the last two values.
The other explicit masters use the known end or extrapolation alone. An input of a slave that takes
no input derivatives is constant over a step, at the mean of what it would have been led along.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from itertools import pairwise

from ..errors import UnitError, listed
from ..fmu.description import Description, Tangent, Variable
from ..fmu.units import conversion, scale_of
from ..plan.graph import strong_parts
from ..plan.plan import Link, Plan


class Way(Enum):
    """How an input is brought over a step; the value says it in a note."""

    TANGENT = "follow a tangent of their source"
    KNOWN_END = "are linear between the known ends of the step"
    DECLARED_RATE = "follow the rate that their source declares"
    EXTRAPOLATED = "are extrapolated from the last values"
    HELD = "are held"


@dataclass
class Coupling:
    """Order of the slaves, way of each link, and for a tangent the partials that are wanted.

    degree: of the polynomial that extrapolates. rates: for a declared rate its name and the factor
    to the output's unit per second; the same of the rate's own rate where that is declared, too.
    """

    order: list[int]
    ways: dict[Link, Way]
    degree: int = 1
    tangents: dict[Link, list[Tangent]] = field(default_factory=dict)
    rates: dict[Link, list[tuple[str, float]]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._place = {slave: n for n, slave in enumerate(self.order)}

    def stepped_before(self, first: int, second: int) -> bool:
        """Whether one slave steps before another."""
        return self._place[first] < self._place[second]


def couple(plan: Plan) -> Coupling:
    """Classify the links of a plan and order its slaves."""
    tangents = {k: found for k in plan.links if (found := _tangents(plan, k))}
    rates = {k: chain for k in plan.links if (chain := _rates(plan, k))}
    discrete = {k for k in plan.links if not continuous(k)}
    strong: dict[tuple[int, int], list[Link]] = {}
    weak: set[tuple[int, int]] = set()
    fixed: set[tuple[int, int]] = set()
    for link in plan.links:
        if link in discrete:
            needed = []
        elif link not in tangents:
            needed = [(link.source, link)]
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
    order, broken = _order(len(plan.names), {*strong, *fixed}, weak, strong)
    for cycle, (source, target) in broken:
        names = ", ".join(plan.name(k.target, k.input) for k in strong.get((source, target), ()))
        notes.append(
            f"{' -> '.join(plan.names[n] for n in [*cycle, cycle[0]])} wait for each other: "
            f"{plan.names[target]} steps first, with {names} extrapolated"
        )
    coupling = Coupling(order, {}, 1, tangents, rates, notes)
    for link in plan.links:
        stepped_before = coupling.stepped_before(link.source, link.target)
        if link in discrete:
            coupling.ways[link] = Way.HELD
        elif link in tangents and not stepped_before:
            coupling.ways[link] = Way.TANGENT
        elif stepped_before:
            coupling.ways[link] = Way.KNOWN_END
        else:
            coupling.ways[link] = Way.DECLARED_RATE if link in rates else Way.EXTRAPOLATED
    coupling.notes[:0] = way_notes(plan, coupling)
    return coupling


def dependent(plan: Plan, cut: Collection[Link] = ()) -> list[list[int]]:
    """Parts of slaves that depend on each other by links that are not cut, sources first."""
    instances = range(len(plan.names))
    sources = {i: [k.source for k in plan.links_of(i) if k not in cut] for i in instances}
    return strong_parts(instances, sources)


def continuous(link: Link) -> bool:
    """Whether there are values between those of a link.

    Whole numbers and Booleans have none, and neither has what stays as it is between ticks.
    """
    held = link.output.held or link.input.held
    return link.output.kind == "real" and link.input.kind == "real" and not held


def interpolated(plan: Plan, link: Link) -> bool:
    """Whether a link's input can move along a line over a step."""
    return continuous(link) and plan.descriptions[link.target].interpolates(link.input)


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
        k for k in plan.links_of(link.source) if (k.source, k.output.name) == (link.target, output)
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


Edge = tuple[int, int]


def _order(
    count: int, edges: set[Edge], weak: set[Edge], strong: Mapping[Edge, Sequence[Link]]
) -> tuple[list[int], list[tuple[list[int], Edge]]]:
    """Slaves with every edge's source first; and each cycle, with its edge that had to be broken.

    Where there is a choice, the slave goes first that has the fewest sources by weak edges still to
    step. An edge without strong links is broken only where a cycle has no other.
    """
    waiting: list[set[int]] = [set() for _ in range(count)]
    followers: list[list[int]] = [[] for _ in range(count)]
    missing = [0] * count
    weak_followers: list[list[int]] = [[] for _ in range(count)]
    for source, target in edges:
        waiting[target].add(source)
        followers[source].append(target)
    for source, target in weak:
        missing[target] += 1
        weak_followers[source].append(target)
    ready = [(missing[n], n) for n in range(count) if not waiting[n]]
    heapq.heapify(ready)
    order: list[int] = []
    done = [False] * count
    broken: list[tuple[list[int], Edge]] = []
    lowest = 0
    while len(order) < count:
        if not ready:
            while done[lowest]:
                lowest += 1
            cycle = _cycle(lowest, waiting)
            around = [*pairwise([*cycle, cycle[0]])]
            breakable = [edge for edge in around if edge in strong] or around
            edge = min(breakable, key=lambda e: (_harm(strong.get(e, ())), around.index(e)))
            broken.append((cycle, edge))
            waiting[edge[1]].discard(edge[0])
            if not waiting[edge[1]]:
                heapq.heappush(ready, (missing[edge[1]], edge[1]))
            continue
        sources_left, chosen = heapq.heappop(ready)
        if done[chosen] or sources_left != missing[chosen]:
            continue
        done[chosen] = True
        order.append(chosen)
        for target in weak_followers[chosen]:
            missing[target] -= 1
            if not waiting[target] and not done[target]:
                heapq.heappush(ready, (missing[target], target))
        for target in followers[chosen]:
            if chosen in waiting[target]:
                waiting[target].discard(chosen)
                if not waiting[target]:
                    heapq.heappush(ready, (missing[target], target))
    return order, broken


def _cycle(start: int, waiting: Sequence[set[int]]) -> list[int]:
    """Slaves that wait for each other, each a source of the next."""
    path, place = [start], {start: 0}
    while True:
        previous = min(waiting[path[-1]])
        if previous in place:
            return path[place[previous] :][::-1]
        place[previous] = len(path)
        path.append(previous)


def way_notes(plan: Plan, coupling: Coupling) -> list[str]:
    """One line for each way; names for those that cost accuracy."""
    notes = []
    for way in Way:
        links = [link for link in plan.links if coupling.ways[link] is way]
        if links:
            named = f": {_names(plan, links)}" if way is Way.EXTRAPOLATED else ""
            notes.append(f"{len(links)} of {len(plan.links)} inputs {way.value}{named}")
    constant = [
        link
        for link in plan.links
        if coupling.ways[link] is not Way.HELD and not interpolated(plan, link)
    ]
    if constant:
        notes.append(
            f"{len(constant)} of {len(plan.links)} inputs are constant over each step at their "
            f"mean, since the FMU takes no input derivatives: {_names(plan, constant)}"
        )
    return notes


def _names(plan: Plan, links: Sequence[Link]) -> str:
    return listed([plan.name(k.target, k.input) for k in links], 40)
