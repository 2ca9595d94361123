"""Systems run by libcosim and by ecos, in a process of its own: they share nothing with ours."""

from __future__ import annotations

import importlib
import multiprocessing
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from fmpy import read_model_description

STEP = 2.0**-10
"""Sums and differences of such times are exact, so that all masters step by the same size."""

STEPS = 200

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
    job = {"libcosim": _libcosim, "ecos": _ecos}[engine]
    return _apart(job, fmus, links, watched, step, rows, every)


def run_archive(
    engine: str, archive: Path, watched: Sequence[str], step: float, rows: int, every: int = 1
) -> np.ndarray:
    """The same of an SSP archive, named as its parameter sets are."""
    job = {"libcosim": _libcosim_archive, "ecos": _ecos_archive}[engine]
    return _apart(job, archive, watched, step, rows, every)


def _apart(job: Callable[..., np.ndarray], *arguments: Any) -> np.ndarray:
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawned) as pool:
        return pool.submit(job, *arguments).result()


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
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.ERROR)
    reference = _references(fmus)
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
    return _observed(execution, index, reference, watched, rows, every)


def _libcosim_archive(
    archive: Path, watched: Sequence[str], step: float, rows: int, every: int
) -> np.ndarray:
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

    log_output_level(CosimLogLevel.ERROR)
    with tempfile.TemporaryDirectory() as folder:  # libcosim reads archives that are unpacked
        with zipfile.ZipFile(archive) as opened:
            opened.extractall(folder)
        execution = CosimExecution.from_ssp_file(folder, round(step * 1e9))
        index = {info.name.decode(): info.index for info in execution.slave_infos()}
        root = ElementTree.parse(Path(folder) / "SystemStructure.ssd")
        fmus = {
            node.attrib["name"]: Path(folder) / node.attrib["source"]
            for node in root.iter()
            if node.tag.endswith("}Component")
        }
        return _observed(execution, index, _references(fmus), watched, rows, every)


def _references(fmus: dict[str, Path]) -> dict[tuple[str, str], int]:
    return {
        (instance, variable.name): variable.valueReference
        for instance, path in fmus.items()
        for variable in read_model_description(str(path)).modelVariables
    }


def _observed(
    execution: Any,
    index: dict[str, int],
    reference: dict[tuple[str, str], int],
    watched: Sequence[str],
    rows: int,
    every: int,
) -> np.ndarray:
    from libcosimpy.CosimObserver import CosimObserver

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
    from ecospy import EcosSimulationStructure

    structure = EcosSimulationStructure()
    for instance, path in fmus.items():
        structure.add_model(instance, str(path))
    for source, output, target, port in links:
        structure.make_real_connection(f"{source}::{output}", f"{target}::{port}")
    return _stepped(watched, rows, every, structure=structure, step_size=step)


def _ecos_archive(
    archive: Path, watched: Sequence[str], step: float, rows: int, every: int
) -> np.ndarray:
    given = {"ssp_path": str(archive), "step_size": step}
    return _stepped(watched, rows, every, archive.stem, **given)


def _stepped(
    watched: Sequence[str], rows: int, every: int, parameters: str | None = None, **given: Any
) -> np.ndarray:
    from ecospy import EcosSimulation

    names = [name.replace(".", "::", 1) for name in watched]  # an instance's name has no dot
    values = np.empty((rows, len(names)))
    with EcosSimulation(**given) as simulation:
        simulation.init(parameter_set=parameters)
        for row in range(rows):
            simulation.step(every)
            values[row] = [simulation.get_real(name) for name in names]
    return values


def differences(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Rms difference over rms value of each column."""
    return np.sqrt(((one - other) ** 2).mean(0) / (other**2).mean(0))
