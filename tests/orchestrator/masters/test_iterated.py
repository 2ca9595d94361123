"""Macro steps that are repeated, by FMUs that lack something; and those that do not converge."""

from __future__ import annotations

import os
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import tolerances
from orchestrator import Component, Connection, InlineModel, System, simulate
from support.coupled_models import largest_displacement_error, order, oscillator, two_mass
from support.typed_slaves import build_fmi2
from support.wheelset_on_truck import wheelset_on_truck


def changed(system: System, instance: str, **changes) -> System:
    """With a mock that differs in something."""
    fmu = system.components[instance].fmu
    assert isinstance(fmu, InlineModel)
    return system.with_fmu(instance, replace(fmu, **changes))


def errors(system: System) -> list[float]:
    return [
        largest_displacement_error(simulate(system, duration=4, step=h, master="iterated"))
        for h in (0.02, 0.01, 0.005)
    ]


@pytest.mark.parametrize(("rigid", "driven"), [("one", "other.x, other.v"), ("other", "one.force")])
def test_fmu_that_cannot_restore_steps_once_and_what_it_drives_is_extrapolated(rigid, driven):
    system = changed(oscillator(rates=False), rigid, saves_state=False)
    run = simulate(system, duration=0.1, step=0.01, master="iterated")
    assert (
        f"{rigid} cannot save its state and steps once; extrapolated from its last values: {driven}"
        in run.notes
    )
    assert "no macro step is repeated: no circle of connections can be" in run.notes
    assert run.statistics.fmu_steps == 1.0
    assert abs(order(errors(system)) - 2.0) < tolerances.COUPLING_ORDER


def test_circle_is_repeated_without_the_fmu_that_cannot_restore():
    """A third slave, which cannot, hears from the pair and answers it: the pair still agrees."""
    echo = InlineModel(
        inputs={"v": "m/s"}, outputs={"force": "N"}, saves_state=False,
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: u["v"] + rate["v"] * step,
        output=lambda x, u, p: {"force": -0.1 * x},
    )  # fmt: skip
    pair = oscillator(rates=False)
    other = pair.components["other"].fmu
    assert isinstance(other, InlineModel)
    pushed = replace(
        other,
        inputs={**other.inputs, "push": "N"},
        step=lambda x, u, rate, p, time, step: other.step(
            x, u, rate, p, time, step
        ) + np.array([0.0, step * u["push"]]),
    )  # fmt: skip
    system = System(
        {**pair.with_fmu("other", pushed).components, "echo": Component(echo)},
        (*pair.connections, Connection("one.v", "echo.v"), Connection("echo.force", "other.push")),
    )
    run = simulate(system, duration=0.2, step=0.01, master="iterated")
    assert run.completed
    assert "repeat each macro step until 3 inputs agree: one, other" in run.notes
    assert "echo cannot save its state and steps once; extrapolated" in " ".join(run.notes)
    (found,) = run.statistics.iterations
    assert found.slaves == 2 and found.mean > 1.5
    assert run.statistics.fmu_steps == pytest.approx((2.0 * found.mean + 1.0) / 3.0)


def test_inputs_that_cannot_move_are_constant_at_their_end_value_and_first_order_is_left():
    system = oscillator(rates=False, interpolates_inputs=False)
    run = simulate(system, duration=0.1, step=0.01, master="iterated")
    assert (
        "constant over each step at their end value, since the FMU takes no input derivatives: "
        "other.x, other.v, one.force"
    ) in [note.replace("one.force, other.x, other.v", "other.x, other.v, one.force")
          for note in run.notes]  # fmt: skip
    assert abs(order(errors(system)) - 1.0) < tolerances.COUPLING_ORDER


def test_step_that_does_not_converge_is_told_and_what_came_before_is_kept(tmp_path):
    """The damper grows too stiff for the fixed point on the way."""
    system = two_mass(0.5, 0.01)
    other = system.components["other"].fmu
    assert isinstance(other, InlineModel)

    def output(x, u, p):
        found = other.output(x, u, p)
        return {"force": found["force"] * (100.0 if abs(u["x"]) > 0.015 else 1.0)}

    stiffening = system.with_fmu("other", replace(other, output=output))
    options = {"duration": 1.0, "step": 0.01, "master": "iterated", "method": "fixed-point"}
    run = simulate(stiffening, **options, iterations=40, out=tmp_path)
    assert not run.completed and run.message is not None
    end = run.time[-1]
    assert 0.0 < end < 0.1
    assert re.match(
        rf"one, other do not agree after 40 evaluations of the step from t = {end:g} s: "
        r"(one.force \(from other.force\)|other.v \(from one.v\)) still changes by ",
        run.message,
    )
    assert "give a shorter step, another method or a larger tolerance" in run.message
    with xr.open_dataset(tmp_path / "results.nc") as kept:
        assert kept.attrs["stopped"] == run.message
        whole = simulate(stiffening, **{**options, "duration": end, "iterations": 40})
        assert whole.completed
        for name in ("one.v", "other.force"):
            assert np.array_equal(kept[name].values, whole.dataset[name].values)


def test_whole_numbers_are_held_over_a_step_and_true_at_its_end(tmp_path):
    fmu = build_fmi2(tmp_path)
    system = System(
        {"a": Component(fmu), "b": Component(fmu)},
        (Connection("a.steps", "b.i"), Connection("b.steps", "a.i")),
    )
    run = simulate(system, duration=0.1, step=0.01, master="iterated")
    assert "held over each step, since they are not real numbers: a.i, b.i" in run.notes
    assert "no macro step is repeated: no circle of connections can be" in run.notes
    for name in ("a.steps", "b.j"):
        assert run.dataset[name].values.tolist() == list(range(11))


@pytest.mark.skipif(os.name != "posix", reason="isolation needs Linux or macOS")
def test_isolated_fmus_roll_back_in_their_processes():
    options = {"duration": 0.05, "step": 1e-3, "master": "iterated"}
    whole = simulate(wheelset_on_truck(), **options)
    apart = simulate(wheelset_on_truck(), **options, isolate=["wheelset", "truck"])
    assert apart.record.tobytes() == whole.record.tobytes()
    (found,) = apart.statistics.iterations
    assert found.mean > 1.5 and apart.statistics.iterations == whole.statistics.iterations
