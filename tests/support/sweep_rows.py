"""What makes rows of a sweep in other processes: it must be found there by its name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any


def squared(options: Mapping[str, Any]) -> dict[str, Any]:
    """The square of a number, and the process; a number below zero takes the process along."""
    if options["number"] < 0:
        os._exit(3)
    return {"units": {}, "square": options["number"] ** 2, "process": os.getpid()}
