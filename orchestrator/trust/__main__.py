"""`python -m orchestrator.trust ASKED ANSWERED`: the process of self-tests; `tested` starts it.

It tests the FMUs that a file asks for; each result is a line of the other.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from ..slaves.isolated.lifeline import end_with_parent
from ..system.encoding import decode
from .self_test import self_test

if __name__ == "__main__":
    end_with_parent()
    asked, answered = map(Path, sys.argv[1:])
    for component in decode(json.loads(asked.read_text())):
        found = self_test(component)
        with answered.open("a") as stream:
            stream.write(json.dumps(asdict(found)) + "\n")
