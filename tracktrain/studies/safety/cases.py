"""What is run and judged: a car with some profiles along a line at a speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, isinf
from pathlib import Path

import pandas as pd

from fmus.track.recorded_data import TrackData
from fmus.wheelrail.contact_table import ContactTable
from orchestrator import Session, simulate

from ...assessment import EXCEEDED, PASSED, assess
from ...assessment.rules import rules
from ...car.hopper import hopper_car, layout_of
from ...car.track import time_over, with_track
from ...car.wheelsets import with_profiles
from ...errors import TracktrainError
from ...events import DERAILMENT, events
from ...failures import heard
from ...geometry.layout import Element, length_of, with_layout
from ...geometry.making import empty, with_spectrum
from ...geometry.sections import CURVE, STRAIGHT, TRANSITION
from ...profiles.examined import NORM, Examined
from ...profiles.pairing import Pairing, contact_table
from ...scales import MILE_PER_HOUR

STEP = 1e-3
"""Macro step [s]."""

SPACING = 0.25
"""Between the stations of a track [m]."""

APPROACH, EASING, BODY, EXIT = 60.0, 60.0, 250.0, 60.0
"""Lengths of the straights at both ends, of a transition and of the curve [m]."""

SAFETY = {
    "wheel_l_over_v": "wheel L/V",
    "truck_side_l_over_v": "truck side L/V",
    "aar_axle_sum_way": "axle sum of wheel L/V",
    "aar_wheel_unloading_way": "least wheel load",
    "aar_peak_to_peak": "carbody lateral acceleration",
    "aar_roll": "carbody roll",
    "en_axle_force": "sum Y",
    "en_wheel_load": "wheel load Q",
    "en_derailment": "Y/Q of a leading wheel",
    "en_quasi_static_force": "quasi-static guiding force",
}
"""Rules of the assessment that are about safety, by key, and their names in a table."""


@dataclass(frozen=True)
class Line:
    """A straight, or a curve to the left between transitions; radius [m], cant [m]."""

    radius: float = inf
    cant: float = 0.0

    @property
    def title(self) -> str:
        if isinf(self.radius):
            return "straight"
        return f"curve of {self.radius:.6g} m, cant {1e3 * self.cant:.3g} mm"

    def elements(self) -> list[Element]:
        """As the layout of a track has them."""
        if isinf(self.radius):
            return [Element(STRAIGHT, APPROACH + 2 * EASING + BODY + EXIT, 0.0, 0.0)]
        bent = 1 / self.radius, self.cant
        return [
            Element(STRAIGHT, APPROACH, 0.0, 0.0),
            Element(TRANSITION, EASING, *bent),
            Element(CURVE, BODY, *bent),
            Element(TRANSITION, EASING, 0.0, 0.0),
            Element(STRAIGHT, EXIT, 0.0, 0.0),
        ]


Profile = str | Path
Given = Profile | tuple[Profile, Profile]
"""A profile of both sides, also as "left,right"; or those of the left and the right side."""


@dataclass(frozen=True)
class Profiles:
    """A wheel and a rail, and those of the right side; None: as on the left."""

    wheel: Profile
    rail: Profile
    right: tuple[Profile | None, Profile | None] = (None, None)

    @classmethod
    def of(cls, wheel: Given, rail: Given) -> Profiles:
        """Of what a study is given; raises TracktrainError for what is no one or two profiles."""
        (left, other), (own, another) = _sides(wheel, "wheel"), _sides(rail, "rail")
        return cls(left, own, (other, another))

    @cached_property
    def table(self) -> ContactTable:
        """What they do in the freight car's track."""
        return contact_table(self.wheel, self.rail, right=self.right)

    @property
    def conicity(self) -> float:
        """Equivalent one at the norm's amplitude."""
        placed = Pairing().placed(self.wheel, self.rail, right=self.right)
        return Examined(*placed).conicity_at(NORM)

    def __str__(self) -> str:
        both = zip((self.wheel, self.rail), self.right, strict=True)
        return " on ".join(",".join(Path(p).stem for p in pair if p is not None) for pair in both)


def _sides(given: Given, kind: str) -> tuple[Profile, Profile | None]:
    """The left profile, and the right one where it is another."""
    parts: Sequence[Profile] = given if isinstance(given, tuple) else (given,)
    if isinstance(given, str) and not Path(given).is_file():
        parts = tuple(part.strip() for part in given.split(","))
    if len(parts) > 2 or not all(map(str, parts)):
        raise TracktrainError(
            f"'{given}' is no {kind} of both sides; give a file or a name, or left and right as in "
            "worn,conical"
        )
    return parts[0], parts[1] if parts[-1] != parts[0] else None


@dataclass(frozen=True)
class Surroundings:
    """The irregularities and their seed, and the law of the creep forces."""

    track: str = "fra4"
    seed: int = 1
    creep_law: str = "polach"


@dataclass(frozen=True)
class Case:
    """A run that was judged; speed [m/s].

    shares: of each limit of `SAFETY` that could be judged. derailments: as `events` counts them.
    stopped: why the run did, before its end.
    """

    car: str
    line: Line
    profiles: str
    speed: float
    shares: Mapping[str, float]
    derailments: int
    stopped: str

    @property
    def worst(self) -> tuple[str, float]:
        """The rule of which most is used, and that share."""
        name = max(self.shares, key=lambda key: self.shares[key])
        return name, self.shares[name]

    @property
    def reason(self) -> str:
        """What makes it unsafe; empty for a safe one."""
        if self.stopped:
            return "run stopped"
        if self.derailments:
            return "derailment"
        name, share = self.worst
        return SAFETY[name] if share > 1.0 else ""

    def __str__(self) -> str:
        name, share = self.worst if self.shares else ("", inf)
        return (
            self.reason.upper()
            if self.stopped
            else f"{share:.2f} {SAFETY.get(name, '')}" + (", DERAILS" if self.derailments else "")
        )


def laid(line: Line, surroundings: Surroundings) -> TrackData:
    """The track along a line, with its irregularities."""
    elements = line.elements()
    data = empty("line", length_of(elements), SPACING)
    if surroundings.track != "perfect":
        data = with_spectrum(data, surroundings.track, surroundings.seed)
    return with_layout(data, elements, line.title)


def run_case(
    car: str,
    along: tuple[Line, TrackData],
    profiles: Profiles,
    speed: float,
    creep_law: str,
    session: Session,
) -> Case:
    """One run; along: a line and its track."""
    line, data = along
    system = hopper_car(car, speed, "perfect")
    system, _ = with_profiles(system, profiles.table)
    given = {"creep_law": creep_law}
    wheelsets = [axle.wheelset for axle in layout_of(system).axles]
    system = system.with_values({wheelset: given for wheelset in wheelsets})
    system, _ = with_track(system, data)
    duration = time_over(system, data, STEP)
    run = heard(simulate(system, duration=duration, step=STEP, session=session))
    if not run.completed and run.time.size < 100:
        return Case(car, line, str(profiles), speed, {}, 0, run.message or "")
    found = events(run.dataset)
    return Case(
        car,
        line,
        str(profiles),
        speed,
        _shares(assess(run)),
        sum(event.kind == DERAILMENT for event in found),
        "" if run.completed else run.message or "",
    )


def _shares(table: pd.DataFrame) -> dict[str, float]:
    judged = table["share"][table["result"].isin([PASSED, EXCEEDED])]
    quantities = {rule.key: rule.quantity for rule in rules()}
    return {key: float(judged[quantities[key]]) for key in SAFETY if quantities[key] in judged}


def highest_safe(cases: Sequence[Case]) -> tuple[float, Case | None]:
    """Of cases that differ in speed alone: the speed [m/s] up to which all are safe, 0 for none;
    and the first that is not."""
    safe = 0.0
    for case in sorted(cases, key=lambda case: case.speed):
        if case.reason:
            return safe, case
        safe = case.speed
    return safe, None


def mph(speed: float) -> float:
    """From m/s."""
    return speed / MILE_PER_HOUR
