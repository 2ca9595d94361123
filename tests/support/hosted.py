"""FMUs stepped through recorded inputs by the program host.c, on whatever platform it is for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import prod
from pathlib import Path
from subprocess import run

import numpy as np
from fmpy import read_model_description

HOSTS = Path(__file__).parent / "hosts"
HOST = HOSTS / "host.c"
AMPLITUDE = {"N": 1e3, "N.m": 1e3, "m": 1e-3, "m/s": 1e-2, "rad": 1e-3, "rad/s": 1e-2}
STEPS = 1000


class Hosted:
    """What host.c is told of an FMU, and the files that it reads and writes in a folder.

    name: of these files. library: name of its file there, "-" if it is linked into the host.
    """

    def __init__(self, fmu: Path, folder: Path, name: str, library: str, prefix: str = "") -> None:
        description = read_model_description(str(fmu))
        listed = description.modelVariables
        inputs = [v for v in listed if v.causality == "input"]
        outputs = [v for v in listed if v.causality == "output"]
        self._values = sum(prod(v.shape or (1,)) for v in outputs)
        self._file = folder / f"outputs-{name}"
        references = np.array([v.valueReference for v in (*inputs, *outputs)], np.uint32)
        references.tofile(folder / f"references-{name}")
        _excitation(inputs).tofile(folder / f"inputs-{name}")
        files = [f"{kind}-{name}" for kind in ("inputs", "references", "outputs")]
        numbers = (STEPS, len(inputs), len(outputs), self._values)
        functions = f"{prefix}fmi{description.fmiVersion[0]}"
        self.arguments = [library, functions, description.guid, *files, *map(str, numbers)]

    def outputs(self) -> np.ndarray:
        """Outputs [SI], (steps, values)."""
        return np.fromfile(self._file).reshape(STEPS, self._values)


def step(
    command: Iterable[object],
    fmus: Iterable[Hosted],
    folder: Path,
    environment: Mapping[str, str] | None = None,
) -> None:
    """Have a host step the FMUs; raises CalledProcessError.

    environment: in it FMU_RESOURCES may name where the FMUs' resources are.
    """
    arguments = [argument for fmu in fmus for argument in fmu.arguments]
    line = [*map(str, command), *arguments]
    run(line, cwd=folder, env=environment, check=True, timeout=300)


def _excitation(inputs: list) -> np.ndarray:
    """Values of the inputs at each step [SI]: start values, and noise on what moves."""
    noise = np.random.default_rng(1980).uniform(-1.0, 1.0, (STEPS, 200))
    sizes = [
        0.0 if "_per_" in v.name or v.name == "speed" else AMPLITUDE.get(v.unit, 0.0)
        for v in inputs
    ]
    return np.array([float(v.start) for v in inputs]) + noise[:, : len(inputs)] * sizes
