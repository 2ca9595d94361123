"""A run that stops early says who, what and when, and keeps everything up to there."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest

from orchestrator import (
    Component,
    Connection,
    InlineModel,
    OrchestratorError,
    System,
    simulate,
)


def counter(fail=lambda time: None, output=lambda x: x) -> System:
    """Shows the time; `fail` is called at each step's start."""

    def step(x, u, rate, p, time, step):
        fail(time)
        return time + step

    slave = InlineModel(
        outputs={"y": "s"},
        initial=lambda p: 0.0,
        step=step,
        output=lambda x, u, p: {"y": output(x)},
    )
    reader = InlineModel(inputs={"u": "s"}, outputs={"y": "s"}, depends={"y": ("u",)},
                  output=lambda x, u, p: {"y": u["u"]})  # fmt: skip
    return System(
        {"clock": Component(slave), "reader": Component(reader)},
        (Connection("clock.y", "reader.u"),),
    )


@pytest.fixture(params=["one-pass", "jacobi"])
def master(request):
    return request.param


@pytest.fixture(params=[True, False], ids=["compiled", "python"])
def options(request, master):
    return {"duration": 1.0, "step": 0.01, "master": master, "compiled": request.param}


def assert_kept_until(run, time):
    assert not run.completed
    assert run.dataset["clock.y"].values[-1] == pytest.approx(time)
    assert run.dataset["reader.y"].values[-1] == pytest.approx(time)
    assert run.dataset.sizes["time"] == round(time / 0.01) + 1
    assert np.isfinite(run.record).all()


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_value_that_is_not_finite(options, value):
    run = simulate(counter(output=lambda x: value if x > 0.305 else x), **options)
    assert run.message == f"clock.y is {value} at t = 0.31 s"
    assert_kept_until(run, 0.30)


def test_exception_in_a_slave(options):
    def fail(time):
        if time > 0.305:
            raise ZeroDivisionError("no load on the wheel")

    run = simulate(counter(fail), **options)
    line = fail.__code__.co_firstlineno + 2
    assert run.message == (
        "clock: fmi2DoStep returned error in the step from t = 0.31 s: "
        f"ZeroDivisionError: no load on the wheel (test_stops.py, line {line}, in fail)"
    )
    assert_kept_until(run, 0.31)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "ValueError: output gives no 'y'"),
        ({"y": "fast"}, "ValueError: could not convert string to float: 'fast'"),
        ({"y": None}, "ValueError: output gives None for 'y', no number"),
    ],
)
def test_what_a_model_does_not_give_is_named(given, said):
    model = InlineModel(outputs={"y": "m"}, output=lambda x, u, p: given)
    with pytest.raises(OrchestratorError) as caught:
        simulate(System({"m": Component(model)}), duration=1.0, step=0.1)
    assert said in str(caught.value)


def test_interrupt(options):
    def fail(time):
        if time > 0.305:
            os.kill(os.getpid(), signal.SIGINT)

    run = simulate(counter(fail), **options)
    assert run.message in ("interrupted at t = 0.31 s", "interrupted at t = 0.32 s")
    assert_kept_until(run, float(run.message.split()[-2]))


def test_interrupt_between_chunks(options):
    def progress(time, wall):
        if time > 0.1:
            raise KeyboardInterrupt

    run = simulate(counter(), **options, progress=progress)
    assert run.message is not None and run.message.startswith("interrupted at t = ")
    assert 0.1 < run.time[-1] <= 1.0
    assert run.dataset["clock.y"].values[-1] == pytest.approx(run.time[-1])


def test_failure_at_the_first_step_keeps_the_start(options):
    def fail(time):
        raise ValueError("never")

    run = simulate(counter(fail), **options)
    assert run.dataset.sizes["time"] == 1
    assert run.bonds == []


def test_progress_is_told_and_ends_at_the_end(options):
    seen = []
    simulate(counter(), **options, progress=lambda time, wall: seen.append((time, wall)))
    times, walls = zip(*seen, strict=True)
    assert list(times) == sorted(times) and times[-1] == pytest.approx(1.0)
    assert list(walls) == sorted(walls) and walls[0] > 0.0
