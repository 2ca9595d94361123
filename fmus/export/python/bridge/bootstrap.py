"""What the binary of a Python FMU runs once: it finds the model in the archive, to instantiate it.

It is part of the binary, and sees nothing but the standard library.
"""

import importlib.util
import os
import re
import sys
import traceback
import urllib.parse
from pathlib import Path

if sys.stdout is not None and hasattr(sys.stdout, "reconfigure"):
    sys.stdout.reconfigure(line_buffering=True)  # a program that is not Python never flushes it


def folder(uri):
    """Path of the folder `resources`, of the bytes of a file URI (RFC 8089), or of a plain path."""
    said = uri.partition(b":")[2] if uri[:5].lower() == b"file:" else uri
    if said.startswith(b"//"):
        host, _, path = said[2:].partition(b"/")
        local = host.lower() in (b"", b"localhost")
        said = b"/" + path if local else said
    for place in (urllib.parse.unquote_to_bytes(said), said):
        if os.name == "nt" and re.match(rb"/[A-Za-z]:", place):
            place = place[1:]
        path = Path(os.fsdecode(place))
        if place and path.is_dir():
            return path
    raise ValueError("there is no folder of resources at " + uri.decode(errors="replace"))


def load(package, resources):
    """The package of the model. Its name holds a hash of its files, so that it is of this FMU.

    It is loaded again when the folder that it came from is gone, because a model may read its data.
    """
    module = sys.modules.get(package)
    if module is not None and Path(module.__file__ or "").exists():
        return module
    forget(package)
    place = resources / package
    spec = importlib.util.spec_from_file_location(
        package, place / "__init__.py", submodule_search_locations=[str(place)]
    )
    assert spec is not None and spec.loader is not None
    module = sys.modules[package] = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        forget(package)
        raise
    return module


def forget(package):
    for name in [n for n in sys.modules if n.partition(".")[0] == package]:
        del sys.modules[name]


def instantiate(uri, guid):
    """An instance, or the bytes of a message that says why there is none."""
    try:
        if sys.version_info < (3, 11):  # noqa: UP036
            raise ValueError("this FMU needs Python 3.11 or later, and here is " + sys.version)
        resources = folder(uri)
        package, own = (resources / "model.txt").read_text(encoding="utf-8").split()
        if guid.decode(errors="replace") != own:
            return (
                b"the GUID differs from the model description's: "
                b"binary and description do not belong together"
            )
        return load(package, resources).Instance()
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        fault = f"{type(error).__name__} in {place.filename}:{place.lineno}: {error}"
        return (str(error) if isinstance(error, ValueError) else fault).encode(errors="replace")
