"""Runs against measured files: the same car and another, noise, gaps, clocks, units, channels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from scipy.signal import cont2discrete, decimate, lfilter

from support.tools import need
from tracktrain.cli.main import main
from tracktrain.correlation import Correlation, correlate
from tracktrain.errors import TracktrainError

try:
    import asammdf
except ImportError:
    asammdf = None
try:
    import pyuff
except ImportError:
    pyuff = None

RATE, DURATION = 400.0, 60.0
GRAVITY = 9.80665
MAP = ("acc = carbody.cg.ay", "yaw = carbody.cg.yaw")


def ride(frequency: float, seed: int = 1, damping: float = 0.1) -> dict[str, np.ndarray]:
    """A body on a spring over random track: acceleration and yaw."""
    track = np.random.default_rng(seed).standard_normal(int(DURATION * RATE))
    omega = 2 * np.pi * frequency
    system = ([omega**2], [1.0, 2 * damping * omega, omega**2])
    b, a, _ = cont2discrete(system, 1 / RATE, "zoh")
    y = lfilter(b.ravel(), a, track)
    slow = lfilter([0.05], [1, -0.95], y)
    return {"carbody.cg.ay": 0.01 * slow, "carbody.cg.yaw": 1e-3 * lfilter([0.1], [1, -0.9], slow)}


def run(folder: Path, **of: Any) -> Path:
    """The folder of a run of such a body."""
    folder.mkdir()
    units = {"carbody.cg.ay": "m/s2", "carbody.cg.yaw": "rad"}
    signals = {n: ("time", v, {"units": units[n]}) for n, v in ride(**of).items()}
    time = np.arange(int(DURATION * RATE)) / RATE
    xr.Dataset(signals, {"time": time}).to_netcdf(folder / "results.nc", engine="netcdf4")
    return folder


Writer = Callable[..., Path]


@pytest.fixture
def logged(tmp_path: Path) -> Writer:
    """Writes what a logger of 100 samples a second has of a body, in g and rad."""

    def write(
        of: dict[str, Any],
        noise: float = 0.0,
        offset: float = 0.0,
        gap: tuple[float, float] = (0, 0),
        header: str = "time [s],acc [g],yaw [rad],speed [km/h]",
        gain: float = 1.0,
    ) -> Path:
        ay, yaw = (decimate(v, 4, ftype="fir") for v in ride(**of).values())
        random = np.random.default_rng(9)
        ay = gain * (ay + noise * ay.std() * random.standard_normal(len(ay))) / GRAVITY
        time = np.arange(len(ay)) / 100.0
        kept = (time < gap[0]) | (time >= gap[1])
        rows = np.column_stack([time + offset, ay, yaw, 0 * ay + 65.0])[kept]
        path = tmp_path / "test.csv"
        np.savetxt(path, rows, "%.8g", ",", header=f"# a test\n{header}", comments="")
        return path

    return write


def said(found: Correlation) -> str:
    return "\n".join(found.notes)


def test_the_same_car_agrees_and_another_is_told_apart(tmp_path: Path, logged: Writer) -> None:
    folder = run(tmp_path / "a", frequency=2.0)
    same = correlate([folder], logged({"frequency": 2.0}, noise=0.05), MAP)
    assert same.verdicts["verdict"].tolist() == ["agrees", "agrees"]
    assert (same.ratings["overall"] > 0.94).all()
    other = correlate([folder], logged({"frequency": 2.6}, noise=0.05), MAP)
    assert "told apart" in other.verdicts["verdict"].tolist()


def test_on_another_track_the_same_car_agrees_by_statistics_alone(
    tmp_path: Path, logged: Writer
) -> None:
    folder = run(tmp_path / "a", frequency=2.0)
    same = correlate([folder], logged({"frequency": 2.0, "seed": 5}), MAP)
    assert same.verdicts["verdict"].tolist() == ["agrees", "agrees"]
    assert same.ratings.empty and "statistics are compared, not times" in said(same)
    other = correlate([folder], logged({"frequency": 2.0, "seed": 5, "damping": 0.02}), MAP)
    assert "told apart" in other.verdicts["verdict"].tolist()


def test_offset_gap_noise_and_spare_channels_are_said(tmp_path: Path, logged: Writer) -> None:
    file = logged({"frequency": 2.0}, noise=0.3, offset=3.21, gap=(20.0, 22.5))
    found = correlate([run(tmp_path / "a", frequency=2.0)], file, MAP)
    text = said(found)
    assert "clock shows 3.21 s later" in text
    assert "a gap of 2.51 s in all, the longest from 23.2 to 25.71 s" in text
    assert "acc: noise of about" in text and "yaw: noise" not in text
    assert "left out: speed" in text
    assert found.verdicts["verdict"].tolist() == ["agrees", "agrees"]


def test_a_column_in_the_wrong_unit_is_suspected(tmp_path: Path, logged: Writer) -> None:
    file = logged({"frequency": 2.0}, header="time [s],acc [m/s^2],yaw [rad],speed [km/h]")
    found = correlate([run(tmp_path / "a", frequency=2.0)], file, MAP)
    assert "as when g and m/s² are mixed up" in said(found)


def test_a_sensor_that_is_turned_is_suspected(tmp_path: Path, logged: Writer) -> None:
    file = logged({"frequency": 2.0}, gain=-1.0)
    found = correlate([run(tmp_path / "a", frequency=2.0)], file, MAP[:1])
    assert "the sign is opposite" in said(found)


def test_a_sensor_away_from_the_centre_of_gravity_has_the_yaw(
    tmp_path: Path, logged: Writer
) -> None:
    folder = run(tmp_path / "a", frequency=2.0)
    file = logged({"frequency": 2.0})
    centre, away = (
        correlate([folder], file, [f"acc = {text}"], clock="shared").numbers.loc["acc"]
        for text in ("carbody.cg.ay", "carbody.ay at x=20ft")
    )
    signals = ride(frequency=2.0)
    time = np.arange(int(DURATION * RATE)) / RATE
    turned = np.gradient(np.gradient(signals["carbody.cg.yaw"], time), time)
    expected = np.std(signals["carbody.cg.ay"] + 20 * 0.3048 * turned)
    assert centre["a"].iloc[0] == pytest.approx(np.std(signals["carbody.cg.ay"]), rel=0.01)
    assert away["a"].iloc[0] == pytest.approx(expected, rel=0.05)


def test_several_runs_are_judged_one_by_one_and_together(tmp_path: Path, logged: Writer) -> None:
    places = [run(tmp_path / f"seed{n}", frequency=2.0, seed=n) for n in (2, 3)]
    places.append(run(tmp_path / "soft", frequency=1.4, seed=4))
    found = correlate(places, logged({"frequency": 2.0}), MAP[:1], clock="apart")
    assert found.verdicts["verdict"].tolist() == ["agrees", "agrees", "told apart"]
    assert "agrees with 2 of 3 runs" in said(found)


@pytest.mark.parametrize(
    ("header", "given", "message"),
    [
        ("time [s],acc,yaw [rad],speed [1]", MAP, "the column 'acc' has no unit"),
        ("time [s],acc [kN],yaw [rad],speed [1]", MAP, "is in kN, and carbody.cg.ay in m/s2"),
        ("time [s],acc [gee],yaw [rad],speed [1]", MAP, "write it like m/s\\^2, g, mm or kN"),
        ("acc [g],time [s],yaw [rad],speed [1]", MAP, "must name the columns"),
        ("time [s],acc [g],acc [rad],speed [1]", MAP, "two columns are named 'acc'"),
        ("time [m],acc [g],yaw [rad],speed [1]", MAP, "no unit of time"),
        ("time [s],acc [g],yaw [rad]", MAP, "has 4 cells, and the first line 3"),
        (None, ["accc = carbody.cg.ay"], "no channel 'accc'; did you mean acc"),
        (None, ["acc = carbody.cg.az"], "run a has no signal 'carbody.cg.az'"),
        (None, ["acc"], "write --channel 'COLUMN = SIGNAL'"),
        (None, ["acc = carbody.ay at x=long"], "the place in"),
        (None, ["acc = carbody.roll at x=1m"], "a sensor at a place has"),
        (None, [], "say which is which, such as --channel 'acc = carbody.cg.ay'"),
    ],
)
def test_what_does_not_fit_is_named_at_both_ends(
    tmp_path: Path, logged: Writer, header: str | None, given: list[str], message: str
) -> None:
    folder = run(tmp_path / "a", frequency=2.0)
    file = logged({"frequency": 2.0}, **({"header": header} if header else {}))
    with pytest.raises(TracktrainError, match=message):
        correlate([folder], file, given)


def test_a_band_above_the_sampling_is_refused(tmp_path: Path, logged: Writer) -> None:
    folder, file = run(tmp_path / "a", frequency=2.0), logged({"frequency": 2.0})
    with pytest.raises(TracktrainError, match="a band to 60 Hz needs 240 samples a second"):
        correlate([folder], file, MAP, band=(None, 60.0))


def test_decimal_commas_and_empty_cells_are_read(tmp_path: Path) -> None:
    time = np.arange(0.0, 60.0, 0.01)
    ay = decimate(ride(frequency=2.0)["carbody.cg.ay"], 4, ftype="fir")
    rows = [
        f"{t:.2f};{v:.7f}" if not 10 < t < 11 else f"{t:.2f};"
        for t, v in zip(time, ay, strict=True)
    ]
    file = tmp_path / "logger.csv"
    text = "\n".join(["Time (s);acc (m/s²)", *rows]).replace(".", ",")
    file.write_text(text, encoding="latin-1")
    found = correlate([run(tmp_path / "a", frequency=2.0)], file, MAP[:1])
    assert found.verdicts["verdict"].tolist() == ["agrees"]
    assert "a gap of" in said(found)


def test_a_universal_file_gives_what_a_table_gives(tmp_path: Path, logged: Writer) -> None:
    need(pyuff, "pyuff")
    folder, table = run(tmp_path / "a", frequency=2.0), logged({"frequency": 2.0})
    time, acc = np.loadtxt(table, delimiter=",", skiprows=2, usecols=(0, 1)).T
    dataset = {
        "type": 58, "binary": 0, "func_type": 1, "func_id": 1, "ver_num": 0, "load_case_id": 0,
        "id1": "acc", "rsp_ent_name": "NONE", "rsp_node": 4, "rsp_dir": 2,
        "ref_ent_name": "NONE", "ref_node": 1, "ref_dir": 3, "ord_data_type": 4,
        "abscissa_spacing": 1, "abscissa_min": 0.0, "abscissa_inc": 0.01, "num_pts": len(time),
        "abscissa_spec_data_type": 17, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 0,
        "ordinate_axis_units_lab": "g", "x": time, "data": acc,
    }  # fmt: skip
    pyuff.UFF(str(tmp_path / "test.uff")).write_sets([dataset], "overwrite")
    found = [correlate([folder], f, MAP[:1]).numbers for f in (table, tmp_path / "test.uff")]
    assert found[1].to_numpy() == pytest.approx(found[0].to_numpy(), rel=1e-4, nan_ok=True)


def test_an_mdf_file_gives_what_a_table_gives(tmp_path: Path, logged: Writer) -> None:
    need(asammdf, "asammdf")
    folder, table = run(tmp_path / "a", frequency=2.0), logged({"frequency": 2.0})
    time, acc = np.loadtxt(table, delimiter=",", skiprows=2, usecols=(0, 1)).T
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(acc, time, name="acc", unit="g")])
        file.append(
            [asammdf.Signal(np.array([b"on", b"off"]), time[:2], name="state", encoding="utf-8")]
        )
        file.save(tmp_path / "test.mf4")
    found = [correlate([folder], f, MAP[:1]).numbers for f in (table, tmp_path / "test.mf4")]
    assert found[1].to_numpy() == pytest.approx(found[0].to_numpy(), rel=1e-9, nan_ok=True)


def test_a_file_that_is_none_by_its_name_or_content_is_refused(
    tmp_path: Path, logged: Writer
) -> None:
    folder = run(tmp_path / "a", frequency=2.0)
    for name, message in (
        ("test.xlsx", "is no file of measurements by its name"),
        ("none.csv", "there is no file"),
        ("empty.csv", "has no rows below a line that names the columns"),
        ("test.mf4", "cannot be read as MDF|MDF files need asammdf"),
    ):
        if not name.startswith("none"):
            (tmp_path / name).write_text("")
        with pytest.raises(TracktrainError, match=message):
            correlate([folder], tmp_path / name, MAP)


def test_the_command_writes_a_page_with_the_forms_of_the_report(
    tmp_path: Path, logged: Writer
) -> None:
    folder, file = run(tmp_path / "a", frequency=2.0), logged({"frequency": 2.0})
    out = tmp_path / "out"
    told = CliRunner().invoke(
        main, ["correlate", str(folder), str(file), "--channel", MAP[0], "--out", str(out)]
    )
    assert told.exit_code == 0, told.output
    assert "agrees" in told.output and "excellent" in told.output
    page = (out / "correlation.html").read_text()
    assert "://" not in page
    for title in ("Measured with rms and peak", "Power spectral density", "Coherence", "Histogram"):
        assert title in page
    alone = CliRunner().invoke(main, ["correlate", str(file)])
    assert alone.exit_code == 2 and "name one run or more, and then the file" in alone.output
