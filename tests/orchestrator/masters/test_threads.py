"""Threads that step the FMUs of Jacobi at the same time: the same bits, the same ends."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

from orchestrator import Component, Connection, OrchestratorError, System, simulate
from support.coupled_models import oscillator
from support.mishap import mishap
from support.native_slaves import build_damper, build_mass


@pytest.fixture(scope="module")
def chain(tmp_path_factory) -> System:
    """Six masses, each with a damper to the next one's motion."""
    folder = tmp_path_factory.mktemp("chain")
    mass, damper = build_mass(folder), build_damper(folder)
    components, connections = {}, []
    for n in range(6):
        components[f"mass_{n}"] = Component(mass, {"start_v": 1.0 + n, "m": 1.0 + 0.1 * n})
        components[f"damper_{n}"] = Component(damper, {"c": 5.0 + n})
        connections.append(Connection(f"damper_{n}.force", f"mass_{n}.force"))
        connections.append(Connection(f"mass_{(n + 1) % 6}.v", f"damper_{n}.v"))
    return System(components, tuple(connections))


@pytest.mark.parametrize("order", [0, 1])
def test_threads_change_no_bit(chain, order):
    options = {"duration": 0.4, "step": 1e-3, "master": "jacobi", "order": order}
    whole = simulate(chain, **options)
    assert np.ptp(whole.record, axis=0).max() > 0.01
    for threads in (2, 3, 50):
        run = simulate(chain, **options, threads=threads)
        assert run.record.tobytes() == whole.record.tobytes()
        assert f"{min(threads, 12)} threads step the FMUs" in run.notes


def test_a_million_threads_are_no_more_than_the_machine_has_use_for(chain):
    parts = [chain.prefixed(f"part{n}") for n in range(max(4, os.cpu_count() or 1))]
    many = parts[0]
    for part in parts[1:]:
        many = many.joined(part)
    run = simulate(many, duration=0.01, step=1e-3, master="jacobi", threads=1_000_000)
    (note,) = (note for note in run.notes if note.endswith("threads step the FMUs"))
    assert int(note.split()[0]) <= max(16, 4 * (os.cpu_count() or 1)) < len(many.components)


def test_fmu_that_steps_seldom_may_be_in_any_thread(chain):
    slow = replace(chain.components["mass_4"], every=4)
    system = replace(chain, components={**chain.components, "mass_4": slow})
    options = {"duration": 1.0, "step": 1e-3, "master": "jacobi"}
    one, two = (simulate(system, **options, threads=n) for n in (1, 2))
    assert one.record.tobytes() == two.record.tobytes()


@pytest.mark.parametrize("late", [0, 5])
def test_run_that_an_fmu_ends_in_any_thread_ends_as_with_one(chain, late):
    system = chain.with_value(f"mass_{late}.time_of_failure", 0.4995)
    options = {"duration": 1.0, "step": 1e-3, "master": "jacobi"}
    one, two = (simulate(system, **options, threads=n) for n in (1, 2))
    assert one.message is not None and one.message.startswith(f"mass_{late}: fmi2DoStep returned")
    assert two.message == one.message
    assert two.record.tobytes() == one.record.tobytes()


@pytest.mark.skipif(os.name != "posix", reason="isolation needs Linux or macOS")
def test_isolated_fmus_wait_in_threads_of_their_own(tmp_path):
    kinds = {"fine": 0.0, "lost": 1.0}
    fmu = mishap(tmp_path)
    system = System({n: Component(fmu, {"at": 0.045, "kind": k}) for n, k in kinds.items()})
    runs = [
        simulate(
            system, duration=1.0, step=0.01, master="jacobi", isolate=[*kinds], threads=threads
        )
        for threads in (1, 2)
    ]
    assert runs[0].message is not None and runs[0].message.startswith("lost: its process crashed")
    assert runs[1].message == runs[0].message
    assert runs[1].record.tobytes() == runs[0].record.tobytes()


def test_slaves_in_python_stay_in_one_thread(chain):
    mocks = oscillator()
    system = System(
        {**chain.components, **mocks.components}, (*chain.connections, *mocks.connections)
    )
    options = {"duration": 0.1, "step": 1e-3, "master": "jacobi"}
    one, two = (simulate(system, **options, threads=n) for n in (1, 2))
    assert one.record.tobytes() == two.record.tobytes()
    assert "in the first of them, since their FMUs share more than code: one, other" in two.notes
    alone = simulate(mocks, **options, threads=2)
    assert alone.completed and not any("threads" in note for note in alone.notes)


def test_threads_are_for_jacobi():
    for options, message in (
        (
            {"master": "one-pass", "threads": 2},
            "the master 'one-pass' has no option 'threads'; choose jacobi, or leave it out",
        ),
        (
            {"master": "jacobi", "threads": 0},
            "threads cannot be 0: it must be at least 1",
        ),
    ):
        with pytest.raises(OrchestratorError) as caught:
            simulate(oscillator(), duration=1.0, step=0.1, **options)
        assert str(caught.value) == message
