"""`tracktrain run` says how far its answer can be trusted."""

from __future__ import annotations

import re

import xarray as xr
from click.testing import CliRunner

from tracktrain.cli.main import main


def run(*arguments: str) -> str:
    result = CliRunner().invoke(main, ["run", *arguments])
    assert result.exit_code == 0, result.output
    return " ".join(result.output.split())


def coupling(said: str) -> str:
    """What is said of the coupling, up to the next part."""
    rest = said[said.index("Coupling: ") :]
    return re.split(r" (?=(?:Answer|Range|Numbers): )", rest)[0]


def test_a_run_ends_with_its_verdict_which_the_results_keep(tmp_path):
    said = run("--duration", "0.2s", "--out", str(tmp_path))
    verdict = coupling(said)
    assert verdict.startswith("Coupling: good. Energy residual ")
    assert verdict.endswith("the FMUs passed their self-test.")
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert dataset.attrs["verdict"] == verdict
        assert dataset.attrs["largest_stable_step"] > 5e-3


def test_notes_are_of_the_car_and_those_of_the_software_are_for_who_asks(tmp_path):
    how = "inputs follow a tangent of their source"
    given = ["--duration", "0.02s", "--out", str(tmp_path)]
    plain, verbose = run(*given), run(*given, "--verbose")
    assert how not in plain and "largest stable step:" not in plain
    assert how in verbose and "note: largest stable step: about " in verbose
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert how in str(dataset.attrs["notes"])


def test_held_inputs_at_low_speed_are_warned_of_before_and_condemned_after(tmp_path):
    said = run(
        "--duration", "0.07s", "--master", "jacobi", "--speed", "10 ft/s", "--out", str(tmp_path)
    )
    assert "note: largest stable step: about 0.000575 s, by wheelset_" in said
    assert "the step of 0.001 s is 1.7 of it" in said
    assert "(--step 0.29ms or --master one-pass or --master iterated)" in said
    assert "Coupling: bad. The force in wheelset_" in said
    assert "the step is 1.7 of the largest stable one, 0.00058 s, by wheelset_" in said


def test_no_self_test_leaves_the_residual(tmp_path):
    said = run("--duration", "0.2s", "--no-self-test", "--out", str(tmp_path))
    assert "largest stable step" not in said and "self-test" not in said
    assert "Coupling: good. Energy residual " in said


def test_verify_says_how_large_the_error_is(tmp_path):
    said = run(
        "--duration", "0.3s", "--master", "jacobi", "--verify", "--twin", "0.1s",
        "--verify-output", "wheelset_1*.force_y", "--out", str(tmp_path),
    )  # fmt: skip
    verdict = coupling(said)
    assert "error of wheelset_1" in verdict.lower() and re.search(
        r"% of its rms \(order (0\.9|1\.)", verdict
    )
    assert "from the monolithic twin (wheelset_1" in verdict and "first 0.1 s)" in verdict
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert dataset.attrs["verdict"] == verdict.replace(" (--step 0.5ms or --master)", "")
        assert dataset.sizes["time"] == 301


def test_verify_takes_nothing_of_a_run_for_its_slow_twin(tmp_path):
    options = ("--duration", "0.1s", "--verify", "--twin", "0s", "--statistics-from", "0s")
    result = CliRunner().invoke(main, ["run", *options, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.stderr
    assert "twin" not in result.stdout
