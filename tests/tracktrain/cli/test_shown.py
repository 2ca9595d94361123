"""What a system and a car's numbers look like from the command line and in a notebook."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from orchestrator import CouplingError, System, describe, simulate
from support.coupled_models import oscillator
from tracktrain import hopper_car
from tracktrain.cli.main import main


def printed(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 0, result.output
    return result.output


def test_every_number_of_a_car_is_shown_with_unit_range_basis_and_source():
    numbers = json.loads(printed("params", "empty", "--json"))
    assert numbers["carbody.body_mass"]["unit"] == "lb"
    assert all(n["basis"] and n["source"] and n["description"] for n in numbers.values())
    table = printed("params", "--like", "carbody.*frequency")
    assert table.count(" Hz ") >= 3 and "Table 4-1" in table and "+- 0.1" in table


def test_a_pattern_that_fits_no_number_is_answered_with_those_there_are():
    refused = CliRunner().invoke(main, ["params", "--like", "carbody.mass"])
    assert refused.exit_code != 0 and "did you mean carbody.body_mass" in str(refused.output)


def test_a_system_is_shown_as_a_table_and_as_a_diagram(tmp_path):
    said = printed("system", "--picture", tmp_path / "car.svg", "--connections")
    assert "truck_front" in said and "carbody (8)" in said
    assert "track.wheelset_11.rail_y_left" in said or "-> wheelset_11.rail_y_left" in said
    assert (tmp_path / "car.svg").read_text().count("wheelrail.fmu") == 4


def test_a_diagram_of_a_thousand_fmus_is_refused():
    one = oscillator()
    many = System({f"c{n}": one.components["one"] for n in range(1000)})
    with pytest.raises(CouplingError, match="1000 components cannot be read"):
        many.plot()


def test_data_shows_itself_in_a_line_and_in_a_table():
    system, run = hopper_car(), simulate(oscillator(), duration=0.1, step=0.01)
    truck = describe(fmu_path("truck"))
    assert repr(system).startswith("<System: 8 components, 84 connections; of carbody")
    assert repr(truck).startswith("<FMU: truck.fmu (FMI 2.0); parameters half_wheelbase [m]")
    assert repr(run).startswith("<Run: 0 to 0.1 s, 11 rows of 5 variables; ended as asked")
    for thing in (system, truck, run):
        assert len(repr(thing)) < 1500
        assert thing._repr_html_().count("<tr>") >= 1


def test_names_of_a_runs_variables_complete_and_a_wrong_one_is_answered():
    run = simulate(oscillator(), duration=0.1, step=0.01)
    assert set(run._ipython_key_completions_()) == {*map(str, run.dataset.data_vars)}
    assert run["one.x"].attrs["units"] == "m"
    with pytest.raises(Exception, match=r"has no 'one\.y'; did you mean one\.x"):
        run["one.y"]
