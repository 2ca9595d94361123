"""The truck's loops on the rig: energy in closed form, no influence of rate, wedges under load."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import tolerances
from tracktrain.errors import TracktrainError
from tracktrain.scales import POUND_FORCE
from tracktrain.studies.truck_hysteresis import truck_hysteresis


@pytest.fixture(scope="module")
def constant():
    return truck_hysteresis(loads=(20.0, 100.0), periods=(1.0, 2.0))


def test_every_loop_dissipates_4f_times_slip(constant):
    table = constant.tables["loops"]
    assert len(table) == 6 * 2 * 2
    assert table["energy [J]"].to_numpy() == pytest.approx(
        table["4f(A-f/Kf) [J]"].to_numpy(), rel=tolerances.LOOP_ENERGY
    )


def test_loops_do_not_depend_on_the_rate(constant):
    for element in ("bolster_roll", "bolster_vertical", "warp"):
        force = constant.dataset[f"{element}.force"].sel(load=100.0)
        difference = np.abs(force.sel(period=1.0) - force.sel(period=2.0)).max()
        assert difference < tolerances.LOOP_RATE * float(np.abs(force).max())


def test_constant_wedges_do_not_feel_the_load(constant):
    energy = constant.tables["loops"].reset_index().groupby("element")["energy [J]"]
    assert (energy.max() / energy.min() - 1 < tolerances.LOOP_RATE).all()


def test_proportional_wedges_hold_as_much_as_the_load_on_them():
    loads = (20.0, 100.0)
    outcome = truck_hysteresis(wedge_law="load_proportional", loads=loads, periods=(1.0,))
    force = outcome.dataset["bolster_roll.force"].isel(period=0)
    strain = outcome.dataset["bolster_roll.strain"].isel(period=0)
    width = [
        float(np.ptp(force.sel(load=load).values[np.abs(strain.sel(load=load)) < 1e-4]))
        for load in loads
    ]
    static = 97.6e3 * POUND_FORCE  # 110 000 lb less two wheelsets and two side frames
    limits = [
        2 * 2.73e5 * POUND_FORCE * 0.0254 * load * 1e3 * POUND_FORCE / static for load in loads
    ]
    assert np.array(width) == pytest.approx(limits, rel=0.2)
    energy = outcome.tables["loops"].loc["3 bolster roll"]
    assert energy["energy [J]"].to_numpy() == pytest.approx(
        energy["4f(A-f/Kf) [J]"].to_numpy(), rel=0.03
    )
    unchanged = outcome.tables["loops"].loc["6 warp", "energy [J]"]
    assert np.ptp(unchanged) < 1e-3 * unchanged.iloc[0]


def test_every_element_of_table_4_5_is_drawn_and_written(constant, tmp_path):
    written = {path.name for path in constant.write(tmp_path)}
    assert {"figure_4_20.png", "loops.csv", "loop_warp.csv", "loop_bolster_lateral.csv"} <= written


def test_loops_made_in_other_processes_in_any_order_are_the_same(monkeypatch):
    asked = {"loads": (100.0,), "periods": (0.2, 0.3)}
    here = truck_hysteresis(**asked)

    def elsewhere(tasks, work, workers):
        for number in reversed(tasks):
            there, options = pickle.loads(pickle.dumps((work, tasks[number])))
            yield number, pickle.loads(pickle.dumps(there(options)))

    monkeypatch.setitem(truck_hysteresis.__wrapped__.__globals__, "rows", elsewhere)
    there = truck_hysteresis(**asked, workers=2)
    assert there.dataset.identical(here.dataset)
    assert there.files == here.files


def test_a_loop_that_stops_is_told_as_itself_and_not_tried_again(monkeypatch):
    tried = []

    def stopped(run, what):
        tried.append(what)
        raise TracktrainError(f"{what} stopped")

    def elsewhere(tasks, work, workers):
        for number, options in tasks.items():
            yield number, pickle.loads(pickle.dumps(work(options)))

    ours = truck_hysteresis.__wrapped__.__globals__
    monkeypatch.setitem(ours, "completed", stopped)
    monkeypatch.setitem(ours, "rows", elsewhere)
    with pytest.raises(TracktrainError, match="the lateral loop at 20 kip stopped"):
        truck_hysteresis(loads=(20.0,), periods=(0.2,))
    assert len(tried) == 1


def test_a_process_that_ends_with_its_loop_is_told(monkeypatch):
    def killed(tasks, work, workers):
        yield next(iter(tasks)), {"units": {}, "message": "the process ended with exit code -9"}

    monkeypatch.setitem(truck_hysteresis.__wrapped__.__globals__, "rows", killed)
    with pytest.raises(TracktrainError, match="exit code -9"):
        truck_hysteresis(loads=(20.0,), periods=(0.2,))
