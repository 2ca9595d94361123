"""What FMUs say: at its simulated time, filtered, and never without end."""

from __future__ import annotations

import io

import pytest

from orchestrator import Log, OrchestratorError, simulate
from orchestrator.run import log
from support.mishap import mishap, system


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    return mishap(tmp_path_factory.mktemp("mishap"))


@pytest.mark.parametrize("isolate", [(), ("odd",)], ids=["here", "apart"])
def test_message_stands_at_its_simulated_time(tmp_path, fmu, isolate):
    path = tmp_path / "run.log"
    with Log(path) as logger:
        run = simulate(
            system(fmu, "log", 0.085), duration=0.11, step=0.01, logger=logger, isolate=isolate
        )
    assert run.completed
    assert path.read_text().splitlines() == [
        f"{time:.6f} s  odd  warning: warm" for time in (0.09, 0.1) for _ in range(3)
    ]


def test_level_lets_through_what_is_worse_only(fmu):
    stream = io.StringIO()
    simulate(system(fmu, "log"), duration=0.1, step=0.01, logger=Log(stream, "error"))
    assert stream.getvalue() == ""
    with pytest.raises(OrchestratorError) as caught:
        Log(stream, "warnings")
    assert str(caught.value) == (
        "there is no log level 'warnings'; did you mean warning? choose one of: all, warning, error"
    )


def test_repeated_message_is_counted(fmu):
    stream = io.StringIO()
    with Log(stream) as logger:
        simulate(system(fmu, "log", -1.0), duration=1.0, step=0.01, logger=logger)
    *lines, last = stream.getvalue().splitlines()
    assert len(lines) == log.REPEATS
    assert last == "odd said 290 times more: warm"


def test_instance_that_never_says_the_same_is_bounded(monkeypatch):
    monkeypatch.setattr(log, "LINES", 100)
    stream = io.StringIO()
    with Log(stream) as logger:
        for n in range(1000):
            logger.write("odd", 1, f"warm by {n} K", 0.0)
    *lines, last = stream.getvalue().splitlines()
    assert len(lines) == 100
    assert last == "odd said 900 more, which was left out"


def test_file_that_cannot_be_written(tmp_path):
    with pytest.raises(OrchestratorError) as caught:
        Log(tmp_path / "no" / "run.log")
    assert str(caught.value) == (
        f"'{tmp_path / 'no' / 'run.log'}' cannot be written to: no such file or directory; "
        "name another file"
    )
