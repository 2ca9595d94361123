"""Sweeps: the grid, rows that survive, rows that say why, and the numbers of single runs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from orchestrator import Kind, Outcome, simulate
from orchestrator.results.metrics import dominant_frequency, peak, rms
from support.sweep_rows import squared
from tracktrain.car.hopper import hopper_car
from tracktrain.cli.main import main
from tracktrain.errors import TracktrainError
from tracktrain.options.chosen import Shape
from tracktrain.options.master import COUPLING
from tracktrain.scales import FOOT
from tracktrain.sweep import processes, sweep
from tracktrain.sweep.axes import Axis, SweepError, make_axis, read_axis
from tracktrain.sweep.grid import USUAL
from tracktrain.sweep.one import run_one
from tracktrain.sweep.table import idle_axes, make_table, mixed_laws, pace
from tracktrain.sweep.workers import rows

FORCE = "wheelset_11.force_y"
SHORT = {"outputs": [FORCE], "duration": 0.2, "workers": 1}


@pytest.mark.parametrize(
    ("text", "values", "unit"),
    [
        ("speed=20:140:40ft/s", (20, 60, 100, 140), "ft/s"),
        ("seed=1:3", (1, 2, 3), ""),
        ("speed=60,80 ft/s", (60, 80), "ft/s"),
        ("speed=60ft/s,80ft/s", (60, 80), "ft/s"),
        ("wheelset_11.conicity=0.1:0.3:0.1", (0.1, 0.2, 0.3), ""),
        ("truck_front.initial.yaw=0.3:-0.3:-0.3deg", (0.3, 0.0, -0.3), "deg"),
        ("wheelset_11.creep_law=linear,polach", ("linear", "polach"), ""),
        ("car=loaded,empty", ("loaded", "empty"), ""),
    ],
)
def test_axes_are_ranges_or_lists_with_a_unit(text, values, unit):
    axis = read_axis(text)
    assert axis.values == values and axis.unit == unit


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("speed", "write it as speed=20:140:5ft/s"),
        ("spede=1:2", "did you mean speed"),
        ("speed=20:140:5", "has no unit"),
        ("speed=20:140:5kg", "not a speed"),
        ("speed=0:10:5ft/s", "above zero"),
        ("speed=100:20:5ft/s", "is empty"),
        ("speed=60ft/s,30mph", "mixes the units ft/s and mph"),
        ("seed=1:2:0.5", "whole number"),
        ("seed=1,1", "twice"),
        ("car=loaded,emty", "did you mean empty"),
        ("truck_front.bolster_lateral.stifness=1:2", "did you mean bolster_lateral.stiffness"),
        ("truck_front.bolster_lateral.stiffness=1:2", "the unit is missing"),
        ("truck_middle.mass=1", "there is no instance 'truck_middle'"),
        ("truck_m*.mass=1", "there is no instance 'truck_m*'"),
        ("wheelset_*.conicty=0.1", "wheelset_* has no parameter 'conicty'; did you mean conicity"),
    ],
)
def test_what_cannot_be_swept_over_is_said(text, said):
    with pytest.raises((SweepError, ValueError)) as raised:
        read_axis(text)
    assert said in str(raised.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("wheel=conical,wron", "worn"),
        ("wheel=crown", "is a rail, and a wheel is wanted"),
        ("wheel=lost.fmu", "there is no file 'lost.fmu'"),
        ("layout=lost.toml", "lost.toml"),
        ("track=fra4,lost.csv", "there is no file 'lost.csv'"),
    ],
)
def test_a_file_that_cannot_be_read_is_said_before_any_run(text, said):
    with pytest.raises(ValueError, match=said):
        read_axis(text)


@pytest.fixture
def asked(monkeypatch):
    """The options of the runs of a sweep, which are not made."""
    options = []

    def noted(given, **rest):
        options.append(given)
        return {"units": {}, "message": "", "verdict": ""}

    monkeypatch.setattr("tracktrain.sweep.grid.run_one", noted)
    return options


CURVE = """\
kind,length [m],radius [m],direction,cant [mm]
straight,50,,,
transition,30,,,
curve,100,600,left,50
"""


def test_profiles_and_lines_are_axes_like_any_other(tmp_path, asked):
    curve = tmp_path / "a:curve.csv"
    curve.write_text(CURVE)
    over = {"wheel": "conical,worn", "layout": [curve], "speed": "30,40 mph"}
    table = sweep(over, rail="crown", workers=1)
    assert table["done"].dims == ("wheel", "layout", "speed")
    pairs = [(o["wheel"], o["rail"], o["layout"]) for o in asked]
    assert pairs == [("conical", "crown", curve)] * 2 + [("worn", "crown", curve)] * 2


def test_half_a_pair_of_profiles_is_refused_before_any_run(asked):
    with pytest.raises(TracktrainError, match="give --rail, too"):
        sweep({"wheel": "conical,worn"}, workers=1)
    with pytest.raises(
        TracktrainError, match=r"--right-wheel alone .* give --wheel and --rail, too"
    ):
        sweep({"right_wheel": "conical,worn"}, workers=1)
    with pytest.raises(TracktrainError, match=r"--right-radius alone .* give --wheel and --rail"):
        sweep({"right_radius": "418,419 mm"}, workers=1)
    with pytest.raises(TracktrainError, match=r"has its rail already.*leave out --right-rail"):
        sweep({"right_rail": "crown,60e1"}, wheel="worn.fmu", workers=1)
    assert not asked


def test_right_profiles_are_axes_beside_the_left_ones(asked):
    sweep({"right_wheel": "conical,worn"}, wheel="worn", rail="crown", workers=1)
    assert [(o["wheel"], o["right_wheel"]) for o in asked] == [
        ("worn", w) for w in ("conical", "worn")
    ]


def test_the_radius_of_the_right_wheels_is_an_axis(asked):
    over = {"right_radius": "418:419:0.5 mm", "wheel": "worn,cones"}
    table = sweep(over, rail="crown", workers=1)
    assert table["right_radius"].values == pytest.approx([418.0, 418.5, 419.0])
    assert [o["right_radius"] for o in asked[::2]] == pytest.approx([0.418, 0.4185, 0.419])
    with pytest.raises(SweepError, match=r"is a \[length\] / \[time\], not a rolling radius"):
        sweep({"right_radius": "40 mph"}, wheel="worn", rail="crown", workers=1)


def test_a_sweep_does_not_go_on_with_a_file_that_was_changed(tmp_path, asked):
    curve = tmp_path / "curve.csv"
    curve.write_text(CURVE)
    over, out = {"speed": "30,40 mph"}, tmp_path / "sweep"
    sweep(over, layout=curve, out=out, workers=1)
    sweep(over, layout=curve, out=out, workers=1)
    assert len(asked) == 2
    curve.write_text(CURVE.replace("600", "500"))
    with pytest.raises(SweepError, match="files ="):
        sweep(over, layout=curve, out=out, workers=1)


def test_a_sweep_does_not_go_on_with_another_column_of_a_table_that_was_changed(tmp_path, asked):
    table, out = tmp_path / "drive.csv", tmp_path / "sweep"
    rows = "time [s],slow [m/s],fast [m/s]\n0,10,20\n9,10,20\n"
    table.write_text(rows)
    driven = {"drives": [("track", "speed", f"{table}:slow")], "workers": 1}
    sweep({"seed": "1:2"}, out=out, **driven)
    sweep({"seed": "1:2"}, out=out, **driven)
    assert len(asked) == 2
    table.write_text(rows.replace("10", "12"))
    with pytest.raises(SweepError, match="files ="):
        sweep({"seed": "1:2"}, out=out, **driven)


def test_cones_and_straight_track_are_values_beside_files(tmp_path, asked):
    curve = tmp_path / "curve.csv"
    curve.write_text(CURVE)
    over = [read_axis("wheel=cones,worn"), read_axis(f"layout=straight,{curve}")]
    sweep(over, rail="crown", workers=1)
    shapes = [Shape.taken(dict(options)) for options in asked]
    found = [(shape.wheel, shape.rail, shape.layout) for shape in shapes]
    cones, worn = (None, None), ("worn", "crown")
    assert found == [(*cones, None), (*cones, curve), (*worn, None), (*worn, curve)]


def test_numbers_without_a_unit_are_in_si_units():
    assert make_axis("speed", [20.0, np.float64(30.0)]).unit == "m/s"
    assert make_axis("truck_front.bolster_mass", [600.0]).unit == "kg"


def test_a_point_has_the_numbers_of_its_run():
    over = {"speed": "60,100 ft/s", "truck_front.initial.yaw": "0.1,0.2 deg"}
    table = sweep(over, **SHORT, track="perfect")
    assert table[f"{FORCE}.rms"].dims == ("speed", "truck_front.initial.yaw")
    system = hopper_car(speed=100 * FOOT, track="perfect")
    run = simulate(system.with_value("truck_front.initial.yaw", "0.2 deg"), duration=0.2)
    force, point = run.dataset[FORCE], table.isel({dim: 1 for dim in table.dims})
    assert float(point[f"{FORCE}.rms"]) == rms(force)
    assert float(point[f"{FORCE}.peak"]) == peak(force)
    assert float(point[f"{FORCE}.frequency"]) == dominant_frequency(force)
    ratios = [v for v in run.dataset if str(v).endswith("l_over_v")]
    assert float(point["l_over_v.max"]) == max(peak(run.dataset[v]) for v in ratios)
    assert float(point["energy_residual"]) == max(bond.relative for bond in run.bonds)
    assert str(point["verdict"].item()) == str(run.verdict)


def test_runs_do_not_depend_on_what_ran_before_in_the_process():
    over = {"car": "loaded,empty", "seed": "1:2"}
    kept, anew = (sweep(over, **SHORT, reuse=reuse) for reuse in (True, False))
    assert np.array_equal(kept[f"{FORCE}.rms"], anew[f"{FORCE}.rms"])


def test_a_run_that_fails_is_a_row_that_says_why():
    table = sweep({"wheelset_11.axle_load": "-1,55000 lbf"}, **SHORT)
    assert "must be at least" in str(table["message"].values[0])
    assert np.isnan(table[f"{FORCE}.rms"].values).tolist() == [True, False]


def test_a_sweep_goes_on_where_it_stopped(tmp_path, monkeypatch):
    from tracktrain.sweep import grid

    own, made = grid.run_one, []

    def stopping(options, **rest):
        if len(made) == 2:
            raise KeyboardInterrupt
        return going(options, **rest)

    def going(options, **rest):
        made.append(options["seed"])
        return own(options, **rest)

    monkeypatch.setattr(grid, "run_one", stopping)
    with pytest.raises(KeyboardInterrupt):
        sweep({"seed": "1:4"}, out=tmp_path, **SHORT)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 2
    with (tmp_path / "rows.jsonl").open("a") as rows:
        rows.write('{"run": 2, "uni')  # what a kill may leave
    monkeypatch.setattr(grid, "run_one", going)
    table = sweep({"seed": "1:4"}, out=tmp_path, **SHORT)
    assert made == [1, 2, 3, 4] and bool(table["done"].all())
    whole = sweep({"seed": "1:4"}, **SHORT)
    assert np.array_equal(table[f"{FORCE}.rms"], whole[f"{FORCE}.rms"])


def test_a_folder_belongs_to_one_sweep(tmp_path):
    sweep({"seed": "1"}, out=tmp_path, **SHORT)
    with pytest.raises(SweepError, match="give the same options"):
        sweep({"seed": "1"}, out=tmp_path, **{**SHORT, "duration": 0.3})
    with pytest.raises(SweepError, match=r"over = .*not"):
        sweep({"seed": "1:2"}, out=tmp_path, **SHORT)


def test_processes_make_the_rows_of_one_process(tmp_path):
    """Where an FMU is swapped, no run is made in this process."""
    over, swaps = {"speed": "60,80 ft/s"}, [("truck_rear", "", "truck")]
    alone = sweep(over, **SHORT, swaps=swaps)
    shared = sweep(over, **{**SHORT, "workers": 2}, swaps=swaps, out=tmp_path)
    assert not any(shared["message"].values)
    assert np.array_equal(alone[f"{FORCE}.rms"], shared[f"{FORCE}.rms"])
    with xr.open_dataset(tmp_path / "sweep.nc") as written:
        assert np.array_equal(written[f"{FORCE}.peak"], alone[f"{FORCE}.peak"])
        assert written["speed"].attrs["units"] == "ft/s"


def test_a_run_that_takes_its_process_along_is_a_row_and_the_others_are_made():
    tasks = {10 * n: {"number": n} for n in (1, -2, 3)}
    found = dict(rows(tasks, squared, workers=2, here=False))
    assert {n: row.get("square") for n, row in found.items()} == {10: 1, -20: None, 30: 9}
    assert found[-20]["message"] == "the process of this run ended with exit code 3"
    assert os.getpid() not in {row.get("process") for row in found.values()}


def test_a_process_whose_sweep_was_killed_ends_quietly(monkeypatch):
    monkeypatch.setattr(processes.signal, "signal", lambda *_: None)
    receiver, sender = processes.SPAWN.Pipe(duplex=False)
    receiver.close()
    counter, current = processes.SPAWN.Value("q", 0), processes.SPAWN.Value("q", -1, lock=False)
    processes._serve(sender, counter, current, [{"number": 2.0}] * 3, squared)
    assert counter.value == 1


def test_a_few_short_runs_do_not_wait_for_other_processes():
    tasks = {n: {"number": n} for n in range(4)}
    made = dict(rows(tasks, squared, workers=2))
    assert {row["process"] for row in made.values()} == {os.getpid()}


def test_how_fast_runs_were_made_and_what_was_not_stepping_is_said():
    made = [{"stepping_time": 0.5}] * 8
    assert pace(made, 4.0, 2) == (
        "8 runs in 4.0 s, 2 runs a second; 2 processes, whose time went to steps but for 50%"
    )


def test_a_running_cluster_is_used(monkeypatch):
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, processes=False, dashboard_address=None) as cluster:
        table = sweep({"seed": "1:2"}, **SHORT, scheduler=cluster.scheduler_address)
    assert bool(table["done"].all()) and not any(table["message"].values)


def test_the_command_writes_table_and_pictures_and_refuses(tmp_path):
    arguments = ["sweep", "--workers", "1", "--duration", "0.2s", "--out", str(tmp_path)]
    arguments += ["--over", "speed=60:80:20ft/s", "--over", "car=loaded,empty"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    table = pd.read_csv(tmp_path / "sweep.csv")
    assert list(table.columns[:2]) == ["speed [ft/s]", "car"] and len(table) == 4
    assert {f"{FORCE}.rms [N]", "wall_time [s]", "l_over_v.max"} <= set(table.columns)
    assert (tmp_path / "wheelset_11.force_y.png").exists()
    assert "4 runs in " in result.output and "one process, whose time" in result.output
    twice = CliRunner().invoke(main, [*arguments, "--car", "empty"])
    assert twice.exit_code == 2 and "leave out --car" in twice.output
    nowhere = [*arguments[:-2], "--scheduler", "tcp://127.0.0.1:1", "--track", "fra4"]
    lost = CliRunner().invoke(main, [*nowhere, "--out", str(tmp_path / "other")])
    assert lost.exit_code == 2 and "there is no Dask scheduler" in lost.output


@pytest.mark.slow
def test_the_command_fails_where_every_run_did(tmp_path):
    arguments = ["sweep", "--over", "speed=30mph", "--duration", "0.1s", "--out", str(tmp_path)]
    result = CliRunner().invoke(main, [*arguments, "--set", "carbody.weight=1 kg"])
    assert result.exit_code == 1
    assert "no run came to its end; the first one: carbody" in result.output
    assert (tmp_path / "sweep.csv").exists()


def test_ctrl_c_keeps_what_is_done(tmp_path):
    command = [sys.executable, "-m", "tracktrain", "sweep", "--over", "seed=1:2000", "--workers"]
    running = subprocess.Popen(
        [*command, "2", "--out", str(tmp_path), "--quiet"],
        start_new_session=True,
        stderr=subprocess.PIPE,
        text=True,
    )
    rows = tmp_path / "rows.jsonl"
    while not (rows.exists() and rows.stat().st_size):
        time.sleep(0.1)
    os.killpg(running.pid, signal.SIGINT)
    _, said = running.communicate(timeout=300)
    assert running.returncode == 1
    assert "the same command goes on" in said and "Traceback" not in said
    done = [json.loads(line)["run"] for line in rows.read_text().splitlines()]
    assert len(done) == len(pd.read_csv(tmp_path / "sweep.csv")) < 2000


def test_ctrl_c_in_the_middle_of_a_run_ends_the_sweep_and_not_that_run_alone(monkeypatch):
    def interrupted(*given, **options):
        run = simulate(*given, **options)
        return replace(run, outcome=Outcome(Kind.INTERRUPTED, 0.01))

    monkeypatch.setattr("orchestrator.simulate", interrupted)
    with pytest.raises(KeyboardInterrupt):
        run_one({"duration": 0.01}, None)


def test_a_sweep_takes_every_option_of_how_fmus_are_coupled():
    assert set(COUPLING) <= set(USUAL)


def test_an_axis_along_which_no_number_differs_has_no_say() -> None:
    numbers = np.array([[1.0, 2.0, np.nan], [1.0, 2.0, np.nan]])
    table = xr.Dataset(
        {
            "peak": (("colour", "speed"), numbers),
            "wall_time": (("colour", "speed"), np.arange(6.0).reshape(2, 3)),
            "done": (("colour", "speed"), np.ones((2, 3), np.int8)),
        }
    )
    assert idle_axes(table) == ["colour"]
    assert idle_axes(table.assign(done=table["done"] * 0)) == []
    assert idle_axes(table.assign(peak=table["peak"] * np.nan)) == []  # all runs failed


def test_runs_that_differ_in_their_creep_law_are_told_unless_it_was_swept_over():
    def told(name, found):
        rows = {n: {"units": {}, "creep_law": law} for n, law in enumerate(found)}
        return mixed_laws(make_table([Axis(name, tuple(range(len(found))))], rows))

    assert told("wheel", ["linear", "polach", "polach"]) == "linear in 1 and polach in 2"
    assert told("wheel", ["polach", "polach", ""]) == ""
    assert told("wheelset_*.creep_law", ["linear", "polach"]) == ""
