"""What is known of how good an answer is: plain data, in the order in which it is found.

Of an FMU its `SelfTest`, of a system its `StepLimit`, of a run its `Refinement`, all of them
together the `Evidence`; and the `Verdict` that follows from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from ..masters.base import all_masters
from ..notes import Advice, Detail

VERSION = 4
"""Of the checks: results of another version are not used."""

MARGIN = 0.5
"""Share of the largest stable step above which a run is warned of: damping is off by then."""

FAR = 16.0
"""How many times the step is tried; a limit beyond does not matter."""


@dataclass(frozen=True)
class Finding:
    """What a check found, in words.

    wrong: an error in the FMU, and no mere remark. tested: False where the check could not be done.
    """

    check: str
    text: str
    wrong: bool = True
    tested: bool = True


@dataclass(frozen=True)
class SelfTest:
    """Checks that an FMU went through without error, and what was found."""

    label: str
    passed: tuple[str, ...]
    findings: tuple[Finding, ...] = ()

    @property
    def errors(self) -> list[Finding]:
        return [f for f in self.findings if f.wrong]

    @property
    def untested(self) -> list[Finding]:
        """Why checks could not be done."""
        return [f for f in self.findings if not f.tested]

    @property
    def reads_any_time(self) -> bool:
        """Whether outputs may be read after inputs were set, without a step between."""
        return not any(f.check == "reading" and f.tested for f in self.findings)

    def failed(self, check: str) -> bool:
        """Whether a check found an error."""
        return any(f.check == check for f in self.errors)


def step_text(step: float) -> str:
    """A step [s] to two digits, with its unit."""
    return f"{step:.2g}s" if step >= 1.0 else f"{1e3 * step:.2g}ms"


@dataclass(frozen=True)
class StepLimit:
    """A macro step [s], and the largest that is stable, which a connection sets; inf for none."""

    step: float
    largest: float
    connection: str = ""

    @property
    def share(self) -> float:
        """The step over the largest stable one."""
        return self.step / self.largest

    @property
    def close(self) -> bool:
        """Whether the step is so large that it needs a warning."""
        return self.share > MARGIN

    @property
    def note(self) -> str:
        """What a run says of it."""
        if not math.isfinite(self.largest):
            return Detail(f"largest stable step: no limit up to {FAR * self.step:.3g} s")
        least = f"largest stable step: about {self.largest:.3g} s, by {self.connection}"
        if not self.close:
            return Detail(f"{least}; the step is {self.share:.2g} of it")
        return f"{least}; the step of {self.step:g} s is {self.share:.2g} of it"

    @property
    def advice(self) -> Advice:
        """What to do about a step that is close to the limit."""
        following = [m for m in all_masters().values() if m.follows]
        most = MARGIN * self.largest
        return Advice(
            f"take at most {step_text(most)}, or a master that follows the loop: "
            f"{', '.join(f'{m.name} {m.follows}' for m in following)}",
            {"step": step_text(most)},
            *({"master": m.name} for m in following),
        )


@dataclass(frozen=True)
class Error:
    """Error of an output at the run's step, by Richardson: rms and peak over the signal's rms.

    order: observed, or NaN where there is none; then the difference to the run with half the step.
    """

    name: str
    rms: float
    peak: float
    order: float

    @property
    def converges(self) -> bool:
        return not math.isnan(self.order)


@dataclass(frozen=True)
class Refinement:
    """Errors by output, those against the monolithic twin over `twin_span` [s], and notes."""

    step: float
    errors: tuple[Error, ...]
    twin: tuple[Error, ...] = ()
    twin_span: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    def worst(self) -> Error | None:
        """The output with the largest error."""
        return max(self.errors, key=lambda error: error.rms, default=None)


@dataclass(frozen=True)
class Evidence:
    """What is known of a run besides its residuals: before it, and by repeating it."""

    tests: Mapping[str, SelfTest] = field(default_factory=dict)
    limit: StepLimit | None = None
    refinement: Refinement | None = None

    @property
    def distrusted(self) -> frozenset[str]:
        """Instances whose saved states do not hold everything."""
        return frozenset(name for name, test in self.tests.items() if test.failed("rollback"))

    @property
    def crashed(self) -> list[str]:
        """Instances whose self-test ended with its process; they get one of their own."""
        return [name for name, test in self.tests.items() if test.failed("process")]

    def notes(self, of_master: Sequence[str]) -> list[str]:
        """What a run says before its first step; of_master: what its master says of the FMUs."""
        found: dict[str, list[str]] = {}
        for name, test in self.tests.items():
            for finding in test.errors:
                found.setdefault(f"{test.label}: {finding.text}", []).append(name)
        said = [f"self-test of {', '.join(names)}: {text}" for text, names in found.items()]
        return [*said, *of_master, *([self.limit.note] if self.limit else [])]

    def attributes(self) -> dict[str, Any]:
        """Attributes for a run's results."""
        limit = self.limit
        return {
            "self_test": {
                name: [f.text for f in [*test.errors, *test.untested]] or "passed"
                for name, test in self.tests.items()
            }
            or None,
            "largest_stable_step": limit.largest if limit else None,
            "largest_stable_step_set_by": limit.connection if limit else None,
        }


class Level(Enum):
    """How far an answer can be relied on; see docs/trust.md."""

    GOOD = "good"
    UNKNOWN = "unknown"
    DOUBTFUL = "doubtful"
    BAD = "bad"


@dataclass(frozen=True)
class Verdict:
    """What the coupling of a run is worth: a level, the reasons for it, and what to do."""

    level: Level
    reasons: tuple[str, ...]
    advice: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"Coupling: {self.level.value}. {self.told()}"

    def told(self, said: Callable[[str], str] = str) -> str:
        """The reasons and what to do; said: how that is written, each an `Advice` or plain text."""
        todo = "".join(f" {_sentence(said(text))}" for text in self.advice)
        return f"{_sentence('; '.join(self.reasons))}{todo}"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
