"""The verdict on a run: its level, why, and what to do."""

from __future__ import annotations

import pytest

from orchestrator import BondResidual
from orchestrator.trust.findings import Error, Evidence, Finding, Refinement, SelfTest, StepLimit
from orchestrator.trust.verdict import judge

PASSED = {"a": SelfTest("a.fmu", ("rollback",))}
QUIET = [BondResidual("a.force * b.v", 1.0, 1e-6)]


def test_a_sound_run_is_good():
    verdict = judge(None, QUIET, Evidence(PASSED, StepLimit(1e-3, 1e-2, "a.force -> b.force")))
    assert str(verdict) == (
        "Coupling: good. Energy residual 1.0e-06; the step is 0.1 of the largest stable one; the "
        "FMUs passed their self-test."
    )


@pytest.mark.parametrize(
    ("residual", "level"), [(2e-4, "good"), (5e-4, "doubtful"), (0.5, "bad"), (float("nan"), "bad")]
)
def test_residual_decides_the_level(residual, level):
    assert judge(None, [BondResidual("b", 1.0, residual)], Evidence()).level.value == level


def test_an_error_that_was_measured_tells_more_than_a_residual():
    found = Refinement(1e-3, (Error("b.y", 1e-3, 2e-3, 2.0),))
    bonds = [BondResidual("b", 1.0, 5e-4)]
    assert judge(None, bonds, Evidence(refinement=found)).level.value == "good"
    bonds = [BondResidual("b", 1.0, 0.5)]
    assert judge(None, bonds, Evidence(refinement=found)).level.value == "bad"


def test_a_bond_that_carries_rounding_does_not_count():
    bonds = [*QUIET, BondResidual("idle", 1e-12, 1e-12, jumps=1.0)]
    assert judge(None, bonds, Evidence()).level.value == "good"
    at_rest = [BondResidual(name, 1e-20, 1e-20, jumps=1.0) for name in ("one", "other")]
    assert judge(None, at_rest, Evidence(PASSED)).level.value == "unknown"


@pytest.mark.parametrize(("step", "level"), [(4e-3, "good"), (6e-3, "doubtful"), (11e-3, "bad")])
def test_share_of_the_stable_step_decides_the_level(step, level):
    verdict = judge(None, QUIET, Evidence(limit=StepLimit(step, 1e-2, "a.force -> b.force")))
    assert verdict.level.value == level
    assert bool(verdict.advice) is (level != "good")


def test_without_a_measure_nothing_is_known_and_the_advice_is_to_verify():
    assert str(judge(None, [], Evidence(PASSED))) == (
        "Coupling: unknown. Nothing measures the coupling of this system; the FMUs passed their "
        "self-test. Verify it: run it again with half the step."
    )


@pytest.mark.parametrize(
    ("evidence", "text", "ways"),
    [
        (Evidence(), "verify it: run it again with half the step", ({"verify": ""},)),
        (
            Evidence(limit=StepLimit(1e-3, 1e-2, "a.force -> b.force")),
            "take a smaller step, and verify it",
            ({"step": "0.5ms", "verify": ""},),
        ),
        (
            Evidence(refinement=Refinement(1e-3, (Error("b.y", 0.5, 1.0, 2.0),))),
            "take a smaller step",
            ({"step": "0.5ms"},),
        ),
    ],
    ids=["nothing known", "a residual", "an error"],
)
def test_advice_has_the_settings_that_do_it(evidence, text, ways):
    measured = evidence.limit or evidence.refinement
    (advice,) = judge(None, [BondResidual("b", 1.0, 0.5)] if measured else [], evidence).advice
    assert (advice, advice.ways) == (text, ways)


def test_an_fmu_that_lies_makes_doubt_and_is_named():
    lying = SelfTest("b.fmu", (), (Finding("rollback", "a saved state forgets y"),))
    verdict = judge(None, QUIET, Evidence({**PASSED, "b": lying}))
    assert str(verdict) == (
        "Coupling: doubtful. The self-test failed for b (b.fmu: a saved state forgets y); energy "
        "residual 1.0e-06. Have the FMU mended, or do not rely on what it got wrong."
    )


def test_a_run_that_stopped_is_bad():
    assert judge("it crashed", QUIET, Evidence()).level.value == "bad"


@pytest.mark.parametrize(("rms", "level"), [(0.003, "good"), (0.05, "doubtful"), (0.5, "bad")])
def test_estimated_error_decides_the_level(rms, level):
    found = Refinement(1e-3, (Error("b.y", rms, 2.0 * rms, 2.0),))
    verdict = judge(None, QUIET, Evidence(refinement=found))
    assert verdict.level.value == level
    assert f"rror of b.y about {100 * rms:.2g} % of its rms (order 2.0)" in str(verdict)
