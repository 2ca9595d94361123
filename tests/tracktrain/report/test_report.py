"""What a run's page holds, read without a browser."""

from __future__ import annotations

import base64
import gzip
import html
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from fmus.carbody.default_data import outlined
from fmus.carbody.modal_data import Point
from orchestrator import Provenance, peak, simulate
from support.coupled_models import oscillator
from support.modal import random_data
from tracktrain.car.hopper import HOPPER
from tracktrain.car.shapes import unit_motions, wire_frame
from tracktrain.cli.main import main
from tracktrain.cli.page_beside import PageBeside
from tracktrain.errors import TracktrainError
from tracktrain.report import page
from tracktrain.report.motion import modes, scene
from tracktrain.report.packing import envelope, envelope_time, packed
from tracktrain.report.series import signals
from tracktrain.results import responses_of
from tracktrain.spectra import spectrum
from tracktrain.statistics import excited
from tracktrain.told import told

TRUCK = {
    "half_wheelbase": 0.86, "half_side_frame_spacing": 0.99, "half_contact_spacing": 0.76,
    "centre_plate_height": 0.65,
}  # fmt: skip


def plain(rows: int = 400) -> xr.Dataset:
    """A run of something that is no car."""
    time = np.arange(rows) / 100
    wave = xr.Variable("time", 3.0 * np.sin(2 * np.pi * 5 * time), {"units": "N"})
    return xr.Dataset({"a.force": wave, "a.<b>": wave * 2}, {"time": time}, {"step": 0.01})


def test_the_page_of_a_system_that_is_no_car_shows_what_it_is() -> None:
    run = simulate(oscillator(), duration=0.3, step=0.01)
    text = html.unescape(page(run.dataset))
    assert "<title>Run of one and other</title>" in text
    for source, target in Provenance.of(run.dataset).connections:
        assert f"<code>{source}</code></th><td><code>{target}</code>" in text
    found = re.search(r"data:image/svg\+xml;base64,([^\"]+)", text)
    assert found is not None
    assert {"one", "other"} <= set(re.findall(r">(\w+)<", base64.b64decode(found[1]).decode()))
    assert 'id="assessment"' not in text and "not applicable" not in text
    assert "Coupling: " in text


def test_motions_of_the_wire_frame_add_up_to_any_shape() -> None:
    rng = np.random.default_rng(3)
    body = outlined(random_data(rng, count=4))
    lines, motions = unit_motions(body, TRUCK)
    shape = rng.normal(size=(5 + 4 + 2 * 6, 2)) @ [1, 1j]
    whole = np.concatenate([line.motion for line in wire_frame(shape, body, TRUCK)])
    summed = np.tensordot(shape, motions, axes=1)
    np.testing.assert_allclose(summed, whole, atol=1e-12)
    assert sum(len(line.points) for line in lines) == motions.shape[1]


def test_the_structure_of_modal_data_is_drawn_edge_by_edge_where_its_points_are() -> None:
    points = [Point("a", 1.0, 0.5, 0.2), Point("b", 2.0, 0.5, 0.2), Point("c", 2.0, 0.0, 0.2)]
    data = random_data(np.random.default_rng(3), points=points)
    data = replace(data, edges=(("a", "b"), ("b", "c"), ("a", "c")))
    lines, motions = unit_motions(data, TRUCK)
    joined, single = (line for line in lines if line.part == "carbody")
    np.testing.assert_allclose(joined.points[2], [2.0, 0.0, 0.2 + 1.4])  # above the plates
    assert len(single.points) == 2
    np.testing.assert_allclose(motions[5:11, 1], data.at("b")[:, 0, :3])  # after five rigid modes


def test_packed_numbers_come_back() -> None:
    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.array([1e-9, -np.pi])}
    index, text = packed(arrays)
    planes = np.frombuffer(gzip.decompress(base64.b64decode(text)), np.uint8).reshape(4, -1)
    numbers = np.ascontiguousarray(planes.T).view("<f4").ravel()
    for name, values in arrays.items():
        part = numbers[index[name]["start"] :][: values.size].reshape(index[name]["shape"])
        np.testing.assert_array_equal(part, values.astype(np.float32))


def test_no_peak_is_lost_in_a_curve_of_few_points() -> None:
    values = np.random.default_rng(4).normal(size=1000)
    values[677] = 50.0
    drawn = envelope(values, 20)
    time = envelope_time(np.arange(1000.0), 20)
    assert len(drawn) == len(time) == 100
    assert drawn.max() == 50.0
    assert time[drawn.argmax()] == pytest.approx(677, abs=20)
    assert np.all(np.diff(time) > 0)


def test_spectrum_has_the_variance_of_the_signal() -> None:
    frequency, density = spectrum(plain(4000)["a.force"].values, 100.0)
    assert np.trapezoid(density, frequency) == pytest.approx(4.5, rel=0.05)
    assert frequency[density.argmax()] == pytest.approx(5.0, abs=0.1)


def test_what_is_at_rest_has_no_spectrum() -> None:
    noise = np.random.default_rng(1).normal(size=4000)
    columns = {"a.held": np.full(4000, 0.1), "carbody.cg.az": 1e-9 * noise, "a.moving": noise}
    data = xr.Dataset(
        {name: ("time", values, {"units": "1"}) for name, values in columns.items()},
        {"time": 0.01 * np.arange(4000)},
    )
    _, arrays, _ = signals(data)
    assert [bool(np.any(density)) for density in arrays["density"]] == [False, False, True]


def test_a_straight_line_is_not_in_the_spectrum() -> None:
    noise = np.random.default_rng(1).normal(size=(2, 4000))
    line = 1e3 + 5.0 * np.arange(4000)
    _, density = spectrum(noise + line, 100.0)
    np.testing.assert_allclose(density, spectrum(noise, 100.0)[1], rtol=1e-6)
    assert density.mean() == pytest.approx(2.0 / 100.0, rel=0.1)


def test_a_page_is_written_though_the_process_for_it_ended(tmp_path: Path) -> None:
    with pytest.raises(TracktrainError, match=r"no results\.nc"), PageBeside() as beside:
        beside.begin(tmp_path, None)
        beside.finish()
    run = simulate(oscillator(), duration=0.3, step=0.01, out=tmp_path)
    with PageBeside() as beside:
        beside._process.kill()
        beside._process.join()
        beside.begin(tmp_path, None)
        beside.finish()
    assert (tmp_path / "report.html").read_text() == page(run.signals)


def test_page_needs_nothing_from_elsewhere() -> None:
    text = page(plain())
    assert "default-src 'none'" in text
    outside = re.sub(r'<script type="text/plain".*?</script>', "", text, flags=re.DOTALL)
    assert not re.search(r"(src|href)=[\"']?(https?:)?//", outside)


def test_what_the_run_is_worth_stands_before_its_curves(hopper_run: Path) -> None:
    text = (hopper_run / "report.html").read_text(encoding="utf-8")
    sections = re.findall(r'<section id="(\w+)"', text)
    ranked = ["numbers", "motion", "assessment", "signals", "spectra", "modes"]
    assert [name for name in sections if name in ranked] == ranked


def test_the_page_has_the_numbers_that_the_run_prints(hopper_run: Path) -> None:
    text = html.unescape((hopper_run / "report.html").read_text(encoding="utf-8"))
    numbers = text.partition('<section id="numbers"')[2].partition("</section>")[0]
    run = responses_of(hopper_run)
    for rows in told(run).values():
        for label, (variable, scale) in rows.items():
            heading = f"{label}, {scale.units}" if scale.unit else label
            line = numbers.partition(f'"row">{heading}</th>')[2].partition("</tr>")[0]
            moved = excited(run[variable], scale.rest)
            said = scale.numbers(peak(run[variable])) if moved else "not excited"
            assert f">{said}" in line, label


def test_of_many_events_the_gravest_are_shown_and_the_others_folded_away() -> None:
    time = np.arange(4001) / 1000
    data = plain(4001).assign_coords(time=time)
    sharp = np.where(time % 0.1 < 0.01, 1.5, 0.0)
    for axle in HOPPER.axles:
        for side in ("left", "right"):
            name = f"{axle.wheelset}.{side}.l_over_v"
            data[name] = xr.Variable("time", sharp, {"units": "1"})
    data["track.distance"] = xr.Variable("time", 20.0 * time, {"units": "m"})
    text = page(data).partition('<section id="events"')[2].partition("</section>")[0]
    shown, _, folded = text.partition("<details>")
    assert shown.count('class="seek"') == 8
    assert folded.count('class="seek"') > 50


def test_page_of_any_system_has_its_signals_and_no_car() -> None:
    text = page(plain())
    found = re.search(r'id="known">(.*?)</script>', text)
    assert found
    known = json.loads(found[1])
    assert [signal["name"] for signal in known["signals"]] == ["a.force", "a.<b>"]
    assert known["signals"][0]["unit"] == "kN"
    assert known["scene"] is None
    assert known["modes"] is None


def test_verdict_and_reason_of_a_stop_are_shown_where_there_are_any() -> None:
    assert 'id="verdict"' not in page(plain())
    said = page(plain().assign_attrs(verdict="trust <it>", stopped="the disk is full"))
    assert "trust &lt;it&gt;" in said
    assert "the disk is full" in said


def test_run_without_rows_is_refused(tmp_path: Path) -> None:
    plain(1).to_netcdf(tmp_path / "results.nc")
    result = CliRunner().invoke(main, ["report", str(tmp_path)])
    assert result.exit_code == 2
    assert "the run has no two rows of any signal; there is nothing to report" in result.stderr


def test_run_writes_its_page_with_all_that_it_is_made_of(hopper_run: Path) -> None:
    text = (hopper_run / "report.html").read_text()
    assert (hopper_run / "report.html").stat().st_size < 10e6
    with xr.open_dataset(hopper_run / "results.nc") as dataset:
        fmus = json.loads(dataset.attrs["fmus"])
        for fmu in fmus.values():
            assert fmu["sha256"] in text
        for note in json.loads(dataset.attrs["notes"]):
            assert html.escape(note) in text
        assert "tracktrain run --duration 1s" in text
        assert "radius of gyration of 41.6 in" in text  # a parameter's source
        assert "truck_rear.car.moment_z * carbody.rear.wz" in text  # a bond
        drawing, arrays = scene(dataset) or pytest.fail("no scene")
        assert arrays["coordinates"].shape == (101, 20)
        assert arrays["way"][-1] == pytest.approx(18.288)
        named, _ = modes(dataset) or pytest.fail("no modes")
        assert any(mode["name"] == "torsion" or "roll" in mode["name"] for mode in named)
        assert drawing["firstAxle"] == pytest.approx((203 + 34) * 0.0254)
