"""What a user of models and ready FMUs loads."""

from __future__ import annotations

from pathlib import Path

import fmus
from fmus.catalogue import folder
from support.python_process import run_script

PACKAGE = Path(fmus.__file__).parent


def test_models_and_ready_fmus_are_reached_without_casadi(tmp_path):
    folder()  # where a wheel has them
    heavy = ("casadi", "pint", "scipy", "xarray")
    script = "import fmus.model\nfrom fmus.catalogue import fmu_path\nprint(fmu_path('truck').name)"
    found = run_script(script, tmp_path, hidden=heavy, path=str(PACKAGE.parent))
    assert found.split() == ["truck.fmu"]
