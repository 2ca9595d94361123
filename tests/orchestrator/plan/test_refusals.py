"""Systems and values that do not fit: each refused with one message that says what would."""

from __future__ import annotations

from dataclasses import replace

import pytest

from orchestrator import (
    Component,
    Connection,
    InlineModel,
    OrchestratorError,
    PowerBond,
    System,
    Variable,
    simulate,
)
from orchestrator.fmu.description import Description
from orchestrator.plan.start_values import resolve
from support.coupled_models import damped_mass, mass, oscillator


def refusal(system: System, **options) -> str:
    with pytest.raises(OrchestratorError) as caught:
        simulate(system, **{"duration": 1.0, "step": 0.1, **options})
    return str(caught.value)


def with_connection(source: str, target: str) -> System:
    system = damped_mass(1.0)
    return replace(system, connections=(*system.connections, Connection(source, target)))


@pytest.mark.parametrize(
    ("source", "target", "message"),
    [
        (
            "dampr.force",
            "mass.force",
            "there is no instance 'dampr' for the connection's end 'dampr.force'; "
            "did you mean damper? choose one of: damper, mass, ground",
        ),
        (
            "damper.forze",
            "mass.force",
            "damper (mock) has no output 'forze'; did you mean force? choose one of: force",
        ),
        (
            "mass.v",
            "damper.w",
            "damper (mock) has no input 'w'; choose one of: v, ground_v",
        ),
        (
            "damper.v",
            "mass.force",
            "damper.v [m/s] cannot drive an input: it is an input, not an output; "
            "choose one of: force",
        ),
        (
            "ground.v",
            "mass.v",
            "mass.v [m/s] cannot be driven: it is an output, not an input; choose one of: force, ",
        ),
        (
            "ground.v",
            "damper.v",
            "damper.v is driven twice: by mass.v and by ground.v; leave one connection out",
        ),
        (
            "mass.x",
            "mass.force_per_v",
            "mass.force_per_v [N.s/m] cannot be driven by mass.x [m]; outputs in N.s/m: none",
        ),
        ("mass", "damper.v", "'mass' names no variable; write it as instance.variable"),
    ],
)
def test_connection_that_does_not_fit(source, target, message):
    assert message in refusal(with_connection(source, target))


def test_unit_mismatch_names_the_outputs_that_would_fit():
    body = InlineModel(inputs={"force_y": "N"})
    truck = InlineModel(outputs={"force_y": "N", "force_z": "N", "moment_z": "N.m"})
    system = System(
        {"carbody": Component(body), "truck": Component(truck)},
        (Connection("truck.moment_z", "carbody.force_y"),),
    )
    assert refusal(system) == (
        "carbody.force_y [N] cannot be driven by truck.moment_z [N.m]; "
        "outputs in N: truck.force_y, truck.force_z"
    )


def test_unit_that_nobody_knows():
    system = System(
        {
            "a": Component(InlineModel(outputs={"y": "zorkmid"})),
            "b": Component(InlineModel(inputs={"u": "m"})),
        },
        (Connection("a.y", "b.u"),),
    )
    assert refusal(system) == (
        "b.u [m] cannot be driven by a.y [zorkmid]: 'zorkmid' is not a known unit; "
        "define it in the FMU's UnitDefinitions"
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"step": -0.1}, "a step of -0.1 s cannot be run; it must be above zero"),
        ({"step": float("nan")}, "a step of nan s cannot be run; it must be above zero"),
        ({"duration": 0.0}, "a duration of 0 s cannot be run; it must be above zero"),
        (
            {"step": 2.0},
            "a step of 2 s is longer than the run of 1 s; give a shorter step or a longer duration",
        ),
        (
            {"duration": 2e7, "step": 1e-6},
            "a record of 20000000000001 rows of 5 values does not fit into memory; write it to a "
            "file as it is made, give a longer step or a shorter duration, or record fewer outputs",
        ),
        ({"start": float("inf")}, "a run cannot start at inf s; give a finite time"),
        (
            {"master": "one_pass"},
            "there is no master 'one_pass'; did you mean one-pass? choose one of: one-pass, "
            "jacobi, gauss-seidel, iterated",
        ),
        (
            {"record": ["one.x", "other.q*"]},
            "no output matches 'other.q*'; did you mean other.x2 or other.force? "
            "choose one of: one.x, one.v, one.a, other.force, other.x2",
        ),
    ],
)
def test_run_that_cannot_be(options, message):
    assert refusal(oscillator(), **options) == message


def test_system_without_components_or_with_a_dotted_name():
    assert refusal(System({})) == "the system has no components"
    dotted = System({"a.b": Component(mass())})
    assert refusal(dotted) == "'a.b' cannot name an instance: it is empty or has a dot"


def test_change_of_an_instance_that_is_not_there():
    for change in (lambda s: s.with_fmu("tuck", mass()), lambda s: s.with_value("tuck.x", 1.0)):
        with pytest.raises(OrchestratorError) as caught:
            change(System({"truck": Component(mass())}))
        assert str(caught.value) == (
            "there is no instance 'tuck'; did you mean truck? choose one of: truck"
        )


@pytest.mark.parametrize(
    ("force", "velocity", "message"),
    [
        (
            "other.force",
            "one.w",
            "the bond of other.force and one.w: 'one.w' drives nothing; did you mean one.x or "
            "one.v? choose one of: one.v, one.x, other.force",
        ),
        (
            "other.force",
            "one.x",
            "the bond of other.force and one.x: force [N] times x [m] is no power; name a force "
            "and a velocity, or a moment and an angular velocity",
        ),
        ("one.x", "one.v", "the bond of one.x and one.v: one.x does not drive an input of one"),
    ],
)
def test_bond_that_is_none(force, velocity, message):
    system = replace(oscillator(), bonds=(PowerBond(force, velocity),))
    assert refusal(system) == message


VARIABLES = {
    v.name: v
    for v in (
        Variable("mass", 0, "Real", "parameter", unit="kg", minimum=0.0, maximum=1e6),
        Variable("ratio", 1, "Real", "parameter"),
        Variable("count", 2, "Integer", "parameter", "fixed", minimum=1),
        Variable("law", 3, "Enumeration", "parameter", "fixed", items={"linear": 1, "polach": 2}),
        Variable("on", 4, "Boolean", "parameter", "fixed"),
        Variable("file", 5, "String", "parameter", "fixed"),
        Variable("y", 6, "Real", "output", initial="calculated", unit="m"),
        Variable("g", 7, "Real", "local", "constant", unit="m/s2"),
        Variable("angle", 8, "Real", "local", initial="exact", unit="rad"),
    )
}
TRUCK = Description("truck.fmu", VARIABLES)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "mas",
            1.0,
            "truck (truck.fmu) has no variable 'mas'; did you mean mass? choose one of: mass, "
            "ratio, count, law, on, file, angle",
        ),
        ("mass", -5, "truck.mass cannot be -5 kg: it must be at least 0 kg and at most 1e+06 kg"),
        ("mass", "2000 t", "truck.mass cannot be 2e+06 kg: it must be at least 0 kg and at most"),
        ("mass", float("nan"), "truck.mass cannot be nan: a finite number is needed"),
        ("mass", "inf kg", "truck.mass cannot be inf: a finite number is needed"),
        (
            "mass",
            "5 m",
            "truck.mass cannot be '5 m': m cannot be converted to its unit, kg",
        ),
        (
            "mass",
            "5 kgs",
            "truck.mass cannot be '5 kgs': 'kgs' is not a known unit; its unit is kg",
        ),
        ("mass", "heavy", "truck.mass cannot be 'heavy'; write it like '1 kg'"),
        ("ratio", "5 m", "truck.ratio cannot be '5 m': m cannot be converted to its unit, 1"),
        ("count", 2.5, "truck.count cannot be 2.5: it is a whole number"),
        ("count", 0, "truck.count cannot be 0: it must be at least 1"),
        (
            "law",
            "kalker",
            "truck.law cannot be 'kalker'; write it like one of: linear, polach",
        ),
        (
            "law",
            3,
            "truck.law has no item '3'; choose one of: linear, polach, or a number from 1 to 2",
        ),
        ("on", "maybe", "truck.on cannot be 'maybe': it is true or false"),
        (
            "y",
            1.0,
            "truck.y cannot be given a value: it is a continuous output; parameters and inputs can",
        ),
        (
            "g",
            1.0,
            "truck.g cannot be given a value: it is a constant local; parameters and inputs",
        ),
    ],
)
def test_value_that_does_not_fit(name, value, message):
    with pytest.raises(OrchestratorError) as caught:
        resolve("truck", TRUCK, name, value)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("name", "value", "taken"),
    [
        ("mass", "2 t", 2000.0),
        ("mass", "1000 lb", 453.59237),
        ("mass", "12", 12.0),
        ("ratio", "50 %", 0.5),
        ("count", 3.0, 3),
        ("count", "4", 4),
        ("law", "polach", 2),
        ("law", 1.0, 1),
        ("on", "true", True),
        ("on", 0.0, False),
        ("file", "track.csv", "track.csv"),
        ("angle", "180 deg", 3.141592653589793),
    ],
)
def test_value_arrives_in_the_variables_unit_and_type(name, value, taken):
    [(_, found)] = resolve("truck", TRUCK, name, value)
    assert found == pytest.approx(taken) if isinstance(taken, float) else found == taken
    assert type(found) is type(taken)


def test_value_for_an_input_that_is_driven():
    system = damped_mass(1.0).with_value("damper.v", 3.0)
    assert refusal(system) == ("damper.v cannot be given a value: it is driven by mass.v")
