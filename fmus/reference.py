"""Reference results of all blocks.

python -m fmus.reference     writes fmus/<block>/reference/*.csv
"""

from __future__ import annotations

from importlib import import_module

from .describe.experiment import Experiment, write
from .names import NAMES

EXPERIMENTS: dict[str, Experiment] = {
    name: import_module(f"{__package__}.{name}.experiment").EXPERIMENT for name in NAMES
}

if __name__ == "__main__":
    for experiment in EXPERIMENTS.values():
        experiment.folder.mkdir(exist_ok=True)
        for name, table in experiment.tables().items():
            write(table, experiment.folder / f"{name}.csv")
