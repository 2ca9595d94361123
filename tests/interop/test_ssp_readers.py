"""The exported hopper car in tools that know nothing of this project: FMPy, libcosim, ecos, pyssp.

Of these only FMPy's reader takes enumerations in parameter sets; libcosim ends the process and ecos
refuses. So the archive of the others leaves out what the FMUs start with anyway (`changes_only`).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tolerances
from orchestrator import System, simulate
from orchestrator.ssp import write_ssp
from support.engines import differences, run_archive, unavailable
from support.tools import need
from tracktrain.car.hopper import hopper_car

STEPS = (2.5e-4, 1.25e-4)
MILLISECONDS = 300
WATCHED = ("wheelset_11.y_rel", "truck_rear.axle[2].yaw", "carbody.front.y", "carbody.cg.ay")


@pytest.fixture(scope="module")
def system() -> System:
    """Another car, speed and seed than the FMUs start with."""
    return hopper_car("empty", speed=24.384, track="report", seed=5)


@pytest.fixture(scope="module")
def archive(system, tmp_path_factory) -> Path:
    return write_ssp(system, tmp_path_factory.mktemp("ssp") / "hopper.ssp", changes_only=True)


@pytest.fixture(scope="module")
def in_orchestrator(system) -> dict[float, np.ndarray]:
    values = {}
    for step in STEPS:
        done = simulate(
            system, duration=MILLISECONDS * 1e-3, step=step, master="jacobi", record=WATCHED
        )
        every = round(1e-3 / step)
        values[step] = np.array([done.dataset[name].values[every::every] for name in WATCHED]).T
    return values


@pytest.mark.parametrize("engine", ["libcosim", "ecos"])
def test_an_engine_runs_the_archive_as_the_jacobi_master_does(engine, archive, in_orchestrator):
    """One is late by a step where outputs feed through; without that both are the same."""
    lacking = unavailable(engine)
    need(lacking is None, str(lacking))
    there = {
        step: run_archive(engine, archive, WATCHED, step, MILLISECONDS, round(1e-3 / step))
        for step in STEPS
    }
    coarse, fine = (differences(there[step], in_orchestrator[step]) for step in STEPS)
    assert coarse / fine == pytest.approx(2.0, rel=tolerances.FIRST_ORDER)
    one, other = (2.0 * runs[STEPS[1]] - runs[STEPS[0]] for runs in (there, in_orchestrator))
    assert (differences(one, other) < tolerances.SAME_LIMIT).all()


def test_fmpy_reads_the_archive_by_the_schema(system, tmp_path):
    """FMPy checks it against the standard's schema, and finds all elements and connections."""
    from fmpy.ssp.ssd import read_ssd

    read = read_ssd(str(write_ssp(system, tmp_path / "whole.ssp"))).system
    assert [element.name for element in read.elements] == [*system.components]
    assert {
        (f"{c.startElement}.{c.startConnector}", f"{c.endElement}.{c.endConnector}")
        for c in read.connections
    } == {(c.source, c.target) for c in system.connections}


def test_pyssp_reads_the_archive_of_either_version(system, tmp_path):
    from pyssp_standard.ssp import SSP

    for version in ("1.0", "2.0"):
        path = write_ssp(system, tmp_path / f"whole-{version}.ssp", version=version)
        with SSP(path) as ssp, ssp.system_structure as ssd:
            assert [component.name for component in ssd.system.elements] == [*system.components]
            assert len(ssd.connections()) == len(system.connections)
