"""Quantities, names and paths as people write them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from orchestrator import (
    Component,
    Connection,
    Execution,
    Experiment,
    InlineModel,
    Jacobi,
    Linear,
    OrchestratorError,
    Port,
    PortMap,
    Settings,
    System,
    in_unit,
    linearise,
    monolith,
    simulate,
    verify,
    write_ssp,
)
from support.coupled_models import oscillator
from support.wheelset_on_truck import wheelset_on_truck

SHORT = {"duration": 0.5, "step": 0.01}


@pytest.mark.parametrize(
    ("given", "unit", "value"),
    [
        ("60 ft/s", "m/s", 18.288),
        ("8s", "s", 8.0),
        ("250 ms", "s", 0.25),
        ("0", "s", 0.0),
        (3, "s", 3.0),
        (np.float32(0.5), "s", 0.5),
        ("1e-6", "1", 1e-6),
    ],
)
def test_quantity_is_a_number_or_text_with_a_unit(given, unit, value):
    assert in_unit(given, unit, "it") == value


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("8", "t cannot be '8': the unit is missing; give a number [s], or text with a unit, as"),
        ("8 ft", "t cannot be '8 ft': 8 ft is of [length], which cannot be in s; give a number"),
        ("8 sx", "t cannot be '8 sx': 'sx' is not a known unit; give"),
        ("soon", "t cannot be 'soon': 'soon' is no number with a unit; give"),
        (None, "t cannot be None: give a number [s], or text with a unit, as in '1 s'"),
        ([1.0], "t cannot be [1.0]: give a number"),
        (True, "t cannot be True: give a number"),
    ],
)
def test_what_is_no_quantity_is_refused_by_name(given, said):
    with pytest.raises(OrchestratorError) as caught:
        in_unit(given, "s", "t")
    assert str(caught.value).startswith(said)


def test_run_takes_times_sizes_and_names_as_text(tmp_path):
    typed = simulate(
        oscillator(), duration="500 ms", step="10ms", start="1 s", record="one.*",
        memory="1 MB", timeout="1 min", out=str(tmp_path),
    )  # fmt: skip
    plain = simulate(oscillator(), **SHORT, start=1.0, record=["one.x", "one.v", "one.a"])
    assert set(typed.dataset) == set(plain.dataset) == {"one.x", "one.v", "one.a"}
    assert np.array_equal(typed.record, plain.record) and np.array_equal(typed.time, plain.time)


def test_experiment_and_system_take_what_is_meant():
    assert Experiment("1 s", "2 min", "1 ms") == Experiment(1.0, 120.0, 1e-3)
    one, other = InlineModel(outputs={"y": "m"}), InlineModel(inputs={"u": "m"})
    short = System({"a": one, "b": other}, [("a.y", "b.u")])
    assert short == System(
        {"a": Component(one), "b": Component(other)}, (Connection("a.y", "b.u"),)
    )


def test_execution_takes_a_masters_name():
    with Execution(oscillator(), "jacobi", Settings(**SHORT)) as execution:
        assert isinstance(execution.context.master, Jacobi)


def test_file_of_a_system_is_run_as_the_system_is(tmp_path):
    path = tmp_path / "pair.ssp"
    system = replace(wheelset_on_truck(), experiment=Experiment(0.0, 0.1, 1e-3))
    write_ssp(system, path)
    expected = simulate(system).record
    for given in (path, str(path)):
        assert np.array_equal(simulate(given).record, expected)
    assert verify(path, twin="0 s").completed
    for function in (
        lambda: linearise(str(path)),
        lambda: monolith(str(path), duration="2 ms", record="truck.*"),
    ):
        try:
            function()
        except OrchestratorError as error:  # the pair says why it cannot, if it cannot
            assert "truck" in str(error) or "wheelset" in str(error)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda: simulate({}), "a dict is no system; give a System, or the path of an .ssp or .ss"),
        (lambda: simulate("nowhere.ssp"), "the system 'nowhere.ssp' cannot be read: no such file"),
        (lambda: simulate(oscillator(), duration="8 ft"), "duration cannot be '8 ft': "),
        (lambda: simulate(oscillator(), record=[1]), "record cannot be [1]: give a name, or a"),
        (lambda: simulate(oscillator(), every="2"), "every cannot be '2': it is a whole number"),
        (
            lambda: simulate(oscillator(), memory=float("nan")),
            "memory cannot be nan: it must be ab",
        ),
        (lambda: simulate(oscillator(), timeout=-1), "timeout cannot be -1: it must be above 0"),
        (lambda: simulate(oscillator(), compiled="no"), "compiled cannot be 'no': it is True or"),
        (lambda: simulate(oscillator(), out=3), "out cannot be 3: give a path"),
        (lambda: simulate(oscillator(), Jacobi), "<class 'orchestrator.masters.jacobi.Jacobi'> is"),
        (lambda: simulate(oscillator(), 3), "3 is no master; give one, such as Jacobi(), or its"),
        (lambda: Jacobi(order=3), "order cannot be 3: it must be at least 0 and at most 2"),
        (lambda: Jacobi(order=1.0), "order cannot be 1.0: it is a whole number"),
        (lambda: Experiment(stop="8"), "stop cannot be '8': the unit is missing"),
        (lambda: Linear("twice"), "factor cannot be 'twice': "),
    ],
)
def test_what_cannot_be_meant_is_said_in_a_sentence(function, said):
    with pytest.raises(OrchestratorError) as caught:
        function()
    assert str(caught.value).startswith(said)


def test_names_that_there_are_not_are_refused_when_a_value_is_given():
    system = wheelset_on_truck()
    with pytest.raises(OrchestratorError, match="has no variable 'wheelset_mas'; did you mean"):
        system.with_value("truck.wheelset_mas", 1.0)
    with pytest.raises(OrchestratorError, match=r"one \(mock\) has no variable 'mass'"):
        oscillator().with_value("one.mass", 1.0)
    assert system.with_value("truck.wheelset_mass", 1.0) != system


@pytest.mark.parametrize("factor", [float("nan"), float("inf"), -float("inf")])
def test_factor_that_is_no_number_is_blamed_on_the_connection(factor):
    system = oscillator()
    first, *others = system.connections
    wrong = replace(system, connections=(replace(first, transformation=Linear(factor)), *others))
    with pytest.raises(OrchestratorError) as caught:
        simulate(wrong, **SHORT)
    assert str(caught.value) == (
        f"the connection from {first.source} to {first.target} multiplies by {factor:g}; give a "
        "finite factor and offset"
    )


@pytest.mark.parametrize("factor", [float("nan"), 0.0])
def test_factor_that_is_no_number_is_blamed_on_the_port_map(factor):
    truck = wheelset_on_truck().components["truck"]
    ports = PortMap({"axle[1].force_y": Port("axle[1].force_y", factor)})
    system = System({"truck": replace(truck, ports=ports)})
    with pytest.raises(OrchestratorError) as caught:
        simulate(system, **SHORT)
    assert str(caught.value) == (
        f"the port map takes axle[1].force_y for axle[1].force_y times {factor:g}, plus 0; give a "
        "finite offset, and a finite factor that is not 0"
    )


@pytest.mark.parametrize("start", [1e15, -1e15, 1e300])
def test_steps_that_vanish_in_the_rounding_of_times_are_refused(start):
    with pytest.raises(OrchestratorError, match="vanish in the rounding of times near"):
        simulate(oscillator(), **SHORT, start=start)


def test_run_may_begin_at_the_time_of_day():
    run = simulate(oscillator(), **SHORT, start=1.8e9)
    assert np.allclose(np.diff(run.time), 0.01, atol=1e-6)
