"""A run of the car with its page."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from tracktrain.cli.main import main


@pytest.fixture(scope="session")
def hopper_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a second of the car, at the report's lowest speed on its track."""
    folder = tmp_path_factory.mktemp("report") / "run"
    options = ["--duration", "1s", "--speed", "60 ft/s", "--track", "report"]
    options += ["--out", str(folder), "--report", "--quiet"]
    result = CliRunner().invoke(main, ["run", *options])
    assert result.exit_code == 0, result.output
    return folder
