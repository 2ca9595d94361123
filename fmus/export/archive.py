"""The archive of an FMU: a GUID from its content, and the same bytes on every build."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

NO_GUID = "{00000000-0000-0000-0000-000000000000}"
EPOCH = (1980, 1, 1, 0, 0, 0)


def guid(digest: str) -> str:
    """The GUID that the first 32 hexadecimal digits make."""
    h = digest
    return f"{{{h[:8]}-{h[8:12]}-{h[12:16]}-{h[16:20]}-{h[20:32]}}}"


def write_archive(path: Path, files: Mapping[str, bytes]) -> None:
    """Zip with fixed times and order; the file appears whole or not at all. Raises OSError."""
    descriptor, name = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(descriptor, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
            for file in sorted(files, key=lambda name: (name != "modelDescription.xml", name)):
                info = zipfile.ZipInfo(file, date_time=EPOCH)
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = 0o644 << 16
                archive.writestr(info, files[file])
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException as error:
        Path(name).unlink(missing_ok=True)
        if isinstance(error, OSError):  # a full disk does not say of which file it is
            error.filename = str(path)
        raise
