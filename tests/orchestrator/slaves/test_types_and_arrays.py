"""Variables of every type in FMUs of FMI 2.0 and 3.0: coupled, recorded, given values, refused."""

from __future__ import annotations

import json

import numpy as np
import pytest

from orchestrator import (
    Component,
    Connection,
    InlineModel,
    OrchestratorError,
    System,
    describe,
    make_plan,
    simulate,
)
from orchestrator.slaves.abi import DIRECTIONAL
from orchestrator.slaves.loading import load, unzip
from support.typed_slaves import TYPES, build_fmi2, build_fmi3, fmi2_description, fmi3_description

INTEGERS = [name for name in TYPES if "Int" in name]


@pytest.fixture(scope="module")
def eventful(tmp_path_factory):
    return build_fmi3(tmp_path_factory.mktemp("events"), fmi3_description(events=True))


def source(**outputs: float) -> Component:
    """Constant outputs of type Real."""
    return Component(
        InlineModel(outputs=dict.fromkeys(outputs, "m/s"), output=lambda x, u, p: {**outputs})
    )


def run_of(components, *connections, steps=3, **options):
    system = System(components, tuple(Connection(*ends) for ends in connections))
    run = simulate(system, duration=0.1 * steps, step=0.1, **options)
    assert run.completed, run.message
    return run


def refusal(components, *connections) -> str:
    with pytest.raises(OrchestratorError) as caught:
        run_of(components, *connections)
    return str(caught.value)


@pytest.mark.parametrize("master", ["one-pass", "jacobi"])
@pytest.mark.parametrize("type_", TYPES)
def test_a_start_value_goes_through_a_chain_of_fmus(three, type_, master):
    name = type_.lower()
    value = {"Float64": 0.1, "Float32": 0.5, "Boolean": True}.get(type_, 100)
    run = run_of(
        {"a": Component(three, {f"{name}_in": value}), "b": Component(three)},
        (f"a.{name}_out", f"b.{name}_in"),
        master=master,
    )
    assert (run.dataset[f"b.{name}_out"] == float(value)).all()


@pytest.mark.parametrize("type_", INTEGERS)
def test_an_integer_drives_a_real_and_every_integer_that_holds_it(three, type_):
    run = run_of(
        {"a": Component(three, {f"{type_.lower()}_in": 7}), "b": Component(three)},
        (f"a.{type_.lower()}_out", "b.int8_in"),
        ("b.int8_out", "b.v[2]"),
    )
    assert (run.dataset["b.int8_out"] == 7).all()
    assert (run.dataset["b.w[2]"] == 14).all()


def test_fmi_2_and_3_exchange_values_of_every_kind(two, three):
    run = run_of(
        {
            "two": Component(two, {"i": -3, "b": True, "say": "hello", "u": 2.5, "mode": "fast"}),
            "three": Component(three),
            "back": Component(two),
        },
        ("two.y", "three.v[3]"),
        ("two.j", "three.int16_in"),
        ("two.c", "three.boolean_in"),
        ("two.said", "three.say"),
        ("two.mode_out", "back.mode"),
        ("three.w[3]", "back.u"),
        ("three.int16_out", "back.i"),
        ("three.boolean_out", "back.b"),
        ("three.said", "back.say"),
    )
    last = run.dataset.isel(time=-1)
    assert [last[f"back.{n}"].item() for n in ("y", "j", "c", "steps", "mode_out")] == [
        7.5, -3, 1, 3, 5,
    ]  # fmt: skip
    assert run.texts["back.said"] == [(0.0, "he said: hello")]
    assert run.dataset["back.mode_out"].attrs["flag_meanings"] == "slow fast"
    assert run.dataset["back.mode_out"].attrs["flag_values"] == [1, 5]
    assert run.dataset["two.c"].attrs["flag_meanings"] == "false true"


def test_texts_are_recorded_when_they_change(two, three, tmp_path):
    """A ring of texts, a step from one FMU to the next: each round puts the prefix before."""
    run = run_of(
        {"a": Component(three, {"prefix": "a"}), "b": Component(two)},
        ("a.said", "b.say"),
        ("b.said", "a.say"),
        steps=4,
    )
    said = run.texts["a.said"]
    assert [text for _, text in said] == [said[0][1] + "a" * n for n in range(3)]
    assert [time for time, _ in said] == pytest.approx([0.0, 0.2, 0.4])
    run.write(tmp_path)
    lines = (tmp_path / "texts.csv").read_text().splitlines()
    assert lines[:2] == ["time [s],variable,text", "0.0,a.blob,666f6f"]
    assert lines[2] == f"0.0,a.said,{said[0][1]}"


def test_whole_arrays_and_single_elements(three):
    matrix = [[1, 2], [3, 4]]
    run = run_of(
        {
            "a": Component(three, {"v": "1 2 3", "gain": [10.0, 20.0, "30000 g"], "m": matrix}),
            "b": Component(three, {"v[2]": -1.0}),
            "c": Component(three),
        },
        ("a.w", "c.v"),
        ("a.transposed", "b.m"),
        ("a.w[3]", "b.v[1]"),
        ("a.transposed[1,2]", "c.float64_in"),
    )
    last = run.dataset.isel(time=-1)
    assert [last[f"a.w[{n}]"].item() for n in (1, 2, 3)] == [10, 40, 90]
    assert [last[f"c.w[{n}]"].item() for n in (1, 2, 3)] == [10, 80, 270]
    # The elements that nothing drives stay at the value that was given, or at their start.
    assert [last[f"b.w[{n}]"].item() for n in (1, 2, 3)] == [90, -2, 2.25]
    assert [last[f"b.transposed[{n}]"].item() for n in ("1,1", "1,2", "2,1", "2,2")] == [1, 2, 3, 4]
    assert last["c.float64_out"].item() == 3
    assert list(describe(three).arrays) == ["v", "w", "gain", "m", "transposed", "x", "y"]


def test_fmi_2_elements_that_are_named_like_an_array_are_one(two, three):
    assert describe(two).arrays == {"q": (1,), "p": (1,)}
    said = refusal({"a": Component(three), "b": Component(two)}, ("a.w", "b.q"))
    assert said == (
        "b.q cannot be driven by a.w: a.w is an array of 3 and b.q is an array of 1; connect "
        "their elements"
    )


def test_structural_parameter_resizes_arrays(three):
    run = run_of(
        {"a": Component(three, {"n": 4, "x": [1, 2, 3, 4]}), "b": Component(three, {"n": 4})},
        ("a.y", "b.x"),
    )
    last = run.dataset.isel(time=-1)
    assert [last[f"b.y[{n}]"].item() for n in (1, 2, 3, 4)] == [100, 200, 300, 400]
    assert refusal({"a": Component(three, {"n": 3}), "b": Component(three)}, ("a.y", "b.x")) == (
        "b.x cannot be driven by a.y: a.y is an array of 3 and b.x is an array of 2; connect "
        "their elements"
    )
    assert refusal({"a": Component(three, {"n": 20})}) == (
        "a (three.fmu) cannot be configured with n = 20: at most 16 elements"
    )
    assert refusal({"a": Component(three, {"n": 4, "x[2]": 1.0})}) == (
        "a.x[1] has no start value, since its array was resized; give values of all elements"
    )


def test_a_structural_parameter_may_be_no_size_and_a_size_a_constant(tmp_path):
    """Reference-FMUs' Roberts has a Boolean one."""
    text = fmi3_description(
        more='<Boolean name="dae" valueReference="60" causality="structuralParameter" '
        'variability="tunable" start="false"/>'
        '<UInt64 name="two" valueReference="61" variability="constant" start="2"/>'
        '<Float64 name="z" valueReference="46"><Dimension valueReference="61"/></Float64>'
    )
    described = describe(build_fmi3(tmp_path, text))
    assert described.arrays["z"] == (2,)
    for given in (True, "true"):
        plan = make_plan(System({"a": Component(tmp_path / "three.fmu", {"dae": given})}))
        assert plan.descriptions[0].arrays["x"] == (2,)


def test_an_item_of_several_words_is_one_meaning(tmp_path):
    """The CF conventions part meanings by blanks, and join the words of one by underscores."""
    items = '<Item name="very slow" value="1"/><Item name="fast" value="5"/>'
    run = run_of({"a": Component(build_fmi2(tmp_path, fmi2_description(items)))})
    assert run.dataset["a.mode_out"].attrs["flag_meanings"] == "very_slow fast"


def test_inputs_move_along_a_line_in_both_versions(three):
    """position' = rate, led by a rate that another FMU knows at both ends: 2 t, exactly."""
    ramp = InlineModel(
        outputs={"v": "m/s"},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: x + 2.0 * step,
        output=lambda x, u, p: {"v": x},
    )
    run = run_of({"ramp": Component(ramp), "a": Component(three)}, ("ramp.v", "a.rate"), steps=10)
    np.testing.assert_allclose(run.dataset["a.position"], run.time**2, rtol=1e-14)
    held = run_of(
        {"ramp": Component(ramp), "a": Component(three)}, ("ramp.v", "a.rate"), master="jacobi"
    )
    assert held.dataset["a.position"][1] == 0.0


def test_directional_derivatives_of_array_elements(three):
    description = describe(three)
    slave = load("a", description, unzip(three, description, three.parent / "unzipped"), None)
    unknown = np.array([description.variables[n].reference for n in ("w[3]", "w[1]")], np.uint32)
    known = np.array([description.variables[n].reference for n in ("v[1]", "v[3]")], np.uint32)
    seed, result = np.array([10.0, 100.0]), np.zeros(2)
    status = slave.call(
        DIRECTIONAL, unknown.ctypes.data, 2,
        known.ctypes.data, 2, seed.ctypes.data, result.ctypes.data,
    )  # fmt: skip
    slave.close()
    assert (status, *result) == (0, 300.0, 10.0)


def test_an_event_within_a_step_is_handled_and_the_step_finished(eventful):
    ramp = source(v=2.0)
    run = run_of({"ramp": ramp, "a": Component(eventful, {"event_at": 0.15})}, ("ramp.v", "a.rate"))
    np.testing.assert_allclose(run.dataset["a.position"], 2.0 * run.time, rtol=1e-14)
    assert run.dataset["a.events"].values.tolist() == [0, 0, 1, 1]


def test_discrete_inputs_change_in_event_mode(two, eventful):
    """The FMU refuses them in step mode; a count goes in that changes in every step."""
    run = run_of({"two": Component(two), "a": Component(eventful)}, ("two.steps", "a.int32_in"))
    assert run.dataset["a.int32_out"].values.tolist() == [0, 1, 2, 3]


def test_an_fmu_that_asks_to_end_the_run(three):
    system = System({"a": Component(three, {"end_at": 0.25})})
    run = simulate(system, duration=1.0, step=0.1)
    assert run.message == "a asks to end the run at t = 0.3 s"
    assert len(run.time) == 4


def test_large_whole_numbers_arrive_exactly_and_are_noted_where_they_are_rounded(three):
    big = 2**53 + 1
    exact = run_of({"a": Component(three, {"int64_in": str(2**53)})})
    assert (exact.dataset["a.int64_out"] == 2.0**53).all()
    assert not any("rounded" in note for note in exact.notes)
    rounded = run_of({"a": Component(three, {"int64_in": str(big), "uint64_in": 2**64 - 1})})
    assert (
        "a.uint64_out went beyond 2^53, where whole numbers are rounded to doubles" in rounded.notes
    )
    assert json.loads(rounded.dataset.attrs["parameters"])["a.int64_in"] == big


def test_number_that_does_not_fit_stops_the_run(two, three):
    """The count of the steps goes through 127 into a byte."""
    system = System(
        {"a": Component(two), "b": Component(three)}, (Connection("a.steps", "b.int8_in"),)
    )
    run = simulate(system, duration=2.0, step=0.01)
    assert run.dataset["b.int8_out"][-1] == 127
    assert run.message == (
        "b: setting inputs returned error in the step from t = 1.27 s: int8_in cannot be 128: it "
        "is of type Int8, a whole number from -128 to 127"
    )


def test_text_that_an_fmu_refuses_stops_the_run_or_the_start(two, three):
    components = {"a": Component(two, {"say": "taboo"}), "b": Component(three)}
    assert refusal(components, ("a.said", "b.say")) == (
        "b (three.fmu) refused say = 'taboo': that is not said here"
    )


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("int8_in", 128, "a.int8_in cannot be 128: it is of type Int8, from -128 to 127"),
        ("uint64_in", -1, "a.uint64_in cannot be -1: it is of type UInt64, from 0 to "),
        ("int32_in", 1.5, "a.int32_in cannot be 1.5: it is a whole number"),
        ("boolean_in", 2, "a.boolean_in cannot be '2': it is true or false"),
        (
            "v",
            [1, 2],
            "a.v cannot be '[1, 2]': it is an array of 3, and 2 values were given; give 3, or one "
            "for all",
        ),
        ("rate", [1, 2], "a.rate cannot be [1, 2]: it is no array"),
        ("v[4]", 1, "a (three.fmu) has no variable 'v[4]'; did you mean v[3] or v[2] or v[1]?"),
        ("blob", "x", "a.blob cannot be given a value: it is a discrete output;"),
        ("gain", "1 2 3 m", "a.gain[1] cannot be '1 m': m cannot be converted to its unit, kg"),
    ],
)
def test_value_that_does_not_fit(three, name, value, message):
    assert refusal({"a": Component(three, {name: value})}).startswith(message)


@pytest.mark.parametrize(
    ("output", "input_", "message"),
    [
        (
            "float64_out",
            "int8_in",
            "b.int8_in (Int8) cannot be driven by a.float64_out (Float64): integer inputs take "
            "integer outputs",
        ),
        (
            "boolean_out",
            "float64_in",
            "b.float64_in (Float64) cannot be driven by a.boolean_out (Boolean): real inputs take "
            "integer and real outputs",
        ),
        (
            "blob",
            "int8_in",
            "b.int8_in (Int8) cannot be driven by a.blob (Binary): integer inputs take integer "
            "outputs",
        ),
        (
            "clocked",
            "float64_in",
            "a.clocked cannot drive an input: it belongs to a clock, and the FMU has no event mode "
            "in which that could tick",
        ),
        (
            "w",
            "float64_in",
            "b.float64_in cannot be driven by a.w: a.w is an array of 3 and b.float64_in is one "
            "variable; connect an element, such as a.w[1]",
        ),
        (
            "w",
            "m",
            "b.m cannot be driven by a.w: a.w is an array of 3 and b.m is an array of 2 x 2; "
            "connect their elements",
        ),
    ],
)
def test_ends_that_do_not_fit(three, output, input_, message):
    components = {"a": Component(three), "b": Component(three)}
    assert refusal(components, (f"a.{output}", f"b.{input_}")) == message


@pytest.mark.parametrize(
    ("items", "taken"),
    [
        ("slow 1 fast 5", 5),  # the same numbers
        ("slow 10 fast 18 other 3", 18),  # the same items by other numbers, which a line connects
        ("left 1 right 5", 5),  # other items with these numbers
        ("slow 1 left 5", None),
        ("left 1 right 2", None),
    ],
)
def test_items_of_enumerations_go_by_name_or_by_number(two, tmp_path, items, taken):
    words = items.split()
    given = zip(words[::2], words[1::2], strict=True)
    text = "".join(f'<Item name="{name}" value="{number}"/>' for name, number in given)
    other = build_fmi2(tmp_path, fmi2_description(text), "other.fmu")
    first = int(words[1])
    components = {"a": Component(two, {"mode": "fast"}), "b": Component(other, {})}
    if taken is None:
        message = refusal(components, ("a.mode_out", "b.mode"))
        assert message.startswith(
            "b.mode cannot be driven by a.mode_out: their items do not match, slow = 1, fast = 5 "
            f"and {words[0]} = {first}"
        )
    else:
        run = run_of(components, ("a.mode_out", "b.mode"))
        assert (run.dataset["b.mode_out"] == taken).all()


def test_alias_is_the_variable_itself(three):
    run = run_of({"a": Component(three), "b": Component(three)}, ("a.place", "b.float64_in"))
    assert "a.position" in run.dataset
    assert "a.place" not in run.dataset


def test_compiled_loop_and_python_give_the_same_bits(two, three):
    components = {"a": Component(two), "b": Component(three), "ramp": source(v=0.3)}
    ends = (("a.steps", "b.v[1]"), ("b.w[1]", "a.u"), ("ramp.v", "b.rate"))
    runs = [run_of(components, *ends, compiled=compiled) for compiled in (True, False)]
    assert runs[0].record.tobytes() == runs[1].record.tobytes()


def test_fmu_that_does_not_belong_to_its_description(tmp_path):
    other = build_fmi3(tmp_path, fmi3_description(token="another"))
    assert refusal({"a": Component(other)}) == (
        "a: three.fmu cannot be instantiated: unknown token"
    )


def test_array_and_variable_of_one_name(tmp_path):
    twin = '<Float64 name="v[2]" valueReference="60" causality="local"/>'
    other = build_fmi3(tmp_path, fmi3_description(more=twin))
    assert refusal({"a": Component(other)}) == (
        "'three.fmu' has an array v and a variable v[2]; one of the two needs another name"
    )
