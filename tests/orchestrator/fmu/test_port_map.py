"""FMUs behind port maps: other names, signs, units and scales, and rates that they do not give."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrator import (
    Component,
    Connection,
    InlineModel,
    OrchestratorError,
    Port,
    PortMap,
    System,
    describe,
    read_port_map,
    simulate,
)


def ramp(unit: str = "m/s") -> InlineModel:
    """v = 2 t."""
    return InlineModel(
        outputs={"v": unit},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: x + 2.0 * step,
        output=lambda x, u, p: {"v": x},
    )


def run_of(fmu, ports, *connections, parameters=None, **options):
    components = {"ramp": Component(ramp()), "a": Component(fmu, parameters or {}, ports)}
    system = System(components, tuple(Connection(*ends) for ends in connections))
    run = simulate(system, duration=1.0, step=0.1, **options)
    assert run.completed, run.message
    return run


@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
@pytest.mark.parametrize("flavour", ["two", "three"])
def test_affine_map_and_its_inverse_at_the_other_end(flavour, master, request):
    """The FMU gives its input back; seen through maps in and out, out = 3 (in - 1) / -2 + 4."""
    fmu = request.getfixturevalue(flavour)
    here, there = {"two": ("u", "y"), "three": ("v[3]", "w[3]")}[flavour]
    gain = {"two": 1.0, "three": 3.0}[flavour]
    ports = PortMap({"in": Port(here, -2.0, 1.0), "out": Port(there, 3.0 / gain, 4.0)})
    run = run_of(fmu, ports, ("ramp.v", "a.in"), master=master)
    expected = 3.0 * (run.dataset["ramp.v"] - 1.0) / -2.0 + 4.0
    np.testing.assert_allclose(run.dataset["a.out"], expected, rtol=1e-14)


def test_rates_of_scaled_inputs_are_scaled(three):
    """position = integral of rate, led along a line: -1/4 t^2 seen from outside as t^2."""
    ports = PortMap({"v": Port("rate", -4.0), "x": Port("position", -4.0)})
    run = run_of(three, ports, ("ramp.v", "a.v"))
    np.testing.assert_allclose(run.dataset["a.x"], run.time**2, rtol=1e-14)


def test_start_values_and_limits_go_through_the_map(two):
    ports = PortMap({"lift": Port("shift", 0.001, 0.0, "m"), "out": Port("y")})
    run = run_of(two, ports, parameters={"lift": "0.5 cm", "u": 1.0})
    assert (run.dataset["a.out"] == 6.0).all()
    assert describe(two).variables["shift"].start == "0"


def test_missing_velocity_is_the_second_order_difference_of_the_position(three):
    """Of a parabola it is exact from the second step on; the first step has two points only."""
    own = InlineModel(outputs={"x": "m", "vx": "m/s"}, derivative_of={"vx": "x"}).description
    ports = PortMap({"x": Port("position")}).fitted(own, describe(three), {"x", "vx"})
    assert ports.rates == {"vx": "x"}
    run = run_of(three, ports, ("ramp.v", "a.rate"))
    found = run.dataset["a.vx"]
    assert found.attrs == {"units": "m/s", "description": "rate of x, differentiated"}
    np.testing.assert_allclose(found[2:], 2.0 * run.time[2:], rtol=1e-12)
    assert found[:2].values == pytest.approx([0.0, 0.1])


def test_difference_converges_with_the_square_of_the_step(three):
    """x = integral of sin t: the error is a third of H^2 times the third derivative, less the
    twelfth by which the integral over straight lines is wrong."""
    sine = InlineModel(
        outputs={"v": "m/s", "a": "m/s2"},
        derivative_of={"a": "v"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: {"v": np.sin(x), "a": np.cos(x)},
    )
    ports = PortMap({}, {"vx": "position"})
    errors = []
    for step in (0.04, 0.02):
        system = System(
            {"sine": Component(sine), "a": Component(three, {}, ports)},
            (Connection("sine.v", "a.rate"),),
        )
        run = simulate(system, duration=2.0, step=step)
        errors.append(float(run.dataset["a.vx"][-1]) - np.sin(2.0))
    third = -np.sin(2.0)  # of the position
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] == pytest.approx(-(0.02**2) * (1.0 / 3.0 - 1.0 / 12.0) * third, rel=0.1)


def test_tangents_dependencies_and_rates_keep_their_meaning(three):
    seen = PortMap({"place_of_it": Port("position"), "speed": Port("rate", -1.0)}).applied(
        describe(three)
    )
    assert "position" not in seen.variables
    assert seen.variables["speed"].lane.gain == -1.0
    assert seen.find("place").name == "place_of_it"
    whole = PortMap({"forces": Port("w")}).applied(describe(three))
    assert whole.arrays["forces"] == (3,)
    assert whole.variables["forces[2]"].dependencies == {"v[1]", "v[2]", "v[3]"}


TOML = """
y = "lateral"
"left.creep_x" = { name = "slip[1]", factor = 0.01, offset = -0.5 }
[front]
force_y = { name = "Fy", sign = -1, unit = "kN" }
"""

SSM = """<ssm:ParameterMapping xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
 xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" version="1.0">
<ssm:MappingEntry source="y" target="lateral"/>
<ssm:MappingEntry source="force" target="Fy">
<ssc:LinearTransformation factor="-2" offset="6"/></ssm:MappingEntry></ssm:ParameterMapping>"""


def test_maps_are_read_from_toml_and_from_ssp(tmp_path):
    path = tmp_path / "map.toml"
    path.write_text(TOML)
    assert read_port_map(path).ports == {
        "y": Port("lateral"),
        "left.creep_x": Port("slip[1]", 0.01, -0.5),
        "front.force_y": Port("Fy", -1.0, 0.0, "kN"),
    }
    path = tmp_path / "map.ssm"
    path.write_text(SSM)
    assert read_port_map(path).ports == {"y": Port("lateral"), "force": Port("Fy", -0.5, 3.0)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("y = ", "is no TOML: "),
        ("y = 3", 'does not say what y is in the FMU; write it like y = "their_name" or'),
        ('y = { name = "a", scale = 2 }', "says 'scale' of y; choose one of: name, sign, factor"),
        ('y = { name = "a", factor = "2" }', "says factor = '2' of y; give a number"),
        ('y = { name = "a", unit = 2 }', "says unit = 2 of y; give a text"),
        ('y = { name = "a", sign = 2 }', "says sign = 2 of y; give 1 or -1"),
        ('y = { name = "a", factor = 0 }', "says factor = 0 of y; give another"),
    ],
)
def test_map_that_cannot_be_read(tmp_path, text, message):
    path = tmp_path / "map.toml"
    path.write_text(text)
    with pytest.raises(OrchestratorError) as caught:
        read_port_map(path)
    assert str(caught.value).startswith(f"the port map '{path}' {message}")


@pytest.mark.parametrize(
    ("ports", "message"),
    [
        (
            {"y": Port("positoin")},
            "the port map says that y is positoin, which three.fmu does not have; did you mean "
            "position?",
        ),
        (
            {"a": Port("rate"), "b": Port("rate")},
            "the port map takes rate of three.fmu for two ports, a and b; leave one out",
        ),
        (
            {"b": Port("boolean_out", -1.0)},
            "b is of type Boolean, which a port map cannot scale; leave out sign, factor and "
            "offset",
        ),
    ],
)
def test_map_that_does_not_fit_the_fmu(three, ports, message):
    with pytest.raises(OrchestratorError) as caught:
        run_of(three, PortMap(ports))
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("ports", "message"),
    [
        (
            {"x": Port("event_at")},
            "the port map's x [m] cannot be event_at [s]: the units measure different things",
        ),
        (
            {"x": Port("position", unit="quux.y")},
            "the port map's x = position: 'quux.y' is not a known unit",
        ),
        (
            {"x": Port("w")},
            "the port map takes w of three.fmu, an array of 3, for x, which is one variable; name "
            "their elements",
        ),
    ],
)
def test_map_that_does_not_fit_what_is_replaced(three, ports, message):
    own = InlineModel(outputs={"x": "m"}).description
    with pytest.raises(OrchestratorError) as caught:
        PortMap(ports).fitted(own, describe(three), {"x"})
    assert str(caught.value) == message


def test_rate_of_what_is_not_there_and_a_mock_behind_a_map(three):
    with pytest.raises(OrchestratorError, match="cannot give v as the rate of q, which it does"):
        run_of(three, PortMap({}, {"v": "q"}))
    with pytest.raises(OrchestratorError, match="a is a mock, which takes no port map"):
        run_of(ramp(), PortMap({"w": Port("v")}))
