"""One verdict on a run, in plain words: a level, why, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

from ..bonds import BondResidual

if TYPE_CHECKING:
    from .findings import SelfTest
    from .refinement import Refinement
    from .step_limit import StepLimit


class Level(Enum):
    """How far an answer can be relied on; see docs/trust.md."""

    GOOD = "good"
    UNKNOWN = "unknown"
    DOUBTFUL = "doubtful"
    BAD = "bad"


SMALL_RESIDUAL = 1e-3
"""Energy residual of a bond below which the coupling does no harm: the hopper car with held inputs,
whose motion is 3 to 14 % wrong, has 6e-3 to 2e-2; coupled to 1e-5 it has 1e-5."""

LARGE_RESIDUAL = 0.1
"""Energy residual above which the coupling makes up a good part of the motion."""

CARRYING = 1e-6
"""Share of the energy through the busiest bond below which a bond carries nothing but rounding."""

SMALL_ERROR, LARGE_ERROR = 0.01, 0.2
"""Estimated error of an output over its rms: what engineering takes, and what it cannot use."""

JUMPING = 0.5
"""Change of a force from step to step over twice its size, above which it jumps to and fro."""

_ORDER = [Level.GOOD, Level.UNKNOWN, Level.DOUBTFUL, Level.BAD]


@dataclass(frozen=True)
class Verdict:
    """A level, the reasons for it, and what to do."""

    level: Level
    reasons: tuple[str, ...]
    advice: tuple[str, ...] = ()

    def __str__(self) -> str:
        said = "; ".join(self.reasons)
        todo = "".join(f" {_sentence(text)}" for text in self.advice)
        return f"Trust: {self.level.value}. {_sentence(said)}{todo}"


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

    def notes(self, master: str) -> list[str]:
        """What a run says before its first step."""
        found: dict[str, list[str]] = {}
        for name, test in self.tests.items():
            for finding in test.errors:
                found.setdefault(f"{test.label}: {finding.text}", []).append(name)
        said = [f"self-test of {', '.join(names)}: {text}" for text, names in found.items()]
        if master == "iterated" and self.distrusted:
            said.append(
                f"not repeated, since not rolled back: {', '.join(sorted(self.distrusted))}"
            )
        return [*said, *([self.limit.note] if self.limit else [])]

    def attributes(self) -> dict[str, Any]:
        """Attributes for a run's results."""
        limit = self.limit
        return {
            "self_test": {
                name: [finding.text for finding in test.errors] or "passed"
                for name, test in self.tests.items()
            }
            or None,
            "largest_stable_step": limit.largest if limit else None,
            "largest_stable_step_set_by": limit.connection if limit else None,
        }


def judge(message: str | None, bonds: Sequence[BondResidual], evidence: Evidence) -> Verdict:
    """The verdict on a run that stopped early with a message, or did not."""
    found: list[tuple[Level, str]] = []
    advice: list[str] = []
    if message is not None:
        found.append((Level.BAD, "the run did not reach its end"))
    if evidence.refinement is not None:
        found += evidence.refinement.judged(SMALL_ERROR, LARGE_ERROR)
    worst = worst_bond(bonds)
    if worst is not None:
        level = Level.GOOD
        text = f"energy residual {worst.relative:.1e}"
        if not worst.relative <= SMALL_RESIDUAL:
            level = Level.DOUBTFUL if worst.relative <= LARGE_RESIDUAL else Level.BAD
            text += f" at {worst.name}, more than {SMALL_RESIDUAL:g}"
        found.append((level, text))
    jumping = max(_carrying(bonds), key=lambda bond: bond.jumps, default=None)
    if jumping is not None and not jumping.jumps <= JUMPING:
        text = f"the force in {jumping.name} jumps to and fro from step to step"
        found.append((Level.BAD, text))
    limit = evidence.limit
    if limit is not None:
        if limit.close:
            level = Level.BAD if limit.share > 1.0 else Level.DOUBTFUL
            found.append(
                (
                    level,
                    f"the step is {limit.share:.2g} of the largest stable one, "
                    f"{limit.largest:.2g} s, by {limit.connection}",
                )
            )
            advice.append(limit.advice)
        elif limit.share > 0.0:
            found.append((Level.GOOD, f"the step is {limit.share:.2g} of the largest stable one"))
        else:
            found.append((Level.GOOD, "no connection limits the step"))
    measured = bool(found)
    coupled = max((level for level, _ in found), key=_ORDER.index, default=Level.UNKNOWN)
    found += _tests(evidence.tests)
    if any(test.errors for test in evidence.tests.values()):
        advice.append("have the FMU mended, or do not rely on what it got wrong")
    if not measured:
        found.append((Level.UNKNOWN, "nothing measures the coupling of this system"))
    level = max((level for level, _ in found), key=_ORDER.index)
    if coupled is not Level.GOOD and not (limit and limit.close) and message is None:
        advice.append(_advice(coupled, evidence))
    found.sort(key=lambda item: -_ORDER.index(item[0]))
    return Verdict(level, tuple(text for _, text in found), tuple(advice))


def worst_bond(bonds: Sequence[BondResidual]) -> BondResidual | None:
    """The bond with the largest relative residual among those that carry energy."""
    return max(_carrying(bonds), key=lambda bond: bond.relative, default=None)


def _carrying(bonds: Sequence[BondResidual]) -> list[BondResidual]:
    busiest = max((bond.passed for bond in bonds), default=0.0)
    return [bond for bond in bonds if not bond.passed <= CARRYING * busiest]


def _tests(tests: Mapping[str, SelfTest]) -> list[tuple[Level, str]]:
    if not tests:
        return []
    wrong: dict[str, list[str]] = {}
    for name, test in tests.items():
        if test.errors:
            wrong.setdefault(f"{test.label}: {test.errors[0].text}", []).append(name)
    if not wrong:
        return [(Level.GOOD, "the FMUs passed their self-test")]
    return [
        (Level.DOUBTFUL, f"the self-test failed for {', '.join(names)} ({text})")
        for text, names in wrong.items()
    ]


def _advice(level: Level, evidence: Evidence) -> str:
    if evidence.refinement is not None:
        return "take a smaller step, or another master"
    if level is Level.UNKNOWN:
        return "verify it: run it again with half the step (--verify does)"
    return "take a smaller step or another master, and verify it (--verify)"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
