"""`python -m orchestrator.trust`: the process of self-tests; `tested` starts it."""

from __future__ import annotations

import sys
from pathlib import Path

from .tested import answer

if __name__ == "__main__":
    answer(*map(Path, sys.argv[1:]))
