"""The car on real profiles: what its verdict knows of them, and what it does in a run."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator import simulate
from tracktrain.answer.standing import standing
from tracktrain.car.hopper import HOPPER, hopper_car, layout_of
from tracktrain.car.wheelsets import with_profiles
from tracktrain.cli.main import main
from tracktrain.options.chosen import Shape, chosen_car
from tracktrain.profiles.pairing import contact_table
from tracktrain.scales import MILE_PER_HOUR

CURVE = """kind,length [m],radius [m],direction,cant [mm]
straight,60,,,
transition,60,,,
curve,100,90,left,75
"""


@pytest.mark.slow
def test_the_critical_speed_of_a_run_is_that_of_its_profiles(tmp_path):
    coned = hopper_car("loaded", "40 mph", "perfect")
    worn, _ = with_profiles(coned, contact_table("worn", "crown"))
    stands = [standing(simulate(car, duration=0.1, step=1e-3).dataset) for car in (coned, worn)]
    found = [stand.critical / MILE_PER_HOUR for stand in stands]
    assert found[0] == pytest.approx(37.7, abs=0.1)
    assert found[1] > found[0] + 5.0  # arcs that centre the wheelset, beside a cone
    assert stands[1].unknown == ()
    asked = ["run", "--wheel", "worn", "--rail", "crown", "--duration", "1s", "--track", "fra4"]
    law = ["--set", "*.creep_law=linear"]
    result = CliRunner().invoke(main, [*asked, *law, "--speed", "40 mph", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert f"({found[1]:.3g} mph)" in result.output
    said = " ".join(result.output.split())
    assert "numbers of the loaded car as it ran have a range" in said
    assert "conicity" in said.partition("count as known")[0] and "cones" not in said


@pytest.mark.slow
def test_a_car_whose_wheels_change_sides_makes_the_mirrored_run():
    """On perfect track, where nothing else is unlike left and right."""
    runs = []
    for left, right in (("worn", "conical"), ("conical", "worn")):
        table = contact_table(left, "crown", right=(right, None))
        car, _ = with_profiles(hopper_car("loaded", "30 mph", "perfect"), table)
        law = {axle.wheelset: {"creep_law": "polach"} for axle in layout_of(car).axles}
        runs.append(simulate(car.with_values(law), duration=2.0, step=1e-3).dataset)
    one, other = runs
    for name in ("force_y", "moment_z", "y_rel"):
        found, mirrored = (run[f"wheelset_11.{name}"].values for run in (one, other))
        assert np.abs(found + mirrored).max() <= 1e-12 * np.abs(found).max() > 0
    assert float(one["wheelset_11.y_rel"][-1]) > 1e-4  # towards the wheel of less radius


@pytest.mark.slow
def test_smaller_wheels_on_the_right_have_the_car_run_to_the_right():
    """To where the rolling radii are equal: half the difference over the taper of both cones."""
    radius, less, taper = 0.4191, 0.4e-3, 1 / 20
    shape = {"wheel": "conical", "rail": "crown", "track": "perfect"}
    car = chosen_car(Shape(speed=10.0, right_radius=radius - less, **shape))
    run = simulate(car, duration=40.0, record="*.y_rel", every=10).dataset
    for axle in HOPPER.axles:
        middle = float(run[f"{axle.wheelset}.y_rel"][-400:].mean())
        assert middle == pytest.approx(-less / (2 * taper), rel=2e-3)


@pytest.mark.slow
def test_a_wheel_climbs_in_a_tight_curve_at_any_speed(tmp_path):
    """The outer wheel's L/V in a curve of 90 m, which 15 mph balance, is no less at 10 mph."""
    curve = tmp_path / "curve.csv"
    curve.write_text(CURVE)
    largest = []
    for speed in (15 * MILE_PER_HOUR, 10 * MILE_PER_HOUR):
        car = chosen_car(
            Shape(speed=speed, wheel="worn", rail="crown", track="perfect", layout=curve)
        )
        run = simulate(car, duration=car.experiment.stop, record="*.l_over_v", every=5).dataset
        largest.append(float(run["wheelset_11.right.l_over_v"].max()))
    assert largest[0] > 0.5
    assert largest[1] > 0.99 * largest[0]
