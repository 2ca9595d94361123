"""FMUs in processes of their own: one that crashes, hangs or babbles ends the run, not the program.

`block` is the memory that both processes share, `adaptors` are FMI's functions on the side of the
masters, `slave` is the instance as the orchestrator sees it, `worker` the process behind it. It is
no defence against an FMU that means harm: its process may do whatever the user may.
"""

from __future__ import annotations

from .slave import IsolatedSlave

__all__ = ["IsolatedSlave"]
