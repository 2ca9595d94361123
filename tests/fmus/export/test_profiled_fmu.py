"""The FMU of a wheelset on profiles: what its archive asks for, and the table in it."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from fmpy import simulate_fmu

from fmus.errors import ParameterError
from fmus.export.wheelrail import build_wheelrail, wheelrail_product
from fmus.wheelrail.contact_table import IN_FMU, as_text, of_text
from support.contact_tables import cone


def test_a_table_comes_back_from_its_text():
    table = cone()
    again = of_text(as_text(table))
    assert as_text(again) == as_text(table)
    with pytest.raises(ParameterError, match="profile build"):
        of_text("patch,over\n")


@pytest.mark.slow
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_its_fmu_meets_what_was_evaluated_by_hand(tmp_path, fmi):
    table = cone()
    path = build_wheelrail(table, tmp_path / "coned.fmu", fmi)
    with zipfile.ZipFile(path) as archive:
        assert of_text(archive.read(IN_FMU).decode()).said == table.said
    known = wheelrail_product(table, "coned").reference.tables
    stimuli, expected = (
        np.genfromtxt(known[name].decode().splitlines(), delimiter=",", names=True, deletechars="")
        for name in ("stimuli", "results")
    )
    names = list(expected.dtype.names)
    found = simulate_fmu(
        str(path),
        stop_time=1.0,
        step_size=1e-3,
        output_interval=1e-3,
        input=stimuli,
        output=names[1:],
    )
    rows = np.searchsorted(found["time"], expected["time"] - 1e-9)
    for name in names[1:]:
        largest = np.abs(expected[name]).max()
        assert found[name][rows] == pytest.approx(expected[name], abs=1e-7 * largest), name
