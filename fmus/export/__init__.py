"""From a block to an FMU: C code, model description, documentation, shared library, archive."""

from __future__ import annotations

from .build import build
from .compiler import CompileError

__all__ = ["CompileError", "build"]
