"""Conversion between the units that FMI, pint and FMUs write."""

from __future__ import annotations

import pytest

import tolerances
from orchestrator.errors import DimensionError, UnitError
from orchestrator.fmu.common_units import UNITS
from orchestrator.fmu.units import BaseUnit, Quantity, conversion, registry, scale_of


@pytest.mark.parametrize(
    ("source", "target", "gain", "offset"),
    [
        ("N.m", "N.m", 1.0, 0.0),
        ("lbf.in", "N.m", 4.4482216152605 * 0.0254, 0.0),
        ("lbf/in", "N/m", 4.4482216152605 / 0.0254, 0.0),
        ("ft/s2", "m/s2", 0.3048, 0.0),
        ("km/h", "m/s", 1 / 3.6, 0.0),
        ("mph", "ft/s", 5280 / 3600, 0.0),
        ("deg", "rad", 0.017453292519943295, 0.0),
        ("rpm", "rad/s", 0.10471975511965977, 0.0),
        ("kg.m2", "lb.ft**2", 1 / (0.45359237 * 0.3048**2), 0.0),
        ("kg^0.5.m", "kg^0.5.mm", 1000.0, 0.0),
        ("N.s/m", "kg/s", 1.0, 0.0),
        ("1/s", "s-1", 1.0, 0.0),
        ("%", "1", 0.01, 0.0),
        ("degC", "K", 1.0, 273.15),
        ("degF", "degC", 5 / 9, -160 / 9),
    ],
)
def test_conversion_is_affine(source, target, gain, offset):
    assert conversion(source, target) == pytest.approx((gain, offset), rel=tolerances.ROUNDING)


@pytest.mark.parametrize(
    ("source", "target"), [("N", "N.m"), ("m", "s"), ("kg", "1"), ("rad/s", "m/s")]
)
def test_units_of_different_things_do_not_convert(source, target):
    assert conversion(source, target) is None


def test_unit_that_the_fmu_defines_means_what_it_says():
    own = {
        "wagonload": BaseUnit({"kg": 1}, factor=80e3),
        "tilt_mark": BaseUnit({"rad": 1}, 0.01, 0.5),
    }
    assert conversion("wagonload", "t", own) == pytest.approx((80.0, 0.0))
    assert conversion("tilt_mark", "1", own) == pytest.approx((0.01, 0.5))
    assert conversion("ton", "kg", {"ton": BaseUnit({"kg": 1}, 1000.0)}) == (1000.0, 0.0)
    with pytest.raises(UnitError, match="'wagonload' is not a known unit"):
        scale_of("wagonload")


def test_quantity_is_a_number_and_a_unit():
    assert Quantity.parsed("200 lbf/in") == Quantity(200.0, "lbf/in")
    assert Quantity.parsed("-1.5e-3mm") == Quantity(-1.5e-3, "mm")
    assert Quantity.parsed("7") == Quantity(7.0)
    with pytest.raises(UnitError, match="'seven mm' is no number with a unit"):
        Quantity.parsed("seven mm")


def test_quantity_converts_to_what_measures_the_same():
    speed = Quantity.parsed("36 km/h")
    assert speed.to("m/s") == pytest.approx(10.0, rel=tolerances.ROUNDING)
    assert Quantity(20.0, "degC").to("K") == pytest.approx(293.15, rel=tolerances.ROUNDING)
    assert (Quantity(1.0, "lb").dimension, Quantity(1.0).dimension) == ("[mass]", "dimensionless")
    with pytest.raises(DimensionError, match=r"36 km/h .* cannot be in kg"):
        speed.to("kg")


@pytest.mark.parametrize("unit", [*UNITS, "lbf*in/rad", "kg*m**2/s**2", "1/s", "m**-1"])
def test_units_that_are_met_often_are_what_pint_says(unit):
    known, said = scale_of(unit), registry().Quantity(1.0, unit).to_base_units()
    assert known.factor == pytest.approx(said.magnitude, rel=tolerances.ROUNDING)
    assert dict(known.dimension) == dict(said.dimensionality)
