"""What `tracktrain` says about input that cannot be run, before anything is built or run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from tracktrain.cli.main import main
from tracktrain.failures import BadInput, clear_errors


def refused(*arguments: str) -> str:
    """The message of a command that is bad input; it is not a traceback."""
    result: Result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    return result.stderr.partition("Error: ")[2].strip()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--car", "lodaed"), "there is no car 'lodaed'; did you mean loaded? choose one of: "),
        (
            ("--track", "fra7"),
            "there is no track 'fra7'; did you mean fra6 or fra5 or fra4? choose one of: report,",
        ),
        (
            ("--master", "gauss"),
            "there is no master 'gauss'; did you mean gauss-seidel? choose one of: one-",
        ),
        (("--method", "newton"), "there is no method 'newton'; choose one of: broyden, iqn-ils, "),
        (
            ("--order", "1"),
            "the master 'one-pass' has no option 'order'; choose jacobi, gauss-seidel, or leave",
        ),
        (("--speed", "60"), "'60' has no unit; give a speed such as \"60 ft/s\" (units: ft/s, mph"),
        (("--speed", "0 ft/s"), "a speed of 0 ft/s cannot be run; it must be above zero"),
        (("--speed", "-5 m/s"), "a speed of -5 m/s cannot be run; it must be above zero"),
        (("--speed", "60 kg"), "'60 kg' is a mass, not a speed; give a speed such as \"60 ft/s\""),
        (("--speed", "60 ft/ss"), "'ft/ss' is not a known unit; did you mean ft/s? choose one of"),
        (("--speed", "nan ft/s"), "'nan ft/s' is not a finite number; give a speed such as"),
        (("--speed", "fast"), "'fast' is not a number with a unit; give a speed such as"),
        (
            ("--duration", "8 m"),
            "'8 m' is a length, not a duration; give a duration such as \"8s\"",
        ),
        (("--step", "1"), "'1' has no unit; give a step such as \"1ms\" (units: ms, s)"),
        (
            ("--step", "2s", "--duration", "1s"),
            "a step of 2 s is longer than the run of 1 s; give a shorter --step or a longer",
        ),
        (("--seed", "one"), "'one' is not a valid integer"),
        (
            ("--master", "iterated", "--iterations", "99999999999999999999"),
            "99999999999999999999 is not in the range 1<=x<=2147483647",
        ),
        (
            ("--verify-output", "*.y", "--twin", "2s"),
            "nothing is verified without --verify; leave out --verify-output and --twin",
        ),
        (
            ("--set", "truck_front.axle_load=1 N", "--set", "truck_front.axle_load=2 N"),
            "truck_front.axle_load is given twice, as '1 N' and as '2 N'; leave out one",
        ),
        (
            ("--swap", "truck_rear=truck", "--swap", "truck_rear=truck_joints"),
            "truck_rear is given twice, as 'truck' and as 'truck_joints'; leave out one",
        ),
        (("--twin", "-1s"), "a time of -1s cannot be run; it must be zero or more"),
        (
            ("--set", "conicity"),
            "'conicity' cannot be read; write it as instance.parameter=\"value",
        ),
        (("--set", "truck_front=1"), "'truck_front=1' cannot be read; write it as instance.parame"),
        (
            ("--set", "truck.a=1"),
            "there is no instance 'truck'; did you mean truck_front or truck_r",
        ),
        (
            ("--initial", "body.yaw=1 deg"),
            "there is no instance 'body'; did you mean carbody? choose",
        ),
        (
            ("--initial", "carbody.yaw"),
            "'carbody.yaw' cannot be read; write it as instance.coordin",
        ),
        (
            ("--swap", "wheelset_13=a.fmu"),
            "there is no instance 'wheelset_13'; did you mean wheelse",
        ),
        (
            ("--swap", "carbody.y=a.fmu"),
            "'carbody.y=a.fmu' cannot be read; write it as instance=pa",
        ),
    ],
)
def test_bad_input_is_refused_with_what_there_was_to_choose_from(
    arguments: tuple[str, ...], message: str
) -> None:
    assert message in refused("run", *arguments)


@pytest.mark.parametrize(
    ("command", "example"),
    [
        ((), "tracktrain run --car empty"),
        (("run",), 'tracktrain run --track perfect --initial truck_front.yaw="0.005 deg"'),
        (("build",), "tracktrain build --out"),
    ],
)
def test_every_help_shows_an_example(command: tuple[str, ...], example: str) -> None:
    result = CliRunner().invoke(main, [*command, "--help"])
    assert result.exit_code == 0
    assert example in result.stdout


def test_out_is_written_in_short_in_every_command():
    def options(command: click.Command) -> Iterator[list[str]]:
        yield from (parameter.opts for parameter in command.params)
        if isinstance(command, click.Group):
            within = click.Context(command)
            for name in command.list_commands(within):
                yield from options(command.resolve_command(within, [name])[1])

    places = [names for names in options(main) if "--out" in names]
    assert len(places) > 10
    assert all("-o" in names for names in places)


def test_python_m_is_the_same_command() -> None:
    module = [sys.executable, "-m", "tracktrain", "run", "--speed", "60 kg"]
    result = subprocess.run(module, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert "'60 kg' is a mass, not a speed" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_yaw_without_its_unit_is_asked_for():
    result = CliRunner().invoke(main, ["profile", "show", "worn", "crown", "--yaw", "5"])
    assert result.exit_code == 2
    assert "give a yaw such as" in " ".join(result.output.split())


def test_an_output_without_the_letters_of_a_unit_costs_no_results(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tracktrain", "run", "--duration", "20ms"]
    done = subprocess.run(
        [*command, "--out", str(tmp_path)],
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "m/s? (g)" in done.stdout
    assert (tmp_path / "carbody.png").exists()


def test_a_name_that_no_file_of_ours_can_hold_is_said() -> None:
    said = r"'of bad\\udcff name' cannot be written as utf-8; give the file"
    with pytest.raises(BadInput, match=said), clear_errors():
        "of bad\udcff name".encode()


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
def test_ctrl_c_while_modules_load_ends_the_program_without_a_word() -> None:
    script = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Pressed:
    def find_spec(self, name, path=None, target=None):
        if name == "tracktrain.cli.main":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Pressed())
from tracktrain.__main__ import start
start()
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == -signal.SIGINT
    assert done.stderr == ""


@pytest.mark.skipif(os.name != "posix", reason="pipes as POSIX has them")
def test_reader_that_leaves_is_no_error() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "tracktrain", "params"]
    with os.fdopen(writer, "wb") as pipe:
        done = subprocess.run(command, stdout=pipe, stderr=subprocess.PIPE, text=True)
    assert done.stderr == ""


@pytest.mark.skipif(os.name != "posix", reason="devices as POSIX has them")
@pytest.mark.parametrize(
    "command",
    [
        "run --drive track.speed=/dev/zero",
        "run --layout /dev/zero",
        "track inspect /dev/zero",
        "study identify /dev/zero",
    ],
)
def test_device_that_has_no_end_is_not_read(command: str, tmp_path: Path) -> None:
    told = CliRunner().invoke(main, [*command.split(), "--out", str(tmp_path)])
    assert told.exit_code == 2
    assert "/dev/zero" in told.stderr and "it is a device, not a file" in told.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere names are text")
def test_folders_whose_names_are_no_text_are_compared_and_written_to(tmp_path: Path) -> None:
    strange, plain, out = (tmp_path / name for name in ("a\udcff", "b", "c\udcff"))
    for place in (strange, plain):
        asked = ["run", "--duration", "0.3s", "--quiet", "--out", str(place)]
        assert CliRunner().invoke(main, asked).exit_code == 0
    told = CliRunner().invoke(main, ["compare", str(strange), str(plain), "--out", str(out)])
    assert told.exit_code == 0, told.output
    assert r"a\udcff" in (out / "comparison.html").read_text("utf-8")
    told = CliRunner().invoke(main, ["track", "inspect", "fra5", "--out", str(out)])
    assert told.exit_code == 0, told.output
    assert (out / "data.nc").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere names are text")
def test_data_in_a_file_whose_name_is_no_text_are_refused_before_any_work(tmp_path: Path) -> None:
    file = tmp_path / "a\udcff.csv"
    file.write_text("station [m],alignment [m]\n0,0\n1,0\n")
    told = CliRunner().invoke(main, ["track", "inspect", str(file), "--out", str(tmp_path)])
    assert told.exit_code == 2
    assert "has a name that is no text; give it a plain one" in told.stderr
