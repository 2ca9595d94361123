"""How good an answer is: what is known before a run, what it shows, and what repeating it shows.

`self_test` finds out whether an FMU does what it says (on a `probe`, remembered by `tested`),
`step_limit` predicts the largest stable macro step, `refinement` repeats a run with smaller steps
and as one system, and `verdict` says it all in one sentence. See docs/trust.md.
"""

from __future__ import annotations

from .findings import (
    CHECKS,
    Evidence,
    Finding,
    Level,
    SelfTest,
    Verdict,
)
from .tested import self_tests

__all__ = ["CHECKS", "Evidence", "Finding", "Level", "SelfTest", "Verdict", "self_tests"]
