"""The models that `tracktrain new` starts, for the tests."""

from __future__ import annotations

import importlib.util
from importlib.resources import files
from pathlib import Path
from typing import Any

STARTS = {
    "wheelrail": ("my_creep", "wheelset_11"),
    "carbody": ("my_body", "carbody"),
    "truck": ("my_truck", "truck_front"),
    "track": ("my_track", "track"),
}
"""By block: what a user may call a model, and an instance of the car that it can replace."""


def template(block: str) -> Any:
    """An instance of a template's model."""
    path = Path(str(files("tracktrain") / "templates" / block / "my_model.py"))
    spec = importlib.util.spec_from_file_location(f"template_{block}", path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.MyModel()
