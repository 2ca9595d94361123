"""A system run by libcosim, in a process of its own: two FMI libraries share nothing there."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from fmpy import read_model_description

Link = tuple[str, str, str, str]
"""Source instance and variable, target instance and variable."""


def run(
    fmus: dict[str, Path], links: Sequence[Link], watched: Sequence[str], step: float, rows: int
) -> np.ndarray:
    """Values [row, watched] of "instance.variable" at each of `rows` milliseconds [SI]."""
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawned) as pool:
        return pool.submit(_run, fmus, links, watched, step, rows).result()


def _run(
    fmus: dict[str, Path], links: Sequence[Link], watched: Sequence[str], step: float, rows: int
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
        assert execution.step(round(1e-3 / step))
        for column, name in enumerate(watched):
            instance, _, variable = name.partition(".")
            place = [reference[instance, variable]]
            values[row, column] = observer.last_real_values(index[instance], place)[0]
    return values
