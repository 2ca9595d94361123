"""FMUs in Python: each block's own, and models in plain Python.

`build_python` writes the Python flavour of a block, `pack` a model that a user has written. Both
put the sources that they need into the archive, and the slave of `fmus.python` around them.
The binary that runs it is compiled of `bridge`.
"""

from __future__ import annotations

from .flavor import build_python, build_python_carbody
from .pack import pack
from .sources import PackError

__all__ = ["PackError", "build_python", "build_python_carbody", "pack"]
