"""Parameter sets, maps, prefixes and precedence, as the standard orders them."""

from __future__ import annotations

import pytest

import tolerances
from orchestrator import OrchestratorError, simulate
from orchestrator.ssp import read_ssp
from support.ssp_archives import (
    DAMPER,
    MASS,
    bindings,
    component,
    connection,
    connections,
    connectors,
    elements,
    inline,
    linear,
    ssd,
    ssm,
    ssv,
    system,
    write,
)


@pytest.fixture
def read(tmp_path, fmus):
    """Read the system of a description and other members."""

    def make(description: str, **members: str):
        path = write(tmp_path / "test.ssp", {"SystemStructure.ssd": description, **fmus, **members})
        return read_ssp(path)

    return make


def real(value: float, unit: str = "") -> str:
    return f'Real value="{value!r}"' + (f' unit="{unit}"' if unit else "")


def entry(source: str, target: str, inside: str = "", attributes: str = "") -> str:
    return (
        f'<ssm:MappingEntry source="{source}" target="{target}" {attributes}>{inside}'
        "</ssm:MappingEntry>"
    )


def mass(*bound: str) -> str:
    """A description of one mass with parameter bindings."""
    return ssd(elements(component("mass", MASS, bindings(*bound))))


def damper(*bound: str) -> str:
    return ssd(elements(component("damper", DAMPER, bindings(*bound))))


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_values_of_every_type(read, version):
    given = {
        "c": real(2.5),
        "kind": 'Enumeration value="plain"',
        "locked": 'Boolean value="true"',
    }
    found = read(damper(inline(ssv(given, version))))
    assert found.components["damper"].parameters == {"c": 2.5, "kind": "plain", "locked": True}
    assert simulate(found, duration=0.1, step=0.1).completed


def test_types_of_fmi_3_as_ssp_2_spells_them(read):
    given = {"c": 'Float64 value="2.5"', "kind": 'Int32 value="2"'}
    found = read(damper(inline(ssv(given, "2.0"))))
    assert found.components["damper"].parameters == {"c": 2.5, "kind": 2}


def test_unit_goes_with_its_number(read):
    found = read(mass(inline(ssv({"m": real(1.5, "ton"), "start_v": real(36.0, "km/h")}))))
    assert found.components["mass"].parameters == {"m": 1500.0, "start_v": "36.0 km/h"}
    # `ton` means something else to us than the file defines, so that its definition counts.
    start = simulate(found, duration=0.1, step=0.1).dataset["mass.v"][0]
    assert float(start) == pytest.approx(10.0, rel=tolerances.ROUNDING)


@pytest.mark.parametrize(
    ("attributes", "value"), [("", 1e3 * 2.0 + 5.0), ('suppressUnitConversion="true"', 9.0)]
)
def test_map_converts_first_and_transforms_then(read, attributes, value):
    mapping = ssm(entry("load", "m", linear(2.0, 5.0), attributes))
    number = 1.0 if not attributes else 2.0
    found = read(mass(inline(ssv({"load": real(number, "ton")}), mapping)))
    assert found.components["mass"].parameters == {"m": value}


def test_tables_of_booleans_integers_and_items(read):
    mapping = ssm(
        entry(
            "free",
            "locked",
            "<ssc:BooleanMappingTransformation>"
            '<ssc:MapEntry source="true" target="false"/><ssc:MapEntry source="false" '
            'target="true"/></ssc:BooleanMappingTransformation>',
        ),
        entry(
            "law",
            "kind",
            '<ssc:EnumerationMappingTransformation><ssc:MapEntry source="simple" target="plain"/>'
            "</ssc:EnumerationMappingTransformation>",
        ),
    )
    given = {"free": 'Boolean value="false"', "law": 'Enumeration value="simple"'}
    found = read(damper(inline(ssv(given), mapping)))
    assert found.components["damper"].parameters == {"locked": True, "kind": "plain"}


def test_later_bindings_count_more_at_the_same_level(read):
    found = read(mass(inline(ssv({"m": real(1.0)})), inline(ssv({"m": real(2.0)}))))
    assert found.components["mass"].parameters == {"m": 2.0}


def test_outer_systems_count_more_than_inner_ones(read):
    """Each level sets one parameter less, the outermost one through its hierarchical name."""

    def level(*names: str) -> str:
        values = {name: real(float(len(names))) for name in names}
        return bindings(inline(ssv(values)))

    inner = component("mass", MASS, level("m", "start_v", "time_of_failure"))
    middle = system("middle", level("mass.m", "mass.start_v") + elements(inner))
    found = read(ssd(level("middle.mass.m") + elements(middle)))
    assert found.components["middle:mass"].parameters == {
        "m": 1.0,
        "start_v": 2.0,
        "time_of_failure": 3.0,
    }


def test_prefix_is_set_before_names_are_looked_up_or_mapped(read):
    by_name = inline(ssv({"m": real(4.0)}), attributes='prefix="mass."')
    mapped = inline(
        ssv({"x": real(5.0)}), ssm(entry("p.x", "mass.start_v")), attributes='prefix="p."'
    )
    found = read(ssd(bindings(by_name, mapped) + elements(component("mass", MASS))))
    assert found.components["mass"].parameters == {"m": 4.0, "start_v": 5.0}


def test_name_that_means_two_variables_sets_both(read):
    """A system `a` with an element `b`, and an element `a.b`: the standard's punning."""
    text = bindings(inline(ssv({"a.b.m": real(3.0)}))) + elements(
        system("a", elements(component("b", MASS))), component("a.b", MASS)
    )
    found = read(ssd(text))
    assert [c.parameters for c in found.components.values()] == [{"m": 3.0}, {"m": 3.0}]


def test_parameter_of_a_system_goes_to_all_that_it_is_connected_to(read):
    """Through its connectors and their transformations."""
    inner = system(
        "pair",
        connectors(load="parameter Real unit='ton'")
        + elements(component("a", MASS), component("b", MASS))
        + connections(connection(".load", "a.m"), connection(".load", "b.m", linear(0.5, 1.0))),
    )
    found = read(ssd(bindings(inline(ssv({"pair.load": real(2.0)}))) + elements(inner)))
    assert found.components["pair:a"].parameters == {"m": 2000.0}
    assert found.components["pair:b"].parameters == {"m": 1001.0}


def test_start_values_of_inputs_count_where_nothing_drives_them(read):
    pair = elements(
        component("damper", DAMPER, bindings(inline(ssv({"v": real(1.0)})))),
        component("mass", MASS, bindings(inline(ssv({"force": real(2.0, "kN")})))),
    )
    found = read(ssd(pair + connections(connection("mass.v", "damper.v"))))
    assert found.components["damper"].parameters == {}
    assert found.components["mass"].parameters == {"force": "2.0 kN"}
    assert found.notes == ("the start value of damper.v is not used: the input is driven",)


def test_sets_and_maps_in_files_and_inside_of_an_fmu(read, tmp_path, fmus):
    import zipfile

    own = tmp_path / "own.fmu"
    own.write_bytes(fmus[MASS].read_bytes())
    with zipfile.ZipFile(own, "a") as fmu:
        fmu.writestr("resources/heavy wagon.ssv", ssv({"m": real(7.0)}))
    outside = (
        '<ssd:ParameterBinding source="values.ssv"><ssd:ParameterMapping source="names.ssm"/>'
        "</ssd:ParameterBinding>"
    )
    inside = '<ssd:ParameterBinding source="resources/heavy%20wagon.ssv" sourceBase="component"/>'
    found = read(
        ssd(elements(component("mass", "own.fmu", bindings(outside, inside)))),
        **{
            "own.fmu": own,
            "values.ssv": ssv({"m": real(1.0), "speed": real(2.0)}),
            "names.ssm": ssm(entry("speed", "start_v"), entry("m", "m")),
        },
    )
    assert found.components["mass"].parameters == {"start_v": 2.0, "m": 7.0}


def test_what_nothing_takes_is_said(read):
    mapping = ssm(entry("m", "m"), entry("absent", "start_v"))
    found = read(
        mass(
            inline(ssv({"mas": real(1.0)})), inline(ssv({"m": real(1.0), "x": real(1.0)}), mapping)
        )
    )
    assert [note.partition("ssd: ")[2] for note in found.notes] == [
        "nothing in the component 'mass' takes the parameters mas",
        "there is no absent to map to start_v",
        "nothing in the component 'mass' takes the parameters x",
    ]


@pytest.mark.parametrize(
    ("given", "mapping", "problem"),
    [
        ({"m": real(1.0, "N")}, "", "N cannot be converted to kg"),
        ({"m": 'Real value="heavy"'}, "", "the parameter 'm' is 'heavy', which is no Real"),
        ({"start_v": real(1e3)}, "", "mass.start_v cannot be 1000 m/s: it must be at most 100"),
        ({"v": real(1.0)}, "", "mass.v cannot be given a value: it is a continuous output"),
        ({"m": 'Binary value="00"'}, "", "is of type Binary, which cannot be given"),
        ({"m": 'Real value="1 2"'}, "", "mass.m cannot be [1.0, 2.0]: it is no array"),
        (
            {"m": 'Boolean value="true"'},
            ssm(entry("m", "m", linear(2.0))),
            "the parameter 'm' of kind Boolean cannot go through a line",
        ),
    ],
)
def test_value_that_does_not_fit(read, given, mapping, problem):
    with pytest.raises(OrchestratorError) as caught:
        read(mass(inline(ssv(given), mapping)))
    assert "test.ssp: SystemStructure.ssd" in str(caught.value)
    assert problem in str(caught.value)


@pytest.mark.parametrize(
    ("binding", "problem"),
    [
        (
            "<ssd:ParameterBinding/>",
            "a parameter binding of the component 'mass' has neither a source nor a <ParameterSet>",
        ),
        (
            '<ssd:ParameterBinding source="none.ssv"/>',
            "the source 'none.ssv' of a parameter binding of the component 'mass' is not there",
        ),
        (
            '<ssd:ParameterBinding source="none.ssv" sourceBase="component"/>',
            "the source 'none.ssv' of a parameter binding of the component 'mass' is not in "
            "'mass.fmu'",
        ),
        (
            '<ssd:ParameterBinding source="a.csv" type="text/csv"/>',
            "a parameter binding of the component 'mass' is of type 'text/csv'",
        ),
        (
            '<ssd:ParameterBinding source="SystemStructure.ssd"/>',
            "begins with <SystemStructureDescription>, not with <ParameterSet>",
        ),
    ],
)
def test_binding_that_leads_nowhere(read, binding, problem):
    with pytest.raises(OrchestratorError) as caught:
        read(mass(binding))
    assert problem in str(caught.value)
