"""`tracktrain structure`: from a model to modal data that `tracktrain carbody` takes."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from fmus.carbody.modal_files import read_modal_data
from support.decks import box, deck
from tracktrain.cli.main import main


def typed(*words):
    return CliRunner().invoke(main, ["structure", *map(str, words)])


def test_a_nastran_model_becomes_modal_data_and_a_picture(tmp_path):
    model, out = deck(tmp_path, box()), tmp_path / "new" / "m.toml"
    said = typed(
        model, "--units", "m, N, s", "--front", 902, "--rear", 202, "--point", "floor=602",
        "--below", "30 Hz", "--damping", 0.02, "-o", out,
    )  # fmt: skip
    assert said.exit_code == 0, said.output
    data = read_modal_data(out)
    assert data.outputs == ("floor",) and max(data.frequencies) < 30.0
    assert {mode.damping for mode in data.modes} == {0.02}
    assert data.half_truck_spacing == pytest.approx(5.25)
    assert "11566" in said.output and "elastic modes" in said.output
    assert (tmp_path / "new" / "m.png").stat().st_size > 10_000


def test_our_hoppers_numbers_are_a_file_to_edit(tmp_path):
    path = tmp_path / "mine.toml"
    assert typed("--write", path).exit_code == 0
    assert "side_wall" in path.read_text()
    assert typed("--write", path).exit_code == 2
    path.write_text(path.read_text().replace("side_wall", "side_wal"))
    said = typed(path, "-o", tmp_path / "m.toml")
    assert said.exit_code == 2 and "side_wall" in said.output


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "give a MODEL"),
        (("none.bdf",), "no such file"),
        (("box.bdf",), "--units"),
        (("box.bdf", "--units", "m, N, s"), "--front"),
        (("box.bdf", "--modes", "3", "--below", "3 Hz"), "not both"),
        (("box.bdf", "--point", "floor"), "floor=1203"),
        (("box.bdf", "--units", "m, N, s", "--refinement", "2"), "takes no refinement"),
        (("box.bdf", "-o", "m.csv"), "TOML"),
    ],
)
def test_what_cannot_be_is_one_message(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    deck(tmp_path, box())
    said = typed(*words)
    assert said.exit_code == 2 and message in said.output
    assert "Traceback" not in said.output
