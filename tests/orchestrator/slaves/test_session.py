"""A session keeps FMUs loaded: the runs are those of FMUs loaded anew, to the last bit."""

from __future__ import annotations

import numpy as np

from orchestrator import Session, simulate
from tracktrain.car.hopper import hopper_car


def test_runs_of_a_session_equal_runs_that_load_anew():
    first, second = hopper_car(seed=1), hopper_car("empty", speed=30.0, seed=2)
    disturbed = first.with_value("truck_front.initial.yaw", 0.01)
    with Session() as session:
        for system in (disturbed, second, first):
            kept = simulate(system, duration=0.5, session=session)
            assert np.array_equal(kept.record, simulate(system, duration=0.5).record)


def test_instances_are_loaded_once(monkeypatch):
    from orchestrator.slaves import session as module

    loaded = []
    own = module.load
    monkeypatch.setattr(module, "load", lambda name, *a: loaded.append(name) or own(name, *a))
    with Session() as session:
        for seed in range(3):
            simulate(hopper_car(seed=seed), duration=0.01, session=session)
        assert sorted(loaded) == sorted(hopper_car().components)


def test_what_cannot_be_used_again_is_loaded_anew(monkeypatch):
    from orchestrator.slaves.fmi2 import Fmi2Slave

    monkeypatch.setattr(Fmi2Slave, "reset", lambda self: False)
    with Session() as session:
        runs = [simulate(hopper_car(), duration=0.05, session=session) for _ in range(2)]
    assert np.array_equal(runs[0].record, runs[1].record)
