"""A block is a folder of `fmus`: no other file has to name it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu
from python_process import run_script

import fmus

PACKAGE = Path(fmus.__file__).parent

DAMPER = {
    "README.md": "# damper\n\n    (1)  F = -c v\n",
    "__init__.py": 'from .block import Damper\n\n__all__ = ["Damper"]\n',
    "block.py": """
from ..describe.block import Block
from ..describe.variables import Input, Output, Parameter


class Damper(Block):
    name = "damper"
    description = "Damper between a moving end and the ground"
    parameters = (Parameter("rate", "N.s/m", "Damping", minimum=0.0, default=10.0),)
    inputs = (Input("vy", "m/s", "Velocity of the moving end", start=2.0),)
    outputs = (Output("force_y", "N", "Force on the moving end"),)

    def output(self, x, u, p, d, lookup):
        return {"force_y": -p["rate"] * u["vy"]}  # (1)
""",
    "experiment.py": """
import numpy as np

from ..describe.experiment import TIMES, Experiment, held
from .block import Damper


def solve(values):
    return held({"vy": 3.0}), {"time": TIMES, "force_y": np.full(51, -3.0 * values["rate"])}


EXPERIMENT = Experiment(Damper, "A steady velocity. Results: by hand.", 1e-12, solve)
""",
}

BUILD = """
from pathlib import Path

from fmus import BLOCKS
from fmus.describe.experiment import write
from fmus.export import build
from fmus.export.python import build_python
from fmus.reference import EXPERIMENTS

experiment = EXPERIMENTS["damper"]
experiment.folder.mkdir()
for name, table in experiment.tables().items():
    write(table, experiment.folder / f"{name}.csv")
build(Path("out"), ["damper"])
build_python("damper", Path("out"))
print(*BLOCKS)
"""


def test_a_folder_with_equations_becomes_fmus(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "fmus", ignore=shutil.ignore_patterns("built", "__py*"))
    folder = tmp_path / "fmus" / "damper"
    shutil.copytree(PACKAGE / "wheelrail", folder, ignore=shutil.ignore_patterns("*.py", "*.csv"))
    shutil.rmtree(folder / "reference")
    for name, text in DAMPER.items():
        (folder / name).write_text(text)
    said = run_script(BUILD, tmp_path, path=str(tmp_path))
    assert said.split() == [*fmus.BLOCKS, "damper"]
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "damper.fmu", "damper_fmi3.fmu", "damper_python.fmu",
    }  # fmt: skip
    for name in ("damper", "damper_fmi3"):
        run = simulate_fmu(str(tmp_path / "out" / f"{name}.fmu"), stop_time=0.01, step_size=1e-3)
        np.testing.assert_array_equal(run["force_y"], -20.0)


def test_models_and_ready_fmus_are_reached_without_casadi(tmp_path):
    heavy = ("casadi", "pint", "scipy", "xarray")
    script = "import fmus.model\nfrom fmus.catalogue import fmu_path\nprint(fmu_path('truck').name)"
    found = run_script(script, tmp_path, hidden=heavy, path=str(PACKAGE.parent))
    assert found.split() == ["truck.fmu"]
