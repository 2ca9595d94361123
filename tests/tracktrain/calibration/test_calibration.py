"""Parameters from measurements: recovered from synthetic ones, with intervals that hold."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator import simulate
from tracktrain import hopper_car
from tracktrain.calibration import Asked, calibrate, write_calibration
from tracktrain.calibration.chosen import Chosen
from tracktrain.calibration.evidence import Group
from tracktrain.calibration.features import Lines
from tracktrain.calibration.fitting import fit
from tracktrain.calibration.told import remarks, told
from tracktrain.car.changes import changed
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import name_of
from tracktrain.cli.main import main
from tracktrain.correlation.channels import sensor
from tracktrain.correlation.history import Band
from tracktrain.errors import TracktrainError
from tracktrain.options.chosen import Shape

TRUE = {
    "carbody.yaw_inertia": 1.15e6,
    "carbody.lateral_bending_frequency": 8.7,
    "carbody.modal_damping": 0.02,
    "truck.bolster_roll.friction_stiffness": 4.0e7,
    "truck.warp.stiffness": 3.4e6,
}
SPEED = 13.716


@dataclass(eq=False)
class Line:
    """y = rows @ at, measured with noise."""

    rows: np.ndarray
    measured: np.ndarray
    groups: list[Group] = field(init=False)

    def __post_init__(self):
        self.groups = [Group("line", (len(self.measured),), 0.1, False, "plain")]

    def residuals(self, at):
        return [self.rows @ at - self.measured]

    def slopes(self, at):
        return [self.rows]


def test_intervals_cover_the_truth_as_often_as_they_say():
    random, true = np.random.default_rng(5), np.array([2.0, -1.0])
    rows = random.standard_normal((60, 2))
    chosen = [Chosen("a", "a", ("x.a",), "1", 1.5), Chosen("b", "b", ("x.b",), "1", -0.7)]
    inside = []
    for _ in range(200):
        measured = rows @ true + 0.3 * random.standard_normal(60)
        bounds = fit(chosen, [Line(rows, measured)]).interval(0.9)
        inside += list((bounds[:, 0] < true) & (true < bounds[:, 1]))
    assert np.mean(inside) == pytest.approx(0.9, abs=0.05)  # 400 numbers: 3 deviations


def test_two_parameters_of_which_only_the_sum_is_seen_are_named():
    rows = np.ones((40, 2)) * np.linspace(1.0, 2.0, 40)[:, None]
    measured = rows @ [2.0, 3.0] + 0.01 * np.random.default_rng(1).standard_normal(40)
    chosen = [Chosen(n, n, (f"x.{n}",), "N", 2.4, 0.0, 9.0) for n in ("a", "b")]
    fitted = fit(chosen, [Line(rows, measured)])
    assert fitted.values.sum() == pytest.approx(5.0, rel=1e-2)
    assert any("tell only the sum of a and b" in said for said in remarks(fitted))


def test_a_small_number_beside_a_large_one_is_named_with_it_and_neither_is_told():
    rows = np.ones((40, 2))
    measured = 3.4 + 0.01 * np.random.default_rng(1).standard_normal(40)
    starts = {"a": 0.4, "b": 3.1}
    chosen = [Chosen(n, n, (f"x.{n}",), "N", v, 0.0, 9.0) for n, v in starts.items()]
    fitted = fit(chosen, [Line(rows, measured)])
    assert any("tell only the sum of a and b" in said for said in remarks(fitted))
    assert told(fitted) == [False, False]


def test_lines_of_a_measured_spectrum_outside_the_band_do_not_count():
    at = np.arange(1.0, 61.0)
    lines = Lines.given("a", sensor("x.a"), "m", at, np.ones(60), Band(5.0, 30.0))
    assert lines.frequency[[0, -1]].tolist() == [5.0, 30.0]


def test_an_estimate_far_from_what_was_known_is_said():
    rows = np.ones((40, 1))
    chosen = [Chosen("a", "a", ("x.a",), "N", 1.0, 0.0, 9.0, 1.0, 0.1)]
    fitted = fit(chosen, [Line(rows, np.full(40, 2.0) + 0.01 * np.arange(40) % 0.02)])
    assert any("deviations from what was known of it" in said for said in remarks(fitted))


@pytest.fixture(scope="module")
def survey(tmp_path_factory):
    """Frequencies and damping ratios of a car with other numbers, without noise."""
    linear, usual = (
        LinearCar("loaded", {n.partition(".")[2]: v for n, v in TRUE.items()}),
        LinearCar(),
    )
    roots, _ = linear.modes(SPEED)
    shapes = usual.modes(SPEED)[1]
    names = [name_of(usual, shapes[:, k]) for k in range(10)]
    lines = ["quantity,of,value,unit"]
    for k, name in enumerate(names):
        place = f" {names[: k + 1].count(name)}" if names.count(name) > 1 else ""
        lines.append(f"frequency,{name}{place},{roots[k].imag / 2 / np.pi:.10g},Hz")
        lines.append(f"damping,{name}{place},{-100 * roots[k].real / abs(roots[k]):.10g},%")
    file = tmp_path_factory.mktemp("survey") / "modes.csv"
    file.write_text("\n".join(lines) + "\n")
    return file


@pytest.mark.slow
def test_five_parameters_come_back_from_frequencies_and_damping(survey, tmp_path):
    ranges = ["carbody.lateral_bending_frequency=8:10 Hz"]
    found = calibrate(Asked([survey], list(TRUE), ranges, shape=Shape(speed=SPEED)), tmp_path)
    for name, value in TRUE.items():
        assert found.parameters.loc[name, "estimate"] == pytest.approx(value, rel=2e-3)
    written = write_calibration(found, tmp_path, "five", "modes.csv")
    said = tomllib.loads((tmp_path / "calibrated.toml").read_text())
    assert float(said["set"]["truck_rear.warp.stiffness"].split()[0]) == pytest.approx(3.4e6, 2e-3)
    assert all(path.stat().st_size > 0 for path in written)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--parameter", "truck.warp.stifness"], "did you mean warp.stiffness"),
        ([], "no parameter is to be estimated"),
        (["--parameter", "carbody.body_mass", "--range", "carbody.body_mass=5:4 t"], "is empty"),
        (
            ["--parameter", "carbody.body_mass", "--range", "carbody.body_mass=1:2 m"],
            "measures another thing",
        ),
        (
            ["--parameter", "carbody.body_mass", "--prior", "carbody.yaw_inertia=1 +- 1 kg.m2"],
            "of no parameter that is estimated",
        ),
    ],
)
def test_what_cannot_be_asked_is_answered_in_a_sentence(survey, arguments, message, tmp_path):
    given = ["calibrate", str(survey), *arguments, "--out", str(tmp_path)]
    result = CliRunner().invoke(main, given)
    assert result.exit_code != 0 and message in " ".join(result.output.split())


def test_a_mode_that_the_car_has_not_is_answered_with_those_it_has(tmp_path):
    file = tmp_path / "modes.csv"
    file.write_text("quantity,of,value,unit\nfrequency,bounce and whirl,1.0,Hz\n")
    with pytest.raises(TracktrainError, match="no mode 'bounce and whirl'"):
        calibrate(Asked([file], ["carbody.body_mass"]), tmp_path / "out")


@pytest.mark.slow
def test_five_parameters_come_back_within_2_percent_from_a_minute_with_2_percent_noise(tmp_path):
    true = {
        "truck.warp.stiffness": 3.4e6,
        "wheelrail.conicity": 0.055,
        "wheelrail.longitudinal_creep_coefficient": 6.6e6,
        "carbody.yaw_inertia": 1.15e6,
        "carbody.lateral_bending_frequency": 8.7,
    }
    follower = {"wheelrail.lateral_creep_coefficient": 6.6e6}
    car = changed(hopper_car("loaded", "45 ft/s", "fra5", 3), true | follower)
    names = ["carbody.cg.ay", "carbody.cg.az", "wheelset_11.y_rel", "carbody.cg.yaw"]
    run = simulate(car, duration=60.0, record=names, every=5).dataset
    random, columns = np.random.default_rng(1), [run.time.values]
    for name in names:
        values = run[name].values
        columns.append(values + 0.02 * values.std() * random.standard_normal(len(values)))
    units = [f"{n} [{run[n].attrs['units']}]" for n in names]
    file = tmp_path / "test.csv"
    head = ",".join(["time [s]", *units])
    np.savetxt(file, np.column_stack(columns), "%.9g", ",", header=head, comments="")
    shape = Shape(speed=SPEED, track="fra5", seed=3)
    found = calibrate(Asked([file], list(true), shape=shape), tmp_path / "out")
    for name, value in true.items():
        estimate, low, high = found.parameters.loc[name, ["estimate", "95 % from", "95 % to"]]
        assert estimate == pytest.approx(value, rel=0.02)
        assert low < high and abs(estimate - value) < 2.0 * (high - low)
