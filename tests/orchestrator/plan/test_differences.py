"""Differences have no zero of their own: 10 degC more are 10 K more. Units that nobody knows."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator import Component, Connection, OrchestratorError, System, simulate
from orchestrator.ssp import read_ssp
from support.native_slaves import UNITS, archive, body, description, library, variable
from support.ssp_archives import (
    component,
    connection,
    connections,
    connectors,
    elements,
    linear,
    ssd,
    system,
    write,
)

TEMPERATURES = (
    '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
    '<Unit name="gross"><BaseUnit factor="144"/></Unit><Unit name="widgets"/></UnitDefinitions>'
    '<TypeDefinitions><SimpleType name="Rise"><Real unit="degC" relativeQuantity="true"/>'
    "</SimpleType></TypeDefinitions>"
)
RISE, KELVIN = 'unit="degC" relativeQuantity="true"', 'unit="K"'


def negated(path: Path, taken: str, given: str, units: str = TEMPERATURES) -> Path:
    """An FMU that gives -c times what it takes."""
    ports = body(
        [
            variable("v", "input", f'<Real {taken} start="0"/>'),
            variable("force", "output", f"<Real {given}/>"),
            variable("c", "parameter", f'<Real {taken} start="1"/>', 'variability="tunable"'),
        ],
        '<Unknown index="2" dependencies="1"/>',
    )
    return archive(path, description(ports).replace(UNITS, units), library(path.parent))


def arrived(folder: Path, given: str, taken: str, units: str = TEMPERATURES) -> float:
    """What an input gets of an output that is 10 in its own unit."""
    first = negated(folder / "a.fmu", "", given)
    second = negated(folder / "b.fmu", taken, "", units)
    pair = System(
        {"a": Component(first, {"v": -10.0, "c": 1.0}), "b": Component(second, {"c": 1.0})},
        (Connection("a.force", "b.v"),),
    )
    run = simulate(pair, duration=0.1, step=0.1, compiled=False)
    return -float(run.dataset["b.force"][-1])


@pytest.mark.parametrize(
    ("given", "taken", "kelvins"),
    [
        ('unit="degC"', KELVIN, 283.15),
        (RISE, KELVIN, 10.0),
        (RISE, f'{KELVIN} relativeQuantity="1"', 10.0),
        ('declaredType="Rise"', KELVIN, 10.0),
        ('declaredType="Rise" relativeQuantity="false"', KELVIN, 283.15),
        (KELVIN, RISE, 10.0),
        (RISE, 'unit="degC"', 10.0),
    ],
)
def test_difference_arrives_without_the_offset_of_its_unit(tmp_path, given, taken, kelvins):
    assert arrived(tmp_path, given, taken) == pytest.approx(kelvins)


def test_difference_and_temperature_in_units_of_other_zeros_are_not_mixed(tmp_path):
    with pytest.raises(
        OrchestratorError, match=r"\[K\] .* by a.force \[degC\]: only the second is"
    ):
        arrived(tmp_path, 'unit="degC"', f'{KELVIN} relativeQuantity="true"')


def test_value_of_a_difference_is_given_in_another_unit(tmp_path):
    fmu = negated(tmp_path / "a.fmu", f'{KELVIN} relativeQuantity="true"', "")
    alone = System({"a": Component(fmu, {"v": 1.0, "c": "10 degC"})})
    run = simulate(alone, duration=0.1, step=0.1, compiled=False)
    assert float(run.dataset["a.force"][-1]) == pytest.approx(-10.0)


@pytest.mark.parametrize("unit", ["widgets", "said by nobody"])
def test_units_that_nobody_knows_couple_where_both_ends_have_them(tmp_path, unit):
    assert arrived(tmp_path, f'unit="{unit}"', f'unit="{unit}"') == 10.0


def test_units_of_one_name_that_two_fmus_define_differently_are_converted(tmp_path):
    dozens = TEMPERATURES.replace('factor="144"', 'factor="12"')
    assert arrived(tmp_path, 'unit="gross"', 'unit="gross"', dozens) == pytest.approx(120.0)


@pytest.mark.parametrize(("inside", "factor"), [("", 1.0), (linear(2.0), 2.0)])
def test_differences_and_unknown_units_go_through_an_ssp(tmp_path, inside, factor):
    """The connector of a system says a unit, and not whether it is of a difference."""
    fmu = negated(tmp_path / "a.fmu", 'unit="widgets"', RISE)
    rise, widgets = (f"Real unit='{unit}'" for unit in ("degC", "widgets"))
    inner = system(
        "s",
        connectors(up=f"output {rise}", w=f"input {widgets}")
        + elements(component("a", "a.fmu"))
        + connections(connection("a.force", ".up"), connection(".w", "a.v")),
    )
    takes = negated(tmp_path / "b.fmu", KELVIN, 'unit="widgets"')
    joined = connections(connection("s.up", "b.v", inside), connection("b.force", "s.w"))
    text = ssd(elements(inner, component("b", "b.fmu")) + joined)
    path = write(tmp_path / "x.ssp", {"SystemStructure.ssd": text, "a.fmu": fmu, "b.fmu": takes})
    way = {c.target: c for c in read_ssp(path).connections}
    assert way["s:a.v"].transformation.factor == 1.0
    total = way["b.v"].transformation
    assert (total.factor, total.offset) == pytest.approx((factor, 0.0))
    assert simulate(read_ssp(path), duration=0.1, step=0.1, compiled=False).completed
