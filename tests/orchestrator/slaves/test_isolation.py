"""An FMU in a process of its own may crash, hang or babble: the run ends, and keeps what it has."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import orchestrator
from orchestrator import Component, OrchestratorError, System, resume, simulate
from orchestrator.masters.base import all_masters
from support.coupled_models import oscillator
from support.mishap import PORTS, mishap, system
from support.native_slaves import description
from support.python_process import TESTS
from support.wheelset_on_truck import interrupted_at, wheelset_on_truck

pytestmark = pytest.mark.skipif(os.name != "posix", reason="isolation needs Linux or macOS")


@pytest.fixture(scope="module")
def fmu(tmp_path_factory) -> Path:
    return mishap(tmp_path_factory.mktemp("mishap"))


@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
@pytest.mark.parametrize(
    ("kind", "fault"),
    [
        (
            "crash",
            "its process crashed in fmi2DoStep (SIGSEGV: segmentation fault) in the step from "
            "t = 0.05 s: it printed 'last words'",
        ),
        (
            "abort",
            "its process crashed in fmi2DoStep (SIGABRT: aborted) in the step from t = 0.05 s",
        ),
        (
            "hang",
            "its process did not return from fmi2DoStep within 0.5 s in the step from t = 0.05 s",
        ),
        (
            "exit",
            "its process crashed in fmi2DoStep (it exited with code 3) in the step from t = 0.05 s",
        ),
        (
            "endless",
            "its process did not return from fmi2DoStep within 0.5 s in the step from t = 0.05 s: "
            "it printed 'bottles of beer'",
        ),
    ],
)
def test_mishap_ends_the_run_and_keeps_what_came_before(tmp_path, fmu, kind, fault, compiled):
    run = simulate(
        system(fmu, kind), duration=1, step=0.01, isolate=["odd"], timeout=0.5, out=tmp_path,
        compiled=compiled,
    )  # fmt: skip
    assert run.message == f"odd: {fault}"
    assert run.dataset.attrs["stopped"] == run.message
    np.testing.assert_allclose(run.dataset["odd.y"], 0.01 * np.arange(6), atol=1e-12)


def test_babble_is_bounded_and_harms_nothing(fmu):
    """100 kB in every step, of which the pipe alone would hold two thirds."""
    run = simulate(system(fmu, "babble"), duration=0.2, step=0.01, isolate=["odd"])
    assert run.completed and len(run.time) == 21


def test_messages_arrive_from_the_other_process(fmu):
    logged = []
    run = simulate(
        system(fmu, "log", 0.085), duration=0.1, step=0.01, isolate=["odd"],
        logger=lambda *said: logged.append(said),
    )  # fmt: skip
    assert "odd says: warm" in run.notes
    assert logged == [("odd", "warning", "warm")] * 3


def refusal(*arguments, **options) -> str:
    with pytest.raises(OrchestratorError) as caught:
        simulate(*arguments, duration=1.0, step=0.1, **options)
    return str(caught.value)


@pytest.mark.parametrize("isolate", [[], ["odd"]], ids=["here", "isolated"])
def test_escape_sequences_of_a_log_are_shown_and_not_obeyed(tmp_path, fmu, isolate):
    logged = []
    run = simulate(
        system(fmu, "escape", 0.085), duration=0.1, step=0.01, isolate=isolate, compiled=False,
        logger=lambda *said: logged.append(said),
    )  # fmt: skip
    assert run.completed
    assert {*logged} == {("odd", "warning", r"\x1b[31mred\x1b[0m next")}


def test_garbage_in_the_log_of_an_isolated_fmu_is_no_message(fmu):
    logged = []
    run = simulate(
        system(fmu, "garbage"), duration=0.1, step=0.01, isolate=["odd"], compiled=False,
        logger=lambda *said: logged.append(said),
    )  # fmt: skip
    assert run.completed and logged == []


def test_fmu_that_cannot_be_loaded_in_time(tmp_path):
    said = refusal(system(mishap(tmp_path, "-DHANG_ON_LOAD"), "none"), isolate=["odd"], timeout=1.0)
    assert said == "odd (mishap.fmu): its process did not return from loading it within 1 s"


def gone(process: int) -> bool:
    """Whether a process ends within 60 s: it does at once, unless the machine is busy."""
    until = time.monotonic() + 60.0
    while Path(f"/proc/{process}").exists() and time.monotonic() < until:
        time.sleep(0.05)
    return not Path(f"/proc/{process}").exists()


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
def test_processes_that_an_fmu_started_end_with_the_run(tmp_path, monkeypatch):
    left = tmp_path / "left"
    monkeypatch.setenv("MISHAP", str(left))
    forking = mishap(tmp_path, "-DFORK_ON_LOAD")
    simulate(system(forking, "none"), duration=0.1, step=0.1, isolate=["odd"], compiled=False)
    assert gone(int(left.read_text()))


def test_crash_while_the_fmu_is_loaded(tmp_path):
    said = refusal(system(mishap(tmp_path, "-DON_LOAD"), "none"), isolate=["odd"])
    assert said == (
        "odd (mishap.fmu): its process crashed in loading it (SIGSEGV: segmentation fault): it "
        "printed 'no way in'"
    )


def test_instance_that_cannot_be_isolated(fmu):
    assert refusal(system(fmu, "none"), isolate=["old"]) == (
        "there is no instance 'old' to isolate; did you mean odd? choose one of: odd"
    )
    assert refusal(oscillator(), isolate=["one"]) == (
        "one cannot be isolated: it is a mock, not an FMU"
    )


def test_instances_that_need_a_process_each_are_isolated(tmp_path):
    alone = '<CoSimulation canBeInstantiatedOnlyOncePerProcess="true"'
    path = mishap(tmp_path, text=description(PORTS).replace("<CoSimulation", alone))
    three = System({name: Component(path, {"at": 9.0}) for name in "abc"})
    assert "isolate all but one" in refusal(three, isolate=["a"])
    run = simulate(three, duration=0.1, step=0.1, isolate=["a", "b"], compiled=False)
    assert [float(run.dataset[f"{n}.y"][-1]) for n in "abc"] == [0.1] * 3


@pytest.mark.parametrize("master", all_masters())
@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
def test_isolation_changes_no_bit(master, compiled):
    """Inputs, input derivatives, tangents and a value that an FMU refuses go through it."""
    options = {"duration": 0.2, "step": 1e-3, "master": master, "compiled": compiled}
    whole = simulate(wheelset_on_truck(), **options)
    apart = simulate(wheelset_on_truck(), **options, isolate=["track", "wheelset", "truck"])
    assert np.array_equal(apart.record, whole.record)
    assert apart.bonds == whole.bonds and apart.notes == whole.notes


def test_isolated_run_goes_on_from_a_checkpoint(tmp_path):
    options = {"duration": 1.0, "step": 1e-3}
    whole = simulate(wheelset_on_truck(), **options)
    simulate(
        wheelset_on_truck(), **options, out=tmp_path, checkpoint=0.1, isolate=["truck"],
        progress=interrupted_at(0.4),
    )  # fmt: skip
    assert np.array_equal(resume(tmp_path).record, whole.record)


PARENT = """
import sys
sys.path[:0] = [{tests!r}]
from pathlib import Path
from support.mishap import system
from orchestrator import simulate
def progress(t, wall):
    print(t, flush=True)
simulate(system(Path({fmu!r}), {kind!r}), duration=1e6, step=0.01, {how},
         timeout=1e6, progress=progress, out={out!r}, compiled=False)
"""


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
@pytest.mark.parametrize("kind", ["none", "hang", "loading", "self-test"])
def test_worker_dies_with_its_parent_even_when_that_is_killed(tmp_path, fmu, kind):
    how = 'isolate=["odd"]'
    if kind in ("loading", "self-test"):
        how = how if kind == "loading" else "self_test=True"
        fmu, kind = mishap(tmp_path, "-DHANG_ON_LOAD"), "hang"
    code = PARENT.format(tests=TESTS, fmu=str(fmu), out=str(tmp_path), kind=kind, how=how)
    parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert parent.stdout is not None
    if kind == "none":
        assert parent.stdout.readline()

    def workers() -> list[int]:
        found = []
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                command = (entry / "cmdline").read_text(errors="replace")
            except OSError:
                continue
            # a process has children for a moment, too, that are no workers
            ours = any(f"orchestrator.{m}" in command for m in ("slaves.isolated", "trust"))
            if int(fields[1]) == parent.pid and ours:
                found.append(int(entry.name))
        return found

    while not (found := workers()):
        assert parent.poll() is None
        time.sleep(0.05)
    (worker,) = found
    if kind == "hang":
        time.sleep(2.0)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    assert gone(worker)


def test_compiled_code_that_is_kept_follows_the_constants_of_other_modules(fmu, tmp_path):
    """A slot of the shared memory moves in a copy of the package: the next run knows."""
    package = tmp_path / "orchestrator"
    shutil.copytree(
        Path(orchestrator.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__")
    )
    code = (
        "from pathlib import Path\n"
        "from orchestrator import Component, System, simulate\n"
        f"system = System({{'odd': Component(Path({str(fmu)!r}), {{'at': 9.0}})}})\n"
        "run = simulate(system, duration=0.03, step=0.01, isolate=['odd'], self_test=False,\n"
        "               compiled=False)\n"
        "print(run.message, *run.dataset['odd.y'].values)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}

    def run() -> str:
        done = subprocess.run(
            [sys.executable, "-c", code], env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    before = run()
    assert before.startswith("None ")
    said = package / "slaves" / "isolated" / "protocol.py"
    text = said.read_text()
    moved = text.replace("\nHEAD = 16\n", "\nHEAD = 24\n").replace(
        "FAILED, STATUS, FAILED_CALL, USED,", "FAILED, USED, FAILED_CALL, STATUS,"
    )
    assert moved != text
    said.write_text(moved)
    assert run() == before
