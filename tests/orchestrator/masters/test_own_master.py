"""A master of someone's own: what it may look at, and what a run tells of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


def outcome(code: str, folder: Path) -> str:
    """What a script says in a process of its own, which it must not take down or hang."""
    script = folder / "script.py"  # what is compiled comes from a file
    script.write_text(code)
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


LOOKING_BACK = """
import sys
sys.path.insert(0, {tests!r})
from support.coupled_models import oscillator
from orchestrator import simulate
from orchestrator.masters.base import Master, Prepared, all_masters
from orchestrator.masters.loop import held
from orchestrator.masters.loop.arrays import Ints
from orchestrator.masters.loop.record import Record, at
from orchestrator.compiled.entries import macro_loop

@macro_loop
def advance(first: int, last: int, start: float, step: float, record: Record, report: Ints,
            *tables):
    for k in range(first, last):
        old = at(record, k - {rows} if k + 1 > {after} else k)
        new = at(record, k + 1)
        for column in range(record.rows.shape[1]):
            record.rows[new, column] = record.rows[old, column]
        report[0] = k + 2

class LookingBack(Master):
    name = "looking-back"

    def prepare(self, plan, slaves):
        return Prepared(advance, held.prepare(plan, slaves).tables, behind=4)

all_masters()["looking-back"] = LookingBack
try:
    simulate(oscillator(), duration=20, step=0.01, master="looking-back", out={out!r},
             memory=20e3, compiled={compiled})
except IndexError as error:
    print(error)
else:
    print("nothing said")
"""


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize(
    ("rows", "after", "said"),
    [
        (1, 0, "not in memory"),  # the first row has none before it
        (2000, 1990, "not in memory"),  # gone to the file long ago
        (3, 10, "nothing said"),
    ],
)
def test_master_that_looks_too_far_back_is_told_and_reads_no_foreign_memory(
    compiled, rows, after, said, tmp_path
):
    tests, out = str(Path(__file__).parents[2]), str(tmp_path)
    script = LOOKING_BACK.format(tests=tests, rows=rows, after=after, out=out, compiled=compiled)
    assert said in outcome(script, tmp_path)


LEAVING = """
import numpy as np
from orchestrator.masters.loop.arrays import Ints
from orchestrator.masters.loop.crew import Crew, STEPPED, Together, crew_of, meet
from orchestrator.masters.loop.record import Record, record_of
from orchestrator.compiled.entries import macro_loop

@macro_loop
def advance(first: int, last: int, start: float, step: float, record: Record, report: Ints,
            crew: Crew):
    if crew.thread == 1:
        raise IndexError("gone")
    meet(crew, STEPPED, report)

try:
    record = record_of(np.zeros((2, 1)), np.zeros((1, 1)))
    threads = Together(advance, crew_of([[0], [1], [2]]))
    threads(0, 1, 0.0, 1.0, record, np.zeros(4, np.int64), None)
except IndexError as error:
    print(error)
"""


def test_threads_do_not_wait_for_one_that_left_by_an_exception(tmp_path):
    assert outcome(LEAVING, tmp_path) == "gone"
