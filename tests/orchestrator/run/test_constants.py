"""What FMUs calculate of their parameters stands in the results, whoever runs them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from orchestrator import Component, Provenance, System, monolith, simulate
from orchestrator.errors import SlaveError
from orchestrator.slaves.base import Slave
from support.variants import variant

HALF_WHEELBASE = 34 * 0.0254
"""Of the truck in the set `loaded` [m]."""

RUNS = {"cosimulated": simulate, "as one": monolith}


def truck(folder: Path, fmi: str = "2.0") -> System:
    """A truck that says that it calculates its half wheelbase."""

    def calculated(description: str) -> str:
        kind, end = ("ScalarVariable", "</ScalarVariable>") if fmi == "2.0" else ("Float64", "/>")
        own = re.search(f'<{kind} name="half_wheelbase".*?{end}', description, re.DOTALL)
        assert own is not None
        changed = own[0].replace('"parameter"', '"calculatedParameter"')
        changed = re.sub(' start="[^"]*"', "", changed.replace('"exact"', '"calculated"'))
        return description.replace(own[0], changed)

    return System({"truck": Component(variant(folder, "truck", calculated, fmi=fmi))})


def constants(run) -> dict[str, float]:
    return Provenance.of(run.dataset).constants


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("way", RUNS)
def test_results_have_what_an_fmu_calculates_of_its_parameters(tmp_path, way, fmi):
    run = RUNS[way](truck(tmp_path, fmi), duration=0.01)
    assert run.completed, run.message
    assert constants(run) == {"truck.half_wheelbase": pytest.approx(HALF_WHEELBASE, rel=1e-12)}


@pytest.mark.parametrize("way", RUNS)
@pytest.mark.parametrize("found", [np.nan, np.inf, None], ids=["nan", "infinite", "refused"])
def test_what_is_no_number_or_cannot_be_read_is_left_out(tmp_path, monkeypatch, way, found):
    own = Slave.get_reals

    def read(slave, variables):
        if all(v.causality != "calculatedParameter" for v in variables):
            return own(slave, variables)
        if found is None:
            raise SlaveError("it is not told")
        return np.full(len(variables), found)

    monkeypatch.setattr(Slave, "get_reals", read)
    run = RUNS[way](truck(tmp_path), duration=0.01)
    assert run.completed, run.message
    assert constants(run) == {}
    assert "constants" not in run.dataset.attrs
