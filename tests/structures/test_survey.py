"""Measured modes come in as they were measured, from tables and from Universal files."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
import pyuff

from structures.errors import StructureError
from structures.single_mode import fit, quadrature_peaks
from structures.survey_files import read_survey

FREQUENCIES, DAMPINGS = (5.0, 9.0), (0.01, 0.02)
SHAPES = np.array([[1.0, 0.5, -1.0], [1.0, -0.8, 1.0]])
LINES = np.arange(1.0, 15.0, 0.02)

TABLE = """mode, frequency [Hz], damping [%], point, at_x [in], at_y, at_z, y, z
twist, 5.32, 1.2, sill, 100, 0, 0, 0.1, 0.5
twist, 5.32, 1.2, roof, -100, 0, 1, 0.2,
sway, 17.64, 1.5, sill, 100, 0, 0, 1, 0
"""


def accelerance(force: int) -> np.ndarray:
    """Of two modes at three points, (lines, points); a force at a point."""
    s = 2j * pi * LINES
    found = 0.0
    for f, zeta, shape in zip(FREQUENCIES, DAMPINGS, SHAPES, strict=True):
        w = 2 * pi * f
        found = found + np.outer(s**2 / (s**2 + 2 * zeta * w * s + w**2), shape[force] * shape)
    return found


@pytest.fixture
def functions(tmp_path):
    """Writes transfer functions as a Universal file, with what a test changes in each dataset."""

    def write(kind: int = 12, **changes):
        values = accelerance(0) / (2j * pi * LINES[:, None]) ** {12: 0, 11: 1, 8: 2}[kind]
        sets = [
            {
                "type": 58, "binary": 0, "func_type": 4, "func_id": 1, "ver_num": 0,
                "load_case_id": 0, "rsp_ent_name": "NONE", "rsp_node": node, "rsp_dir": -3,
                "ref_ent_name": "NONE", "ref_node": 1, "ref_dir": 3, "abscissa_spacing": 1,
                "ordinate_spec_data_type": kind, "orddenom_spec_data_type": 13,
                "x": LINES, "data": values[:, node - 1],
            }
            for node in (1, 2, 3)
        ]  # fmt: skip
        sets[-1].update(changes)
        file = pyuff.UFF(str(tmp_path / "survey.uff"))
        file.write_sets(sets, mode="overwrite")
        return tmp_path / "survey.uff"

    return write


def test_one_mode_is_fitted_exactly_when_it_is_alone():
    s = 2j * pi * LINES
    w = 2 * pi * 6.0
    single = 0.3 * s**2 / (s**2 + 0.03 * w * s + w**2) + 0.07
    found = fit(LINES, single[:, None], quadrature_peaks(LINES, single[:, None])[0])
    assert found.frequency == pytest.approx(6.0, rel=1e-9)
    assert found.damping == pytest.approx(0.015, rel=1e-7)
    assert found.residues == pytest.approx([0.3], rel=1e-7)


@pytest.mark.parametrize("kind", [12, 11, 8])
def test_transfer_functions_give_modes_whatever_was_measured(functions, kind):
    survey = read_survey(functions(kind))
    assert survey.frequencies == pytest.approx(FREQUENCIES, rel=1e-3)
    assert [mode.damping for mode in survey.modes] == pytest.approx(DAMPINGS, rel=0.02)
    shapes = -survey.shapes[:, :, 2]  # measured against Z
    for found, shape in zip(shapes, SHAPES, strict=True):
        assert found / found[0] == pytest.approx(shape / shape[0], abs=0.02)
    assert np.isnan(survey.shapes[:, :, :2]).all()


def test_noise_is_no_mode(functions):
    noise = 2e-3 * np.random.default_rng(3).normal(size=(2, len(LINES)))
    path = functions(data=accelerance(0)[:, 2] + noise[0] + 1j * noise[1])
    assert read_survey(path).frequencies == pytest.approx(FREQUENCIES, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": LINES + 1.0}, r"survey\.uff, dataset 3 of 3 \(kind 58, line \d+\).*same lines"),
        ({"data": np.abs(accelerance(0)[:, 2])}, "dataset 3 of 3.*is complex"),
        ({"ordinate_spec_data_type": 2}, "dataset 3.*8 \\(displacement\\)"),
        ({"rsp_dir": 0}, "dataset 3.*direction 0"),
    ],
)
def test_a_function_that_cannot_be_read_is_named(functions, change, message):
    with pytest.raises(StructureError, match=message):
        read_survey(functions(**change))


def modes_file(path, **changes):
    sets = [
        {"type": 164, "units_code": 7, "length": 39.37007874015748, "force": 0.2248, "temp": 1.8,
         "temp_offset": 459.67},
        {"type": 15, "node_nums": [4, 7], "def_cs": [0, 0], "disp_cs": [0, 0], "color": [0, 0],
         "x": [100.0, -100.0], "y": [0.0, 0.0], "z": [0.0, 10.0]},
        {"type": 55, "analysis_type": 2, "data_ch": 2, "spec_data_type": 12, "load_case": 1,
         "mode_n": 1, "freq": 5.32, "modal_damp_vis": 0.012, "node_nums": [4, 7],
         "r1": np.zeros(2), "r2": np.array([0.1, 0.2]), "r3": np.array([0.5, 0.0]), **changes},
    ]  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")
    return path


def test_modes_of_a_universal_file_have_their_units_and_what_was_not_measured(tmp_path):
    survey = read_survey(modes_file(tmp_path / "modes.unv"))
    assert survey.modes[0].frequency == pytest.approx(5.32)
    assert survey.modes[0].damping == pytest.approx(0.012)
    assert survey.modes[0].basis == "measured"
    assert [p.name for p in survey.points] == ["4", "7"]
    assert survey.points[1].position == pytest.approx([-2.54, 0.0, 0.254], rel=1e-5)
    assert np.isnan(survey.shapes[0, :, 0]).all() and survey.shapes[0, 0, 2] == 0.5


def test_complex_modes_are_turned_to_real_ones(tmp_path):
    w = 2 * pi * 6.0
    phase = np.exp(0.7j)
    path = modes_file(
        tmp_path / "complex.unv", analysis_type=3, eig=w * (-0.02 + 1j),
        r1=np.zeros(2) * phase, r2=np.array([1.0, -2.0]) * phase, r3=np.array([1.0, 3.0]) * phase,
    )  # fmt: skip
    survey = read_survey(path)
    assert survey.modes[0].frequency == pytest.approx(6.0, rel=1e-3)
    assert survey.modes[0].damping == pytest.approx(0.02, rel=1e-3)
    shape = survey.shapes[0, :, 1:3] / survey.shapes[0, 0, 1]
    assert shape == pytest.approx(np.array([[1.0, 1.0], [-2.0, 3.0]]), rel=1e-5)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: text.replace("5.32000e+00", "0.00000e+00"), "dataset 3.*0 Hz"),
        (lambda text: text.replace("5.00000e-01", "  five      "), "dataset 3 of 3.*cannot be"),
        (lambda text: text.rstrip()[:-6], "line 12.*no end"),
        (lambda text: "frequency 5.32 Hz\n", "no dataset"),
    ],
)
def test_a_spoilt_universal_file_is_refused_in_words(tmp_path, spoil, message):
    path = modes_file(tmp_path / "modes.uff")
    path.write_text(spoil(path.read_text()))
    with pytest.raises(StructureError, match=message):
        read_survey(path)


def test_a_table_may_leave_out_what_was_not_measured(tmp_path):
    (tmp_path / "survey.csv").write_text(TABLE)
    survey = read_survey(tmp_path / "survey.csv")
    assert survey.frequencies == pytest.approx([5.32, 17.64])
    assert survey.modes[0].damping == pytest.approx(0.012)
    assert survey.points[0].x == pytest.approx(2.54)
    assert np.isnan(survey.shapes[0, 1, 2]) and np.isnan(survey.shapes[1, 1]).all()
    assert survey.shapes[0, 0, [1, 2]] == pytest.approx([0.1, 0.5])
    assert [mode.basis for mode in survey.modes] == ["measured"] * 2


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: text.replace("0.5\n", "half\n"), "survey.csv, row 2: z is 'half'"),
        (lambda text: text.replace("sway, 17.64", "sway, 0"), "sway has the frequency 0 Hz"),
        (lambda text: text.replace("1, 0\n", ",\n"), "sway moves no point"),
        (lambda text: text.replace("frequency [Hz]", "f"), "'f' is no column"),
    ],
)
def test_a_spoilt_table_is_refused_in_words(tmp_path, spoil, message):
    (tmp_path / "survey.csv").write_text(spoil(TABLE))
    with pytest.raises(StructureError, match=message):
        read_survey(tmp_path / "survey.csv")


def test_a_file_of_another_kind_is_refused(tmp_path):
    with pytest.raises(StructureError, match=r"modes\.xlsx is no file of a survey"):
        read_survey(tmp_path / "modes.xlsx")
    with pytest.raises(StructureError, match="cannot be read"):
        read_survey(tmp_path / "missing.csv")
    with pytest.raises(StructureError, match="cannot be read"):
        read_survey(tmp_path / "missing.uff")


def test_a_hundred_noisy_functions_give_each_mode_once(tmp_path):
    """Noise puts several peaks on one mode; they are told from modes by the mode's own width."""
    rng, values = np.random.default_rng(7), accelerance(0)
    base = {
        "type": 58, "binary": 0, "func_type": 4, "func_id": 1, "ver_num": 0, "load_case_id": 0,
        "rsp_ent_name": "NONE", "ref_ent_name": "NONE", "ref_node": 1, "ref_dir": 3,
        "abscissa_spacing": 1, "ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13,
        "x": LINES,
    }  # fmt: skip
    sets = []
    for node in range(1, 101):
        noise = 1.0 + 0.2 * rng.normal(size=len(LINES))
        data = values[:, node % 3] * noise
        sets.append({**base, "rsp_node": node, "rsp_dir": 3, "data": data})
    pyuff.UFF(str(tmp_path / "many.uff")).write_sets(sets, mode="overwrite")
    survey = read_survey(tmp_path / "many.uff")
    assert survey.frequencies == pytest.approx(FREQUENCIES, rel=2e-3)
    assert survey.shapes.shape == (2, 100, 6)
