"""The commands `tracktrain profile`."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

from tracktrain.cli.main import main


def ran(*words: str):
    return CliRunner().invoke(main, ["profile", *words])


def test_show_tells_and_draws_what_a_pair_does(tmp_path):
    picture = tmp_path / "pair.png"
    result = ran("show", "conical", "crown", "--picture", str(picture))
    assert result.exit_code == 0, result.output
    assert "equivalent conicity at 3 mm (EN 15302, by integration): 0.0523; 0.0500" in result.output
    assert "flange touches at a shift of 8.459 mm" in result.output
    assert picture.stat().st_size > 10_000


def test_show_gives_all_contacts_as_json(tmp_path):
    picture = tmp_path / "pair.png"
    sides = ("--right-radius", "418.6 mm", "--inclination", "1:40,1:40", "--picture", str(picture))
    found = json.loads(ran("show", "conical", "crown", *sides, "--json").output)
    contacts = found["contacts"]
    assert found["conicity_at_3_mm"] == pytest.approx(0.0523, abs=5e-4)
    level = np.interp(0.0, contacts["radius_difference"], contacts["shift"])
    assert level == pytest.approx(-0.5e-3 / (2 * 0.0523), abs=0.3e-3)
    assert found["rolling_line"] == pytest.approx(level, abs=1e-6)
    assert found["right_flange"] == found["flange"]
    assert found["clearance"][0] != found["clearance"][1]
    assert picture.stat().st_size > 10_000
    assert len(contacts["left.radius"]) == len(contacts["shift"]) > 100


def test_show_tells_where_unlike_sides_have_equal_radii():
    result = ran("show", "conical", "crown", "--right-wheel", "worn")
    assert "rolling radii are equal at a shift of -0.483 mm" in result.output, result.output
    assert "right: flange touches at a shift of" in result.output


def test_make_writes_a_profile_in_our_axes(tmp_path):
    out = tmp_path / "mine.csv"
    assert ran("make", str(out), "conical").exit_code == 0
    assert "# profile = wheel\n# y positive = outside\n# z positive = up\ny [mm],z [mm]\n" in (
        out.read_text()
    )


def test_a_pair_that_crosses_is_told_before_anything_else():
    result = ran("show", "conical", "crown", "--gauge", "1300 mm")
    assert result.exit_code != 0
    assert result.output.startswith("Error: conical crosses crown")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("show", "conical", "crown", "--inclination", "steep"), "no inclination; give one such"),
        (("show", "conical", "crown", "--picture", "x.doc"), "is no picture by its ending"),
        (("show", "missing.csv", "crown"), "the profile 'missing.csv' cannot be read"),
        (("show", "conical", "crown", "--say", "edge=left"), "--say 'edge=left' cannot be read"),
        (("show", "conical", "crown", "--yaw", "20 deg"), "too large; give 100 mrad at most"),
        (("make", "out.prw", "conical"), "call it 'out.csv'"),
    ],
)
def test_a_mistake_is_answered_in_words(words, message):
    result = ran(*words)
    assert result.exit_code != 0
    assert message in " ".join(result.output.split())
    assert "Traceback" not in result.output
