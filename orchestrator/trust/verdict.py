"""One verdict on a run, in plain words: a level, why, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..notes import Advice
from ..results.energy import BondResidual
from .findings import Evidence, Level, Refinement, SelfTest, StepLimit, Verdict, step_text

FIRST_ORDER = 1.5
"""Observed order below which an error is as of inputs that are held over a step."""

SMALL_RESIDUAL = 3e-4
"""Energy residual of a bond below which the coupling does no harm. The hopper car at 1 ms: loaded
it has 5e-5 to 2e-4, and wheel loads within 1 %; empty, whose body swings faster on its plates, 5e-4
to 1e-3, wheel loads 2 to 4 % and vertical accelerations up to 17 % wrong."""

LARGE_RESIDUAL = 0.1
"""Energy residual above which the coupling makes up a good part of the motion."""

CARRYING = 1e-6
"""Share of the energy through the busiest bond below which a bond carries nothing but rounding."""

SMALL_ERROR, LARGE_ERROR = 0.01, 0.2
"""Estimated error of an output over its rms: what engineering takes, and what it cannot use."""

JUMPING = 0.5
"""Change of a force from step to step over twice its size, above which it jumps to and fro."""

NOTHING = 1e-15
"""Energy [J] up to which nothing passed: what rounding leaves in a system that is at rest."""

_ORDER = [Level.GOOD, Level.UNKNOWN, Level.DOUBTFUL, Level.BAD]

Said = tuple[Level, str]
"""A reason, and the level that it stands for."""


def judge(message: str | None, bonds: Sequence[BondResidual], evidence: Evidence) -> Verdict:
    """The verdict on a run that stopped early with a message, or did not."""
    limit, tested = evidence.limit, _tests(evidence.tests)
    errors = _refinement(evidence.refinement)
    measured = [
        *errors,
        *_energy(bonds, LARGE_RESIDUAL if errors else SMALL_RESIDUAL),
        *_limit(limit),
    ]
    if message is not None:
        measured.insert(0, (Level.BAD, "the run did not reach its end"))
    coupled = max((level for level, _ in measured), key=_ORDER.index, default=Level.UNKNOWN)
    found = [*measured, *tested]
    if not measured:
        found.append((Level.UNKNOWN, "nothing measures the coupling of this system"))
    advice: list[str] = [limit.advice] if limit is not None and limit.close else []
    if any(test.errors for test in evidence.tests.values()):
        advice.append("have the FMU mended, or do not rely on what it got wrong")
    if coupled is not Level.GOOD and not (limit and limit.close) and message is None:
        advice.append(_advice(coupled, evidence))
    found.sort(key=lambda item: -_ORDER.index(item[0]))
    return Verdict(found[0][0], tuple(text for _, text in found), tuple(advice))


def _energy(bonds: Sequence[BondResidual], small: float) -> list[Said]:
    """What the power bonds show. small: residual that does no harm; errors that were measured tell
    more than a residual does."""
    found = []
    if worst := worst_bond(bonds):
        level, text = _level(worst.relative, small, LARGE_RESIDUAL), ""
        if level is not Level.GOOD:
            text = f" at {worst.name}, more than {small:g}"
        found.append((level, f"energy residual {worst.relative:.1e}{text}"))
    jumping = max(_carrying(bonds), key=lambda bond: bond.jumps, default=None)
    if jumping is not None and not jumping.jumps <= JUMPING:
        text = f"the force in {jumping.name} jumps to and fro from step to step"
        found.append((Level.BAD, text))
    return found


def _limit(limit: StepLimit | None) -> list[Said]:
    """What the step over the largest stable one means."""
    if limit is None:
        return []
    if limit.close:
        text = (
            f"the step is {limit.share:.2g} of the largest stable one, {limit.largest:.2g} s, by "
            f"{limit.connection}"
        )
        return [(Level.BAD if limit.share > 1.0 else Level.DOUBTFUL, text)]
    if limit.share > 0.0:
        return [(Level.GOOD, f"the step is {limit.share:.2g} of the largest stable one")]
    return [(Level.GOOD, "no connection limits the step")]


def _refinement(refinement: Refinement | None) -> list[Said]:
    """What smaller steps and the monolithic twin mean."""
    if refinement is None:
        return []
    found = []
    if worst := refinement.worst:
        text = f"error of {worst.name} about {_percent(worst.rms)} of its rms"
        if worst.converges and worst.order > 0.0:
            text += f" (order {worst.order:.1f})"
        found.append((_level(worst.rms, SMALL_ERROR, LARGE_ERROR), text))
    erring = [e for e in refinement.errors if not e.converges and e.rms > SMALL_ERROR]
    if erring:
        names = ", ".join(e.name for e in erring[:3]) + (" ..." if erring[3:] else "")
        text = (
            f"smaller steps do not converge (no order observed) in {names}: the motion is chaotic "
            "or sticks and slips at other times, and only its statistics can be relied on"
        )
        found.append((Level.DOUBTFUL, text))
    if refinement.twin:
        worst = max(refinement.twin, key=lambda error: error.rms)
        text = (
            f"{_percent(worst.rms)} at most from the monolithic twin ({worst.name}, first "
            f"{refinement.twin_span:g} s)"
        )
        found.append((_level(worst.rms, SMALL_ERROR, LARGE_ERROR), text))
    return found


def _level(share: float, small: float, large: float) -> Level:
    """What an error means; one that is no number is bad."""
    if share <= small:
        return Level.GOOD
    return Level.DOUBTFUL if share <= large else Level.BAD


def _percent(share: float) -> str:
    """A share in words: 0.0031 is "0.31 %"."""
    return f"{100.0 * share:.2g} %"


def worst_bond(bonds: Sequence[BondResidual]) -> BondResidual | None:
    """The bond with the largest relative residual among those that carry energy."""
    return max(_carrying(bonds), key=lambda bond: bond.relative, default=None)


def _carrying(bonds: Sequence[BondResidual]) -> list[BondResidual]:
    busiest = max((bond.passed for bond in bonds), default=0.0)
    return [bond for bond in bonds if not bond.passed <= max(CARRYING * busiest, NOTHING)]


def _tests(tests: Mapping[str, SelfTest]) -> list[tuple[Level, str]]:
    if not tests:
        return []
    wrong: dict[str, list[str]] = {}
    for name, test in tests.items():
        if test.errors:
            wrong.setdefault(f"{test.label}: {test.errors[0].text}", []).append(name)
    untested = [name for name, test in tests.items() if test.untested and not test.errors]
    if not wrong and not untested:
        return [(Level.GOOD, "the FMUs passed their self-test")]
    if not wrong:
        return [(Level.UNKNOWN, f"the self-test could not be done for {', '.join(untested)}")]
    return [
        (Level.DOUBTFUL, f"the self-test failed for {', '.join(names)} ({text})")
        for text, names in wrong.items()
    ]


def _advice(level: Level, evidence: Evidence) -> Advice:
    if level is Level.UNKNOWN and evidence.refinement is None:
        return Advice("verify it: run it again with half the step", {"verify": ""})
    known = evidence.refinement or evidence.limit
    half = {"step": step_text(known.step / 2) if known else ""}
    if evidence.refinement is not None:
        worst = evidence.refinement.worst
        if worst is not None and worst.order < FIRST_ORDER:
            return Advice("take a smaller step, or another master", half, {"master": ""})
        return Advice("take a smaller step", half)
    return Advice("take a smaller step, and verify it", half | {"verify": ""})
