"""A run as a file: what options say in TOML, and results from which the run is made again."""

from __future__ import annotations

import json
import tomllib

import pytest
from click.testing import CliRunner

from orchestrator import open_results, read_request, simulate
from orchestrator.errors import ResultsError
from support.coupled_models import oscillator
from tracktrain.cli.commands.run import command
from tracktrain.cli.main import main
from tracktrain.errors import TracktrainError
from tracktrain.options.file import keys, run_file, schema

FAST = """
speed = "80 ft/s"
seed = 4
settle = true
record = ["truck_*.axle*"]
every = 2

[set]
truck_front.bolster_lateral.friction_limit = "3000 lbf"
wheelset_11.conicity = 0.1

[swap]
truck_rear = "truck_joints"
wheelset_12 = "mine.fmu"
"""


def understood(*arguments):
    """What `tracktrain run` takes its arguments for."""
    return command.make_context("run", [str(a) for a in arguments])


@pytest.fixture
def fast(tmp_path):
    (tmp_path / "mine.fmu").touch()
    file = tmp_path / "fast.toml"
    file.write_text(FAST)
    return file


def test_a_file_means_what_the_same_options_mean(fast):
    typed = understood(
        "--speed", "80 ft/s", "--seed", 4, "--settle", "--record", "truck_*.axle*", "--every", 2,
        "--set", "truck_front.bolster_lateral.friction_limit=3000 lbf",
        "--set", "wheelset_11.conicity=0.1",
        "--swap", "truck_rear=truck_joints", "--swap", f"wheelset_12={fast.parent / 'mine.fmu'}",
    )  # fmt: skip
    assert understood(fast).params == typed.params


def test_what_is_typed_departs_from_the_file(fast):
    given = understood(fast, "--speed", "30 mph").params
    assert given["speed"] == pytest.approx(13.4112) and given["seed"] == 4


def test_a_saved_quantity_is_as_it_was_typed(fast, tmp_path):
    saved = tomllib.loads(run_file(understood("--speed", "30 mph", "--memory", "1 GB"), tmp_path))
    assert saved == {"speed": "30 mph", "memory": "1 GB"}
    departed = run_file(understood(fast, "--duration", "2 min"), tmp_path)
    assert 'speed = "80 ft/s"' in departed and 'duration = "2 min"' in departed


def test_what_is_saved_from_another_folder_means_the_same(fast, tmp_path):
    other = tmp_path / "elsewhere" / "saved.toml"
    other.parent.mkdir()
    first = understood(fast, "--out", tmp_path / "results")
    other.write_text(run_file(first, other.parent))
    second = understood(other)
    assert first.params["swaps"][1][2] != second.params["swaps"][1][2]  # seen from there
    assert (tmp_path / "elsewhere" / "../mine.fmu").samefile(second.params["swaps"][1][2])
    assert second.params["out"].resolve() == first.params["out"].resolve()
    same = first.params.keys() - {"swaps", "out"}
    assert {n: first.params[n] for n in same} == {n: second.params[n] for n in same}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('sped = "1 ft/s"', r"has 'sped'; did you mean speed or "),
        ('speed = "80"', "speed: '80' has no unit"),
        ("seed = [1, 2]", "seed is one value, and not several"),
        ('set = "a.b=1"', r"set is a table: \[set\]"),
        ("[set]\ntruck.mass = 1", "set: there is no instance 'truck'"),
        ('track = "fra9"', "track: there is no track 'fra9'"),
        ("speed = ", "is no TOML: "),
    ],
)
def test_what_a_file_cannot_mean_is_said_with_file_and_key(text, message, tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text(text)
    with pytest.raises(TracktrainError, match=f"wrong.toml'?.*{message}"):
        understood(file)


def test_editors_know_every_key_that_a_file_may_have(fast):
    said = schema(command)["properties"]
    assert said.keys() == {"system", *keys(command)} >= tomllib.loads(FAST).keys()
    assert all(entry["description"] for entry in said.values())
    assert said["master"]["enum"] and said["every"]["type"] == "integer"
    printed = CliRunner().invoke(command, ["--schema"]).output
    assert json.loads(printed)["properties"] == said


def test_a_run_is_made_again_from_its_results_to_the_bit(tmp_path):
    runner = CliRunner()
    given = ["--duration", "0.1s", "--set", "wheelset_11.conicity=0.1", "--master", "jacobi"]
    first = runner.invoke(main, ["run", *given, "--quiet", "--out", str(tmp_path / "one")])
    again = ["run", "--again", str(tmp_path / "one"), "--quiet", "--out", str(tmp_path / "two")]
    second = runner.invoke(main, again)
    assert (first.exit_code, second.exit_code) == (0, 0), second.output
    with open_results(tmp_path / "one") as one, open_results(tmp_path / "two") as two:
        assert one.attrs["parameters"] == two.attrs["parameters"]
        assert one.attrs["master"] == two.attrs["master"] == "jacobi"
        for name in one.data_vars:
            assert one[name].values.tobytes() == two[name].values.tobytes()
    refused = runner.invoke(main, [*again, "--speed", "30 mph"])
    assert "made again as it was; leave out --speed" in refused.output


def test_a_run_in_real_time_is_made_again_as_such_and_says_so(tmp_path):
    runner = CliRunner()
    given = ["--duration", "0.02s", "--real-time", "10", "--set", "track.seed=3"]
    first = runner.invoke(main, ["run", *given, "--out", str(tmp_path / "one")])
    again = ["run", "--again", str(tmp_path / "one"), "--out", str(tmp_path / "two")]
    second = runner.invoke(main, again)
    for result in (first, second):
        assert "of computing alone, without waiting" in result.output


def test_an_fmu_that_has_changed_since_is_named(tmp_path):
    from shutil import copy

    from fmus.catalogue import fmu_path
    from orchestrator import Component, System

    fmu = tmp_path / "own.fmu"
    copy(fmu_path("track"), fmu)
    system = System({"rails": Component(fmu)})
    simulate(system, duration=0.01, step=1e-3, out=tmp_path / "out")
    assert read_request(tmp_path / "out").system == system
    copy(fmu_path("carbody"), fmu)
    with pytest.raises(ResultsError, match=r"rails: .*own\.fmu' has changed since"):
        read_request(tmp_path / "out")
    fmu.unlink()
    copy(fmu_path("track"), tmp_path / "out" / "own.fmu")
    found = read_request(tmp_path / "out", [tmp_path / "out"]).system
    assert found.components["rails"].file == tmp_path / "out" / "own.fmu"


def test_results_of_a_model_in_python_say_that_they_cannot_be_made_again(tmp_path):
    simulate(oscillator(), duration=0.1, step=0.01, out=tmp_path)
    with pytest.raises(ResultsError, match="a model in Python was part of it"):
        read_request(tmp_path)
