"""The archive of an FMU in Python: a package under a hashed name, binaries, documentation."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import platform
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from string import Template

from ...describe.variables import Values
from ..archive import NO_GUID, guid, write_archive
from ..code import NATIVE
from ..compiler import FLAGS, Target, compile_library, targets
from ..xml.fmi2 import Interface
from .sources import Sources

SCRIPT = Path(__file__).with_name("script.txt")
BRIDGE = Path(__file__).with_name("bridge")
"""The binary's source, which knows nothing of any model."""

ABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}
"""Python is a library that the FMU needs, see externalDependencies.txt, and no execution tool."""


@dataclass(frozen=True)
class Recipe:
    """What goes into an archive. identifier: its modelIdentifier, and its file's name.

    module, model: where the sources have the class to import; create: expression of an instance.
    imports: further names for that expression, by their module. start: parameter values [SI].
    """

    identifier: str
    sources: Sources
    module: str
    model: str
    create: str
    start: Values
    imports: Mapping[str, str]

    @property
    def name(self) -> str:
        """A name that no other FMU has: it ends on a hash of all that the FMU computes with."""
        digest = hashlib.sha256(SCRIPT.read_bytes())
        said = (self.identifier, self.module, self.model, self.create, sorted(self.imports.items()))
        digest.update(json.dumps([*said, dict(self.start)]).encode())
        for place, content in sorted(self.sources.files.items()):
            digest.update(place.encode() + b"\0" + content)
        return f"{self.identifier}_{digest.hexdigest()[:12]}"

    @property
    def script(self) -> str:
        """The slave's source."""
        lines = ["{", *(f"        {n!r}: {v!r}," for n, v in self.start.items()), "    }"]
        imports = (f"from .{m} import {c}\n" for m, c in self.imports.items())
        return Template(SCRIPT.read_text()).substitute(
            module=self.module,
            model=self.model,
            imports="".join(imports),
            start_values="\n".join(lines),
            create=self.create,
        )

    @property
    def interface(self) -> Interface:
        """What the model description says of the binary."""
        return Interface("CoSimulation", {"modelIdentifier": self.identifier, **ABILITIES})


def write(
    out: Path,
    recipe: Recipe,
    description: str,
    accompanying: Mapping[str, bytes],
    platforms: Iterable[str],
) -> Path:
    """Write the archive into the folder. accompanying: documentation and the like, by place.

    platforms: those whose binaries it holds, as for native FMUs. Raises CompileError.
    """
    name, bridge = recipe.name, _bridge_sources()
    said = repr((name, description, sorted(bridge.items()), FLAGS))
    own = guid(hashlib.sha256(said.encode()).hexdigest())
    files: dict[str, bytes] = {
        "modelDescription.xml": description.replace(NO_GUID, own).encode(),
        "documentation/externalDependencies.txt": _dependencies(recipe.sources).encode(),
        "resources/model.txt": f"{name}\n{own}\n".encode(),
        f"resources/{name}/__init__.py": recipe.script.encode(),
        **accompanying,
    }
    for target in targets(platforms):
        place = f"binaries/{target.folder('2.0')}/{recipe.identifier}{target.suffix}"
        files[place] = _bridge(target)
    for place, content in recipe.sources.files.items():
        files[f"resources/{name}/{place}"] = content
    path = out / f"{recipe.identifier}.fmu"
    write_archive(path, files)
    return path


def _bridge_sources() -> dict[str, str]:
    """C files of the binary by name."""
    files = [*BRIDGE.glob("*.[ch]"), NATIVE / "fmi2.h", NATIVE / "visible.h"]
    lines = (BRIDGE / "bootstrap.py").read_text().splitlines()
    text = "\n".join(f"    {json.dumps(line + chr(10))}" for line in lines)
    own = {"bootstrap.h": f"static const char BOOTSTRAP[] =\n{text};\n"}
    return own | {path.name: path.read_text() for path in sorted(files)}


@cache
def _bridge(target: Target) -> bytes:
    """The binary for a platform; it is the same in every FMU."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, text in _bridge_sources().items():
            (folder / name).write_text(text)
        library = folder / f"model_in_python{target.suffix}"
        compile_library(sorted(folder.glob("*.c")), library, target, libraries=("dl",))
        return library.read_bytes()


def _dependencies(sources: Sources) -> str:
    """What has to be there where the FMU runs."""
    distributions = importlib.metadata.packages_distributions()
    major, minor, _ = platform.python_version_tuple()
    lines = [
        f"Python {major}.{minor} or later: that of the program that loads the FMU, if it is a",
        "Python program; else the shared library of the python3 that is on the PATH (on Windows",
        "python3.dll there), with the packages of that Python.",
        "",
        "Packages, with the versions that the FMU was made with:",
    ]
    for module in sorted(sources.installed):
        package = distributions.get(module, [module])[0]
        lines.append(f"{package} {importlib.metadata.version(package)}")
    return "\n".join(lines) + "\n"
