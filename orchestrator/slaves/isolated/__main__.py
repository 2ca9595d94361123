"""`python -m orchestrator.slaves.isolated`: a worker; `slave` starts it."""

from __future__ import annotations

import sys

from .worker import main

if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
