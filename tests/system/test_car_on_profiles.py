"""The car on real profiles: what its verdict knows of them, and what it does in a run."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from orchestrator import simulate
from tracktrain.answer.standing import standing
from tracktrain.car.hopper import hopper_car
from tracktrain.car.wheelsets import with_profiles
from tracktrain.cli.main import main
from tracktrain.profiles.pairing import contact_table
from tracktrain.scales import MILE_PER_HOUR


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
    result = CliRunner().invoke(main, [*asked, "--speed", "40 mph", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert f"({found[1]:.3g} mph)" in result.output
