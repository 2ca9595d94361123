"""Systems of files that other tools might write: flattened, connected, refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import tolerances
from orchestrator import (
    Component,
    Connection,
    Experiment,
    Linear,
    OrchestratorError,
    System,
    simulate,
)
from orchestrator.ssp import read_ssp
from support.ssp_archives import (
    DAMPER,
    MASS,
    UNITS,
    bindings,
    component,
    connection,
    connections,
    connectors,
    elements,
    inline,
    linear,
    ssd,
    ssv,
    system,
    write,
)

PAIR = elements(component("damper", DAMPER), component("mass", MASS))
FORCE, SPEED = connection("damper.force", "mass.force"), connection("mass.v", "damper.v")


@pytest.fixture
def archive(tmp_path, fmus):
    """Write an archive of a description, the two FMUs and other members."""

    def make(description: str, name: str = "test.ssp", **members: str | bytes) -> Path:
        return write(tmp_path / name, {"SystemStructure.ssd": description, **fmus, **members})

    return make


def refusal(path: Path, **options: str) -> str:
    with pytest.raises(OrchestratorError) as caught:
        read_ssp(path, **options)
    return str(caught.value)


def links(system: System) -> set[Connection]:
    return set(system.connections)


def test_flat_system_is_what_python_would_build(archive):
    stop = '<ssd:DefaultExperiment startTime="1" stopTime="3.5"/>'
    read = read_ssp(archive(ssd(PAIR + connections(FORCE, SPEED), stop)))
    assert links(read) == {
        Connection("damper.force", "mass.force"),
        Connection("mass.v", "damper.v"),
    }
    assert read.experiment == Experiment(1.0, 3.5)
    assert (read.bonds, read.notes) == (None, ())
    assert simulate(read, duration=0.1, step=0.01).bonds  # found by unit


def test_start_and_end_do_not_say_which_way_values_flow(archive):
    backwards = connection("mass.force", "damper.force"), connection("damper.v", "mass.v")
    read = read_ssp(archive(ssd(PAIR + connections(*backwards))))
    assert links(read) == {
        Connection("damper.force", "mass.force"),
        Connection("mass.v", "damper.v"),
    }


def dictionary(name: str, **entries: str) -> str:
    """A system's signal dictionary of entries such as `Real unit="N"`."""
    inside = "".join(
        f'<ssb:DictionaryEntry name="{entry}"><ssc:{typed}/></ssb:DictionaryEntry>'
        for entry, typed in entries.items()
    )
    return (
        f'<ssd:SignalDictionaries><ssd:SignalDictionary name="{name}">'
        f'<ssb:SignalDictionary version="1.0">{inside}{UNITS.format("ssb")}</ssb:SignalDictionary>'
        "</ssd:SignalDictionary></ssd:SignalDictionaries>"
    )


def bus(name: str, dictionary: str, *signals: str) -> str:
    return (
        f'<ssd:SignalDictionaryReference name="{name}" dictionary="{dictionary}">'
        f"{connectors(**dict.fromkeys(signals, 'inout'))}</ssd:SignalDictionaryReference>"
    )


V_OF_BIG = connectors(v="input", f="output")


def nested(*inner: str, **of_system: str) -> str:
    """The damper in a system in a system."""
    kinds = of_system or {"speed": "input", "pull": "output"}
    ends = [connection(".speed", "d.v"), connection("d.force", ".pull")]
    small = system(
        "small",
        connectors(**kinds) + elements(component("d", DAMPER)) + connections(*(inner or ends)),
    )
    return system(
        "big",
        V_OF_BIG
        + elements(small)
        + connections(connection(".v", "small.speed"), connection("small.pull", ".f")),
    )


def around(inner: str, speed: str = "", force: str = "") -> str:
    return elements(inner, component("mass", MASS)) + connections(
        connection("mass.v", "big.v", speed), connection("big.f", "mass.force", force)
    )


def test_connections_are_followed_through_the_borders_of_systems(archive):
    read = read_ssp(archive(ssd(around(nested()))))
    assert [*read.components] == ["big:small:d", "mass"]
    assert links(read) == {
        Connection("big:small:d.force", "mass.force"),
        Connection("mass.v", "big:small:d.v"),
    }
    run = simulate(read, duration=0.1, step=0.01)
    assert "big:small:d.force" in run.dataset


def test_lines_along_the_way_compose_in_its_order(archive):
    """Out: 2 x + 1, then 3 x - 5; in the units of the ports."""
    inner = nested(connection(".speed", "d.v"), connection("d.force", ".pull", linear(2.0, 1.0)))
    read = read_ssp(archive(ssd(around(inner, force=linear(3.0, -5.0)))))
    assert Connection("big:small:d.force", "mass.force", Linear(6.0, -2.0), True) in links(read)


@pytest.mark.parametrize(
    ("unit", "offset"), [("Real unit='km/h'", 10.0 / 3.6), ("Real unit='m/s'", 10.0), ("", 10.0)]
)
def test_offset_counts_in_the_unit_of_the_connector_that_it_leads_to(archive, unit, offset):
    """The outer connection adds 10 to what enters the system; without a unit in the FMU's."""
    wanted = linear(1.0, 10.0)
    text = around(nested(speed=f"input {unit}".strip(), pull="output"))
    outer = connection(".v", "small.speed")
    read = read_ssp(archive(ssd(text.replace(outer, connection(".v", "small.speed", wanted)))))
    (link,) = (c for c in read.connections if c.target == "big:small:d.v")
    assert link.transformation.factor == pytest.approx(1.0, rel=tolerances.ROUNDING)
    assert link.transformation.offset == pytest.approx(offset, rel=tolerances.ROUNDING)


def test_connector_without_a_unit_has_that_of_what_is_behind_it(archive):
    """Km/h outside, nothing at the inner system, m/s at its FMU: 10 is added in m/s."""
    text = around(nested().replace(V_OF_BIG, connectors(v="input Real unit='km/h'", f="output")))
    outer = connection(".v", "small.speed")
    shifted = connection(".v", "small.speed", linear(1.0, 10.0))
    read = read_ssp(archive(ssd(text.replace(outer, shifted))))
    (link,) = (c for c in read.connections if c.target == "big:small:d.v")
    assert link.transformation.offset == pytest.approx(10.0, rel=tolerances.ROUNDING)


def test_suppressed_conversion_takes_the_number_as_it_is(archive):
    """3.6 m/s read as km/h is 1 m/s."""
    text = around(nested(speed="input Real unit='km/h'", pull="output"))
    outer = connection(".v", "small.speed")
    bare = connection(".v", "small.speed", attributes='suppressUnitConversion="true"')
    read = read_ssp(archive(ssd(text.replace(outer, bare))))
    (link,) = (c for c in read.connections if c.target == "big:small:d.v")
    assert link.suppress_unit_conversion
    assert link.transformation.factor == pytest.approx(1 / 3.6, rel=tolerances.ROUNDING)


METRES_PER_SECOND = {"m/s": 1.0, "km/h": 1.0 / 3.6}
HOP = st.tuples(
    st.sampled_from([*METRES_PER_SECOND]),
    st.sampled_from([1.0, -2.0, 0.5]),
    st.sampled_from([0.0, 3.0]),
    st.booleans(),
)


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(hops=st.lists(HOP, min_size=1, max_size=4))
def test_way_into_nested_systems_does_what_each_connection_would_alone(archive, hops):
    """Followed with a number from border to border, as against one connection at the end."""
    value, unit = 7.0, "m/s"
    inside = elements(component("d", DAMPER)) + connections(connection(".v", "d.v"))
    for depth, (wanted, factor, offset, suppressed) in reversed([*enumerate(hops)]):
        kind = connectors(v=f"input Real unit='{wanted}'")
        attributes = 'suppressUnitConversion="true"' if suppressed else ""
        start = "mass.v" if depth == 0 else ".v"
        into = connection(start, "s.v", linear(factor, offset), attributes)
        beside = [component("mass", MASS)] if depth == 0 else []
        inside = elements(system("s", kind + inside), *beside) + connections(into)
    for wanted, factor, offset, suppressed in hops:
        if not suppressed:
            value *= METRES_PER_SECOND[unit] / METRES_PER_SECOND[wanted]
        value, unit = factor * value + offset, wanted
    (link,) = read_ssp(archive(ssd(inside))).connections  # m/s at either end
    assert link.transformation(7.0) == pytest.approx(
        value * METRES_PER_SECOND[unit], rel=tolerances.ROUNDING, abs=tolerances.ROUNDING
    )


def test_system_defined_once_is_used_twice(archive):
    """`#id` refers to a system of the same file."""
    inner = (
        connectors(v="input", f="output")
        + elements(component("d", DAMPER, bindings(inline(ssv({"c": 'Real value="1"'})))))
        + connections(connection(".v", "d.v"), connection("d.force", ".f"))
    )
    first = system("one", inner).replace("<ssd:System", '<ssd:System id="shock_absorber"')
    twice = component("two", "#shock_absorber", bindings(inline(ssv({"d.c": 'Real value="2"'}))))
    read = read_ssp(
        archive(
            ssd(
                elements(first, twice, component("mass", MASS))
                + connections(
                    connection("mass.v", "one.v"),
                    connection("mass.v", "two.v"),
                    connection("two.f", "mass.force"),
                )
            )
        )
    )
    assert links(read) == {
        Connection("mass.v", "one:d.v"),
        Connection("mass.v", "two:d.v"),
        Connection("two:d.force", "mass.force"),
    }
    assert [read.components[name].parameters["c"] for name in ("one:d", "two:d")] == [1.0, 2.0]


def test_component_that_is_another_archive(archive, fmus, tmp_path):
    """Its bindings count more than those of the system inside; a fragment names its variant."""
    inside = ssd(
        connectors(v="input", f="output")
        + bindings(inline(ssv({"d.c": 'Real value="1"'})))
        + elements(component("d", DAMPER))
        + connections(connection(".v", "d.v"), connection("d.force", ".f"))
    )
    part = write(
        tmp_path / "part.ssp", {"SystemStructure.ssd": ssd(""), "soft.ssd": inside, **fmus}
    )
    outer = ssd(
        elements(
            component(
                "part",
                "resources/part.ssp#soft.ssd",
                bindings(inline(ssv({"d.c": 'Real value="7"'}))),
                'type="application/x-ssp-package"',
            ),
            component("mass", MASS),
        )
        + connections(connection("mass.v", "part.v"), connection("part.f", "mass.force"))
    )
    read = read_ssp(archive(outer, **{"resources/part.ssp": part.read_bytes()}))
    assert read.components["part:d"].parameters == {"c": 7.0}
    assert Connection("part:d.force", "mass.force") in links(read)


def test_bare_description_beside_its_fmus(fmus, tmp_path):
    (tmp_path / "resources").mkdir()
    for place, path in fmus.items():
        (tmp_path / place).write_bytes(path.read_bytes())
    (tmp_path / "car.ssd").write_text(ssd(PAIR + connections(FORCE, SPEED)))
    read = read_ssp(tmp_path / "car.ssd")
    assert read == System(
        {
            "damper": Component(tmp_path.resolve() / DAMPER),
            "mass": Component(tmp_path.resolve() / MASS),
        },
        (Connection("damper.force", "mass.force"), Connection("mass.v", "damper.v")),
    )
    with pytest.raises(OrchestratorError, match=r"a variant is chosen of an \.ssp archive"):
        read_ssp(tmp_path / "car.ssd", "other")


def test_signals_go_through_dictionaries_from_system_to_system(archive):
    """One writes, the other reads, in kilonewtons on the way; both refer to the outer bus."""
    giver = system(
        "giver",
        connectors(v="input")
        + elements(component("d", DAMPER), bus("out", "can", "pull"))
        + connections(connection(".v", "d.v"), connection("d.force", "out.pull", linear(2.0))),
    )
    taker = system(
        "taker",
        connectors(v="output")
        + elements(component("mass", MASS), bus("in", "can", "pull"))
        + connections(connection("in.pull", "mass.force"), connection("mass.v", ".v")),
    )
    text = elements(giver, taker) + connections(connection("taker.v", "giver.v"))
    read = read_ssp(archive(ssd(text + dictionary("can", pull='Real unit="kN"'))))
    assert links(read) == {
        Connection("taker:mass.v", "giver:d.v"),
        Connection("giver:d.force", "taker:mass.force", Linear(2.0), True),
    }
    inside = text + dictionary("can", pull="Real")
    twice = inside.replace(
        '<ssd:Connections><ssd:Connection  startElement="in"',
        f'<ssd:Connections>{connection("mass.x", "in.pull")}<ssd:Connection  startElement="in"',
    )
    assert "can.pull is driven twice: by giver.d.force and by taker.mass.x" in refusal(
        archive(ssd(twice))
    )


def test_variants_are_chosen_by_file_or_by_name(archive):
    path = archive(ssd(PAIR), **{"stiff.ssd": ssd(PAIR + connections(FORCE), name="the stiff one")})
    for name in ("stiff.ssd", "stiff", "the stiff one"):
        assert len(read_ssp(path, name).connections) == 1
    usual = read_ssp(path)
    assert usual.connections == ()
    assert usual.notes == (f"{path}: SystemStructure.ssd was read; '{path}' also holds stiff.ssd",)
    assert refusal(path, variant="soft") == (
        f"'{path}' has no variant 'soft'; choose one of: SystemStructure.ssd, stiff.ssd"
    )


def test_names_with_dots_do_not_collide(archive):
    inner = system("a", elements(component("b", DAMPER)))
    others = component("a.b", DAMPER), component("a/b", DAMPER)
    read = read_ssp(archive(ssd(elements(inner, *others))))
    assert [*read.components] == ["a:b", "a:b_2", "a:b_3"]
    assert "the component 'a.b' is called a:b_2" in read.notes


def test_system_in_the_manner_of_omsimulator(archive):
    """Annotations first, empty lists, a map without a version, one value for two parameters."""
    master = (
        '<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations '
        'xmlns:oms="https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd">'
        '<oms:SimulationInformation><oms:FixedStepMaster description="oms-ma" stepSize="0.05" '
        'absoluteTolerance="0.0001" relativeTolerance="0.0001"/></oms:SimulationInformation>'
        "</oms:Annotations></ssc:Annotation></ssd:Annotations>"
    )
    entry = '<ssm:MappingEntry source="speed" target="{}"/>'
    mapping = (
        f"<ssm:ParameterMapping>{entry.format('wc.mass.start_v')}{entry.format('other.start_v')}"
        "</ssm:ParameterMapping>"
    )
    inner = system(
        "wc",
        "<ssd:Connectors/>"
        + elements(component("mass", MASS, connectors(v="output Real", m="parameter Real")))
        + "<ssd:Connections/>",
    )
    text = (
        master
        + "<ssd:Connectors/>"
        + bindings(inline(ssv({"speed": 'Real value="3"'}), mapping))
        + elements(inner, component("other", MASS))
        + "<ssd:Connections/>"
    )
    stop = '<ssd:DefaultExperiment startTime="0.000000" stopTime="1.000000"/>'
    read = read_ssp(archive(ssd(text, stop)))
    assert read.experiment == Experiment(0.0, 1.0, 0.05)
    assert [c.parameters for c in read.components.values()] == 2 * [{"start_v": 3.0}]
    assert len(simulate(read).time) == 21


@pytest.mark.parametrize(
    ("asked", "step", "every", "notes"),
    [
        ("0.01", None, 10, ()),
        ("0.1", "0.05", 2, ()),
        ("0.12", "0.05", 2, ("mass asks for steps of 0.12 s; it takes 0.1 s",)),
        ("0.01", "0.05", 1, ("mass asks for steps of 0.01 s; it takes 0.05 s",)),
    ],
)
def test_step_that_a_component_asks_for_is_a_multiple(archive, asked, step, every, notes):
    """By the annotation of the Open Simulation Platform, and rounded as libcosim does."""
    hint = (
        '<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform"><osp:StepSizeHint '
        'xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations" '
        f'value="{asked}"/></ssc:Annotation></ssd:Annotations>'
    )
    experiment = (
        '<ssd:DefaultExperiment><ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:x '
        f'xmlns:oms="x"><oms:FixedStepMaster stepSize="{step}"/></oms:x></ssc:Annotation>'
        "</ssd:Annotations></ssd:DefaultExperiment>"
    )
    read = read_ssp(
        archive(ssd(elements(component("mass", MASS, hint)), experiment if step else ""))
    )
    assert read.components["mass"].every == every
    assert read.notes == tuple(
        f"{note}, a multiple of the macro step of {step} s" for note in notes
    )


def test_what_is_for_other_tools_is_said(archive):
    extra = '<ssd:Annotations><ssc:Annotation type="org.example.colours"/></ssd:Annotations>'
    outputs = connectors(total="output")
    text = outputs + PAIR + connections(connection("damper.force", ".total")) + extra
    read = read_ssp(path := archive(ssd(text)))
    assert read.notes == (
        "outputs of the system 'root', before transformations: total is damper.force",
        f"{path}: SystemStructure.ssd: annotations that are not used: org.example.colours",
    )
    assert read.notes == tuple(simulate(read, duration=0.1, step=0.1).notes[:2])


@pytest.mark.parametrize(
    ("inside", "problem"),
    [
        (
            PAIR + connections(connection("dampr.force", "mass.force")),
            "a connection of the system 'root' starts at the element 'dampr'; did you mean damper? "
            "choose one of: damper, mass",
        ),
        (
            PAIR + connections(connection("damper.forc", "mass.force")),
            "starts at the connector 'forc' of the component 'damper'; did you mean force? ",
        ),
        (
            PAIR + connections(connection("damper.force", "mass.v")),
            "damper.force (output) and mass.v (output) cannot be connected: both give values",
        ),
        (
            PAIR + connections(connection("damper.v", "mass.force")),
            "damper.v (input) and mass.force (input) cannot be connected: both take values",
        ),
        (
            PAIR + connections(FORCE, connection("damper.force", "mass.force", linear(2.0))),
            "mass.force is driven twice: by damper.force and by damper.force",
        ),
        (
            PAIR + connections(connection("mass.v", "mass.force")),
            "mass.v drives mass.force: m/s cannot be converted to N",
        ),
        (
            PAIR + connections(connection("damper.force", "damper.c")),
            "parameters are not carried from FMU to FMU; give the value in a parameter set",
        ),
        (
            PAIR + connections(connection("damper.force", "mass.force", "", 'endIndices="1"')),
            "has endIndices: SSP does not say whether elements are numbered from 0 or from 1",
        ),
        (
            elements(component("a", DAMPER), component("a", MASS)),
            "the system 'root' has two elements 'a'",
        ),
        (
            elements(component("a", "resources/dampr.fmu")),
            "the source 'resources/dampr.fmu' of the component 'a' is not there; did you mean "
            "resources/damper.fmu or resources/mass.fmu? choose one of: ",
        ),
        (
            elements(component("a", "../../etc/passwd")),
            "the source '../../etc/passwd' of the component 'a' lies outside of the package",
        ),
        (
            elements(component("a", "file:///etc/passwd")),
            "the source 'file:///etc/passwd' of the component 'a' is an absolute URI",
        ),
        (
            elements(component("a", "http://example.org/a.fmu")),
            "the source 'http://example.org/a.fmu' of the component 'a' is an absolute URI",
        ),
        (
            elements(component("a", DAMPER, attributes='type="application/x-other"')),
            "the component 'a' is of type 'application/x-other'; ",
        ),
        (
            elements(component("a", DAMPER, attributes='implementation="ModelExchange"')),
            "the component 'a' is to run as ModelExchange; only CoSimulation can be run",
        ),
        (
            elements('<ssd:Component name="a"/>'),
            "the component 'a' has no source: a design without an implementation",
        ),
        (
            elements(component("a", DAMPER, connectors(force="input"))),
            "the connector 'force' of the component 'a' is declared input, but is output of its "
            "FMU",
        ),
        (
            elements(component("a", DAMPER, connectors(force="output Boolean"))),
            "the connector 'force' of the component 'a' is declared Boolean, but is Real in its",
        ),
        (
            elements(component("a", DAMPER, connectors(forc="output"))),
            "the connector 'forc' of the component 'a' is no variable of 'damper.fmu'; did you "
            "mean force?",
        ),
        (
            elements(
                component("damper", DAMPER, connectors(force="output Real unit='kN'")),
                component("mass", MASS),
            )
            + connections(FORCE),
            "damper.force is declared in kN, but in N by its FMU",
        ),
        (
            elements(component("a", "#nothing")),
            "the component 'a' refers to the system '#nothing'; there are none",
        ),
        (
            elements('<ssd:SignalDictionaryReference name="bus" dictionary="can"/>'),
            "the signal dictionary reference 'bus' refers to 'can'; there are none",
        ),
        (
            elements(bus("bus", "can", "pul")) + dictionary("can", pull="Real"),
            "the signal dictionary reference 'bus' has a connector 'pul', which is no entry of "
            "'can'; did you mean pull?",
        ),
        (
            '<ssd:SignalDictionaries><ssd:SignalDictionary name="can"/></ssd:SignalDictionaries>',
            "the signal dictionary 'can' has neither a source nor a <SignalDictionary> in it",
        ),
    ],
)
def test_system_that_cannot_be_represented(archive, inside, problem):
    path = archive(ssd(inside))
    message = refusal(path)
    assert message.startswith(f"'{path}: SystemStructure.ssd': ")
    assert problem in message


def test_component_that_is_no_archive_is_named_by_its_place(archive):
    as_archive = component("a", MASS, attributes='type="application/x-ssp-package"')
    path = archive(ssd(elements(as_archive)))
    assert refusal(path) == (
        f"'{path}: SystemStructure.ssd: {MASS}' is no SSP archive: it has no SystemStructure.ssd"
    )


def test_experiment_that_stops_before_it_starts(archive):
    times = '<ssd:DefaultExperiment startTime="2" stopTime="1"/>'
    message = refusal(archive(ssd(PAIR, after=times)))
    assert "its experiment stops at 1 s, and starts at 2 s" in message


def test_system_that_contains_itself(archive):
    ring = component("a", "#ring")
    text = ssd(
        elements(system("s", elements(ring)).replace("<ssd:System", '<ssd:System id="ring"'))
    )
    assert "is nested in itself, without end" in refusal(archive(text))


def test_connections_in_a_circle_through_a_border(archive):
    inner = system("s", connectors(a="input", b="output") + connections(connection(".a", ".b")))
    text = elements(inner) + connections(connection("s.b", "s.a"))
    read = read_ssp(archive(ssd(text)))
    assert read.components == {}
    wired = system(
        "s",
        connectors(a="input", b="output")
        + elements(component("d", DAMPER))
        + connections(connection(".a", ".b"), connection(".a", "d.v")),
    )
    message = refusal(archive(ssd(elements(wired) + connections(connection("s.b", "s.a")))))
    assert "the connections to s.a run in a circle" in message


def test_files_that_are_no_systems(tmp_path, fmus):
    assert refusal(tmp_path / "no.ssp") == (
        f"the system '{tmp_path / 'no.ssp'}' cannot be read: no such file or directory"
    )
    empty = write(tmp_path / "empty.ssp", {"readme.txt": "nothing"})
    assert refusal(empty) == f"'{empty}' is no SSP archive: it has no SystemStructure.ssd"
    text = tmp_path / "text.ssp"
    text.write_text("no archive")
    assert "cannot be opened as a zip archive" in refusal(text)
    broken = write(tmp_path / "broken.ssp", {"SystemStructure.ssd": ssd(PAIR)[:-5]})
    assert "SystemStructure.ssd' that cannot be read: " in refusal(broken)
    bomb = '<!DOCTYPE b [<!ENTITY a "aaaa">]>' + ssd("&a;")
    assert "declares a document type" in refusal(write(tmp_path / "b.ssp", {"a.ssd": bomb}))
    slip = write(tmp_path / "slip.ssp", {"SystemStructure.ssd": ssd(""), "../evil": "x"})
    assert refusal(slip) == f"'{slip}' holds '../evil', which lies outside of the archive"
    two = write(tmp_path / "two.ssp", {"a.ssd": ssd(""), "b.ssd": ssd("")})
    assert "has no SystemStructure.ssd; choose one of: a.ssd, b.ssd" in refusal(two)


def test_nested_system_runs_as_the_flat_one(archive):
    flat = read_ssp(archive(ssd(PAIR + connections(FORCE, SPEED))))
    deep = read_ssp(archive(ssd(around(nested())), "deep.ssp"))
    flat, deep = (s.with_value("mass.start_v", 1.0) for s in (flat, deep))
    one, other = (
        simulate(s.with_value(f"{name}.c", 10.0), duration=0.5, step=0.01).dataset["mass.v"]
        for s, name in ((flat, "damper"), (deep, "big:small:d"))
    )
    np.testing.assert_array_equal(one, other)
    assert one[-1] < one[0]
