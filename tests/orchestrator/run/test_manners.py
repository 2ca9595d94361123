"""What FMUs return, end and change behind one's back: said with their name, and nothing is lost."""

from __future__ import annotations

import ctypes
import locale
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from orchestrator import (
    Component,
    Connection,
    OrchestratorError,
    System,
    ends_when_asked,
    simulate,
)
from orchestrator.slaves import departure
from orchestrator.slaves.departure import departing
from orchestrator.trust.self_test import self_test
from support.manners import EXPERIMENT, manners
from support.mishap import mishap
from support.python_process import TESTS

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the tests' own FMUs need a compiler")

STEPS = {"duration": 1.0, "step": 0.1}


def alone(component: Component) -> System:
    return System({"odd": component})


def refusal(component: Component, **given) -> str:
    with pytest.raises(OrchestratorError) as caught:
        simulate(alone(component), **STEPS, **given)
    return str(caught.value)


@pytest.mark.parametrize("apart", [False, True], ids=["here", "apart"])
@pytest.mark.parametrize(
    ("status", "said"),
    [
        (77, "returned 77, which is no status of FMI"),
        (-3, "returned -3, which is no status of FMI"),
        (5, "returned pending"),
    ],
)
def test_a_status_that_is_none_ends_the_run_and_keeps_its_rows(tmp_path, status, said, apart):
    odd = alone(manners(tmp_path, "STATUS", at=0.4, answer=float(status)))
    run = simulate(odd, **STEPS, isolate=("odd",) if apart else ())
    assert run.message == f"odd: fmi2DoStep {said} in the step from t = 0.4 s"
    assert run.time.size == 5


@pytest.mark.parametrize("manner", ["DEAF", "BAD_START", "BAD_READ"])
def test_a_status_that_is_none_counts_in_every_call(tmp_path, manner):
    function = {
        "DEAF": "fmi2SetReal",
        "BAD_START": "fmi2EnterInitializationMode",
        "BAD_READ": "fmi2GetReal",
    }[manner]
    said = refusal(manners(tmp_path, manner, answer=-3.0))
    assert f"{function} returned -3, which is no status of FMI" in said
    assert "odd" in said


def test_an_error_before_the_first_step_says_which_call_failed(tmp_path):
    assert refusal(manners(tmp_path, "BAD_READ", answer=3.0)) == (
        "odd (bad_read.fmu): fmi2GetReal returned error before the first step"
    )


@pytest.mark.parametrize("apart", [False, True], ids=["here", "apart"])
def test_an_end_of_the_fmus_own_choosing_has_its_time_and_its_last_row(tmp_path, apart):
    odd = alone(manners(tmp_path, "END", at=0.45))
    run = simulate(odd, **STEPS, isolate=("odd",) if apart else ())
    assert run.message == "odd asks to end the run at t = 0.6 s"
    np.testing.assert_allclose(run.dataset["odd.y"], np.arange(7) * 0.1)


def test_an_fmu_that_refuses_to_log_runs_all_the_same(tmp_path):
    run = simulate(alone(manners(tmp_path, "NO_LOG")), **STEPS)
    assert run.completed
    assert "odd says: it refused the log categories logStatusError: fmi2SetDebugLogging returned " \
        "error" in run.notes  # fmt: skip


def test_the_tolerance_is_the_default_experiments_or_the_users(tmp_path):
    def told(system: System, **given) -> float:
        return float(simulate(system, **STEPS, **given).dataset["odd.tolerance"][0])

    assert told(alone(manners(tmp_path, "NONE"))) == -1.0
    asking = alone(manners(tmp_path, "NONE", EXPERIMENT))
    assert told(asking) == 1e-7
    assert told(asking, fmu_tolerance=1e-3) == 1e-3
    assert told(asking, fmu_tolerance=1e-3, isolate=("odd",)) == 1e-3
    with pytest.raises(OrchestratorError, match="fmu_tolerance cannot be -1: it must be above 0"):
        simulate(asking, **STEPS, fmu_tolerance=-1.0)


def test_inputs_that_cannot_be_read_back_are_what_they_were_given(tmp_path):
    run = simulate(alone(manners(tmp_path, "WRITE_ONLY", u=3.0)), **STEPS)
    assert run.dataset["odd.u"].values.tolist() == [3.0] * 11
    assert run.dataset["odd.y"][-1] == pytest.approx(3.0)


def test_local_variables_are_recorded_when_asked_for_by_name(tmp_path):
    odd = alone(manners(tmp_path, "NONE"))
    assert "odd.twice" not in simulate(odd, **STEPS).dataset
    run = simulate(odd, **STEPS, record=["odd.y", "odd.twi*"])
    np.testing.assert_array_equal(run.dataset["odd.twice"], 2.0 * run.dataset["odd.y"])


def follower(folder: Path) -> System:
    """The FMU behind a clock of its own kind: its input is a ramp."""
    fmu = manners(folder, "LATE")
    source = manners(folder, "NONE")
    return System({"ramp": source, "odd": fmu}, (Connection("ramp.y", "odd.u"),))


@pytest.mark.parametrize("master", ["one-pass", "jacobi", "gauss-seidel", "iterated"])
def test_an_fmu_that_must_step_before_it_is_read_is_found_out_and_run(tmp_path, master):
    """Its output that follows the input at once is a step late, and this is said."""
    run = simulate(follower(tmp_path), **STEPS, master=master, self_test=True)
    assert run.completed
    note = next(note for note in run.notes if note.startswith("odd (late.fmu) forbids reading"))
    assert "late by a macro step is what follows inputs at once (now)" in note
    ramp, now = run.dataset["ramp.y"].values, run.dataset["odd.now"].values
    assert np.all(np.abs(now - ramp) <= 0.1 + 1e-12)


def test_without_a_self_test_the_error_names_the_call(tmp_path):
    with pytest.raises(
        OrchestratorError, match=r"odd \(late.fmu\): fmi2GetReal returned error before"
    ):
        simulate(follower(tmp_path), **STEPS)


def test_nothing_tested_is_not_passed(tmp_path):
    found = self_test(manners(tmp_path, "NO_INSTANCE"))
    assert found.passed == ()
    assert [f.text for f in found.errors] == ["tested: no_instance.fmu cannot be instantiated"]


def test_a_step_that_fails_leaves_checks_untested(tmp_path):
    found = self_test(manners(tmp_path, "STATUS", at=0.0, answer=3.0))
    assert not found.errors
    assert {f.check for f in found.untested} >= {"determinism", "reading"}


SURROUNDINGS = (
    "the rounding mode (up), the locale (C), handlers of signals (SIGTERM), the working folder "
    "(/), the permissions of new files"
)


@pytest.mark.parametrize("master", ["jacobi", "gauss-seidel"])
def test_what_an_fmu_changes_around_it_is_put_back_and_said_with_its_name(tmp_path, master):
    folder, mask = Path.cwd(), os.umask(0o022)
    os.umask(mask)
    handler = signal.getsignal(signal.SIGTERM)
    before = locale.setlocale(locale.LC_ALL)
    odd, even = manners(tmp_path, "CHANGE", at=0.3), manners(tmp_path, "NONE")
    system = System({"even": even, "odd": odd}, (Connection("even.y", "odd.u"),))
    run = simulate(system, duration=1.0, step=1e-3, master=master)
    note = next(note for note in run.notes if "for the whole program" in note)
    assert note.startswith(f"odd (change.fmu) changed {SURROUNDINGS} for the whole program")
    assert (Path.cwd(), locale.setlocale(locale.LC_ALL)) == (folder, before)
    assert os.umask(mask) == mask
    assert ctypes.CDLL("libm.so.6").fegetround() == 0
    signal.raise_signal(signal.SIGURG)
    assert signal.getsignal(signal.SIGTERM) == handler
    assert any("changes the rounding mode" in f.text for f in self_test(odd).errors) is False
    found = self_test(manners(tmp_path, "CHANGE", at=0.0))
    assert any("it changes the rounding mode (up)" in f.text for f in found.errors)


PROGRAM = """
import sys
import time
from pathlib import Path
from orchestrator import Component, System, simulate
fmu, out = map(Path, sys.argv[1:3])
system = System({"odd": Component(fmu, {"at": float(sys.argv[3]), "answer": 0.0})})
simulate(system, duration=1.0, step=0.1, out=out, master="jacobi")
print("never said")
"""


def program(fmu: Path, out: Path, at: float) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", PROGRAM, str(fmu), str(out), str(at)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


def test_an_fmu_that_ends_the_program_is_named_and_the_rows_are_kept(tmp_path):
    from tracktrain.results import opened

    fmu, out = manners(tmp_path, "LEAVE").file, tmp_path / "out"
    done = program(fmu, out, 0.5)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.strip() == (
        "Error: odd (leave.fmu) ended the program by C's exit() in the step from t = 0.5 s; what "
        f"was computed until then is in {out}; apart, in a process of its own, it would end the "
        "run alone: isolate odd"
    )
    assert opened(out).sizes["time"] == 6


def test_an_fmu_that_ends_the_program_while_it_is_loaded_is_named(tmp_path):
    done = program(manners(tmp_path, "LOAD").file, tmp_path / "out", 0.5)
    assert done.returncode == 1
    assert "odd (load.fmu) ended the program by C's exit() while it was loaded" in done.stderr


HANGING = """
import os, signal, sys, threading
from pathlib import Path
from orchestrator import ends_when_asked, simulate
from orchestrator.slaves import departure
from support.mishap import system
fmu, out, apart = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:]
departure.PATIENCE = 0.5
signal.signal(signal.SIGINT, signal.default_int_handler)
pressed = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
with ends_when_asked():
    simulate(
        system(fmu, "hang", 0.495), duration=1.0, step=0.01, out=out, isolate=apart, timeout=1e6,
        progress=lambda *_: pressed.is_alive() or pressed.start(),
    )
"""


@pytest.mark.parametrize("apart", [[], ["odd"]], ids=["here", "apart"])
def test_ctrl_c_ends_the_program_while_an_fmu_does_not_return_and_keeps_the_rows(tmp_path, apart):
    from tracktrain.results import opened

    fmu, out = mishap(tmp_path), tmp_path / "out"
    done = subprocess.run(
        [sys.executable, "-c", HANGING, str(fmu), str(out), *apart],
        env={**os.environ, "PYTHONPATH": os.pathsep.join((*sys.path, TESTS))},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 1
    assert done.stderr.strip() == (
        "Error: odd (mishap.fmu) did not return when the program was to end in the step from "
        f"t = 0.5 s; what was computed until then is in {out}; an FMU that is isolated ends the "
        "run alone after the timeout"
    )
    np.testing.assert_allclose(opened(out)["odd.y"], 0.01 * np.arange(51), atol=1e-12)


def test_ctrl_c_that_is_heard_ends_no_program(monkeypatch):
    monkeypatch.setattr(departure, "PATIENCE", 0.1)
    with ends_when_asked():
        with pytest.raises(KeyboardInterrupt), departing(lambda did: "never said"):
            signal.raise_signal(signal.SIGINT)
        time.sleep(0.3)
