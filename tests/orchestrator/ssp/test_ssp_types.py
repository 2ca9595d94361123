"""Variables of every type and arrays, of FMI 2.0 and 3.0, through archives of SSP."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestrator import Component, Connection, OrchestratorError, System, Table, simulate
from orchestrator.ssp import read_ssp, write_ssp
from support.ssp_archives import bindings, component, elements, inline, problems, ssd, ssv, write
from support.typed_slaves import build_fmi2

NOT = Table("Boolean", ((True, False),))
"""False has no entry, and stays as it is."""


def read_back(system: System, path: Path) -> System:
    read = read_ssp(write_ssp(system, path))
    fmus = {name: component.fmu for name, component in system.components.items()}
    components = {name: replace(c, fmu=fmus[name]) for name, c in read.components.items()}
    return replace(read, components=components)


def test_every_type_of_fmi_2_survives(two, tmp_path):
    given = {"u": 1.5, "i": -3, "mode": "fast", "b": True, "say": "hello, all"}
    links = [("j", "i"), ("mode_out", "mode"), ("c", "b"), ("said", "say"), ("y", "u")]
    system = System(
        {"a": Component(two, given), "b": Component(two)},
        tuple(Connection(f"a.{output}", f"b.{port}") for output, port in links),
    )
    again = read_back(system, tmp_path / "types.ssp")
    assert again == system
    assert simulate(again, duration=0.2, step=0.1).dataset.equals(
        simulate(system, duration=0.2, step=0.1).dataset
    )


def test_arrays_and_types_of_fmi_3_survive_in_ssp_2(three, tmp_path):
    given = {
        "n": 4,
        "x": [4.0, 3.0, 2.0, 1.0],
        "gain": [1.0, 2.0, 3.0],
        "m": [1, 2, 3, 4],
        "int64_in": -(2**62),
        "boolean_in": True,
        "prefix": "she said: ",
    }
    links = [("w", "v"), ("transposed", "m"), ("y", "x"), ("float32_out", "float32_in")]
    system = System(
        {"a": Component(three, given), "b": Component(three, {"n": 4})},
        tuple(Connection(f"a.{output}", f"b.{port}") for output, port in links),
    )
    path = tmp_path / "arrays.ssp"
    again = read_back(system, path)
    assert again == system
    one, other = (simulate(s, duration=0.2, step=0.1) for s in (system, again))
    assert one.dataset.equals(other.dataset)
    kinds = {"SystemStructure.ssd": "Description", "resources/a.ssv": "ParameterValues"}
    with zipfile.ZipFile(path) as archive:
        for member, kind in kinds.items():
            assert problems(archive.read(member), kind, "2.0") == []


def test_table_of_booleans_with_a_gap_keeps_what_is_not_in_it(two, tmp_path):
    """True becomes false, and false stays: what arrives is false."""
    false = simulate(System({"b": Component(two, {"b": False})}), duration=0.2, step=0.1)
    for start in (True, False):
        components = {"a": Component(two, {"b": start}), "b": Component(two)}
        system = System(components, (Connection("a.c", "b.b", NOT),))
        again = read_back(system, tmp_path / f"{start}.ssp")
        assert again == system
        run = simulate(again, duration=0.2, step=0.1)
        np.testing.assert_array_equal(run.dataset["b.c"], false.dataset["b.c"])


def test_what_arrays_do_not_fit(three, tmp_path):
    whole = System({"a": Component(three)})
    with pytest.raises(OrchestratorError, match=r"is an array, which SSP 1\.0 has not; write vers"):
        write_ssp(whole, tmp_path / "a.ssp", version="1.0")
    one = replace(whole, connections=(Connection("a.w[1]", "a.rate"),))
    with pytest.raises(
        OrchestratorError, match=r"a\.w\[1\] is an element of an array; SSP does not"
    ):
        write_ssp(one, tmp_path / "a.ssp")

    def refusal(text: str) -> str:
        members = {"SystemStructure.ssd": ssd(text, version="2.0"), "three.fmu": three}
        with pytest.raises(OrchestratorError) as caught:
            read_ssp(write(tmp_path / "b.ssp", members))
        return str(caught.value)

    given = component(
        "a", "three.fmu", bindings(inline(ssv({"gain": 'Float64 value="1 2"'}, "2.0")))
    )
    message = "a.gain cannot be '[1.0, 2.0]': it is an array of 3, and 2 values were given"
    assert message in refusal(elements(given))
    path = {"SystemStructure.ssd": "", "two.fmu": build_fmi2(tmp_path)}
    four = (
        '<ssd:Connectors><ssd:Connector name="i" kind="input"><ssc:Integer/>'
        '<ssc:Dimension size="4"/></ssd:Connector></ssd:Connectors>'
    )
    path["SystemStructure.ssd"] = ssd(elements(component("b", "two.fmu", four)), version="2.0")
    with pytest.raises(OrchestratorError) as caught:
        read_ssp(write(tmp_path / "c.ssp", path))
    assert "'i' of the component 'b' is declared an array of 4, but is no array in its" in str(
        caught.value
    )
