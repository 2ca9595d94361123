"""Identification of the truck's analog: Table 4-5 out of loops, and what a loop cannot tell."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from fmus.describe.parameters import parameter_set
from fmus.truck.block import Truck
from fmus.truck.identify import PARAMETERS, identify
from fmus.truck.ports import ELEMENTS
from tracktrain.cli.main import main

TRUCK = parameter_set("loaded").values(Truck())


def loop(element: str, amplitude: float, noise: float = 0.0, samples: int = 4000, seed: int = 1):
    """A measured loop of two cycles by an integration of its own: the force of a stuck slider
    grows by Kf times the strain's increment and is cut at +-f."""
    k0, k1, kf, limit, play = (TRUCK[f"{element}.{name}"] for name in PARAMETERS)
    strain = amplitude * np.sin(4 * np.pi * np.arange(samples) / samples)
    friction = np.zeros(samples)
    for i in range(1, samples):
        friction[i] = np.clip(friction[i - 1] + kf * (strain[i] - strain[i - 1]), -limit, limit)
    beyond = np.sign(strain) * np.maximum(np.abs(strain) - play, 0.0)
    force = k0 * strain + k1 * beyond + friction
    scatter = np.random.default_rng(seed).standard_normal(samples)
    return strain, force + noise * np.abs(force).max() * scatter


def amplitude_of(element: str) -> float:
    """20 % beyond the stop, or four times what the friction yields where there is none."""
    if TRUCK[f"{element}.stop_stiffness"]:
        return 1.2 * TRUCK[f"{element}.free_play"]
    return 4 * TRUCK[f"{element}.friction_limit"] / TRUCK[f"{element}.friction_stiffness"]


def wrong(element: str, noise: float) -> dict[str, float]:
    """Relative error of each parameter that the element has."""
    found = identify(*loop(element, amplitude_of(element), noise)).estimates
    true = {name: TRUCK[f"{element}.{name}"] for name in PARAMETERS}
    if not true["stop_stiffness"]:
        del true["free_play"]
    return {name: abs(found[name].value / value - 1) for name, value in true.items() if value}


@pytest.mark.parametrize("element", ELEMENTS)
def test_clean_loops_give_table_4_5_within_1_percent(element):
    assert max(wrong(element, noise=0.0).values()) < 0.01


@pytest.mark.parametrize("element", ELEMENTS)
def test_loops_with_2_percent_noise_give_it_within_5_percent(element):
    errors = wrong(element, noise=0.02)
    if element == "bolster_vertical":
        del errors["stiffness"]  # 1 % of Kf: on so short a loop the noise hides it
    assert max(errors.values()) < 0.05


@pytest.mark.slow
def test_intervals_hold_the_truth_as_often_as_they_promise():
    hits = []
    for seed in range(20):
        found = identify(*loop("warp", amplitude_of("warp"), 0.02, 500, seed)).estimates
        hits += [found[n].low <= TRUCK[f"warp.{n}"] <= found[n].high for n in PARAMETERS]
    assert 0.88 < np.mean(hits) < 0.99


def test_a_stop_that_was_not_met_is_not_told():
    found = identify(*loop("bolster_lateral", 0.8 * TRUCK["bolster_lateral.free_play"], 0.01))
    assert not found.estimates["stop_stiffness"].told
    free_play = found.estimates["free_play"]
    assert not free_play.told and free_play.low == pytest.approx(0.8 * 0.0127)
    assert "no stop was met up to 0.01016" in found.remarks[0]
    assert found.estimates["stiffness"].told


def test_friction_that_never_slipped_is_not_told():
    reach = TRUCK["warp.friction_limit"] / TRUCK["warp.friction_stiffness"]
    strain, force = loop("warp", 0.5 * reach)
    found = identify(strain, force)
    total = found.estimates["stiffness"].value + found.estimates["friction_stiffness"].value
    assert total == pytest.approx(
        TRUCK["warp.stiffness"] + TRUCK["warp.friction_stiffness"], rel=1e-3
    )
    assert not found.estimates["friction_limit"].told
    assert any("never slipped" in remark for remark in found.remarks)


@pytest.mark.parametrize(
    ("strain", "force", "message"),
    [
        (np.arange(5.0), np.arange(5.0), "at least 20 of each"),
        (np.arange(30.0), np.arange(30.0), "never turns back"),
        (np.sin(np.arange(30.0)), np.full(30, np.nan), "not finite"),
        (np.sin(np.arange(30.0)), np.zeros(30), "does not change"),
    ],
)
def test_what_is_no_loop_is_refused(strain, force, message):
    with pytest.raises(ValueError, match=message):
        identify(strain, force)


def run(*arguments: str):
    return CliRunner().invoke(main, ["study", "identify", *arguments])


def test_command_reads_units_from_the_headings(tmp_path):
    strain, force = loop("warp", amplitude_of("warp"))
    path = tmp_path / "warp.csv"
    pd.DataFrame({"force [kN.m]": force / 1e3, "angle [mrad]": 1e3 * strain}).to_csv(path)
    result = run(str(path), "--strain", "angle", "--force", "force", "--out", str(tmp_path))
    assert result.exit_code == 0, result.output
    table = pd.read_csv(tmp_path / "parameters.csv", index_col=0)
    assert table.loc["free_play", "unit"] == "mrad"
    assert table.loc["free_play", "value"] == pytest.approx(2.18, rel=0.01)
    assert table.loc["stiffness", "unit"] == "kN.m/mrad"


def test_command_names_a_file_or_a_column_that_is_not_there(tmp_path):
    missing = run(str(tmp_path / "none.csv"))
    assert missing.exit_code == 2
    assert "cannot be read: no such file" in missing.output
    path = tmp_path / "loop.csv"
    pd.DataFrame({"strain [m]": [1.0, 2.0], "force [N]": [1.0, 2.0]}).to_csv(path, index=False)
    wrong_column = run(str(path), "--force", "load")
    assert "there is no column 'load'" in wrong_column.output
    assert "strain [m], force [N]" in wrong_column.output
