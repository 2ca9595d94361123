"""One verdict on a run, in plain words: a level, why, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..results.energy import BondResidual

if TYPE_CHECKING:
    from .findings import SelfTest
from .findings import Evidence, Level, Verdict

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
