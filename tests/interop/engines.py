"""A system run by libcosim and by ecos, in a process of its own: they share nothing with ours."""

from __future__ import annotations

import importlib
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from fmpy import read_model_description

Link = tuple[str, str, str, str]
"""Source instance and variable, target instance and variable."""


def run(
    engine: str,
    fmus: dict[str, Path],
    links: Sequence[Link],
    watched: Sequence[str],
    step: float,
    rows: int,
    every: int = 1,
) -> np.ndarray:
    """Values [row, watched] of "instance.variable" after each `every` steps [s]."""
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawned) as pool:
        job = {"libcosim": _libcosim, "ecos": _ecos}[engine]
        return pool.submit(job, fmus, links, watched, step, rows, every).result()


def unavailable(engine: str) -> str | None:
    """What an engine needs that is not here."""
    try:
        importlib.import_module({"libcosim": "libcosimpy.CosimExecution", "ecos": "ecospy"}[engine])
    except ImportError as error:
        return f"{engine}'s wheel ({error})"
    except OSError as error:
        return f"{engine}'s library, and Debian's libtbb12 for it ({error})"
    return None


def _libcosim(
    fmus: dict[str, Path],
    links: Sequence[Link],
    watched: Sequence[str],
    step: float,
    rows: int,
    every: int,
) -> np.ndarray:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    reference = {
        (instance, variable.name): variable.valueReference
        for instance, path in fmus.items()
        for variable in read_model_description(str(path)).modelVariables
    }
    execution = CosimExecution.from_step_size(round(step * 1e9))
    index = {
        instance: execution.add_local_slave(CosimLocalSlave(str(path), instance))
        for instance, path in fmus.items()
    }
    for source, output, target, port in links:
        status = execution.connect_real_variables(
            index[source], reference[source, output], index[target], reference[target, port]
        )
        assert status == 0, f"{source}.{output} cannot be connected to {target}.{port}"
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    values = np.empty((rows, len(watched)))
    for row in range(rows):
        assert execution.step(every)
        for column, name in enumerate(watched):
            instance, _, variable = name.partition(".")
            place = [reference[instance, variable]]
            values[row, column] = observer.last_real_values(index[instance], place)[0]
    return values


def _ecos(
    fmus: dict[str, Path],
    links: Sequence[Link],
    watched: Sequence[str],
    step: float,
    rows: int,
    every: int,
) -> np.ndarray:
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    for instance, path in fmus.items():
        structure.add_model(instance, str(path))
    for source, output, target, port in links:
        structure.make_real_connection(f"{source}::{output}", f"{target}::{port}")
    names = [name.replace(".", "::", 1) for name in watched]  # an instance's name has no dot
    values = np.empty((rows, len(names)))
    with EcosSimulation(structure=structure, step_size=step) as simulation:
        simulation.init()
        for row in range(rows):
            simulation.step(every)
            values[row] = [simulation.get_real(name) for name in names]
    return values
