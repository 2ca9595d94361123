"""The commands, one a file."""

from __future__ import annotations

from ..group import in_files

COMMANDS = in_files(__file__, __name__)
