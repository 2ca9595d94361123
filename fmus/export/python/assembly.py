"""The archive of an FMU in Python: sources under a hashed name, slave, binaries, documentation."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from string import Template

from ...describe.variables import Values
from ..archive import NO_GUID, guid, write_archive
from ..xml.fmi2 import Interface
from .sources import PYTHONFMU, Sources

SCRIPT = Path(__file__).with_name("script.txt")
BINARIES = {"linux64": "libpythonfmu-export.so", "win64": "pythonfmu-export.dll"}

ABILITIES = {
    "needsExecutionTool": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "maxOutputDerivativeOrder": "0",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "false",
}
"""pythonfmu's binary refuses directional derivatives and rates of inputs without asking Python."""


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
        for content in _binaries("").values():
            digest.update(content)
        return f"{self.identifier}_{digest.hexdigest()[:12]}"

    @property
    def script(self) -> str:
        """The slave's source."""
        lines = ["{", *(f"        {n!r}: {v!r}," for n, v in self.start.items()), "    }"]
        imports = (f"from {self.name}_sources.{m} import {c}\n" for m, c in self.imports.items())
        return Template(SCRIPT.read_text()).substitute(
            name=self.name,
            module=self.module,
            model=self.model,
            imports="".join(imports),
            slave=f"{self.model}_{self.name.rpartition('_')[2]}",
            start_values="\n".join(lines),
            create=self.create,
        )

    @property
    def interface(self) -> Interface:
        """What the model description says of the binary."""
        return Interface("CoSimulation", {"modelIdentifier": self.identifier, **ABILITIES})


def write(out: Path, recipe: Recipe, description: str, accompanying: Mapping[str, bytes]) -> Path:
    """Write the archive into the folder. accompanying: documentation and the like, by place."""
    name = recipe.name
    own = guid(hashlib.sha256((name + description).encode()).hexdigest())
    files: dict[str, bytes] = {
        "modelDescription.xml": description.replace(NO_GUID, own).encode(),
        "documentation/externalDependencies.txt": _dependencies(recipe.sources).encode(),
        "documentation/licenses/pythonfmu.txt": _licence_of("pythonfmu").encode(),
        "resources/slavemodule.txt": name.encode(),
        f"resources/{name}.py": recipe.script.encode(),
        **_binaries(recipe.identifier),
        **accompanying,
    }
    for place, content in recipe.sources.files.items():
        files[f"resources/{name}_sources/{place}"] = content
    files.setdefault(f"resources/{name}_sources/__init__.py", b'"""Sources of this FMU."""\n')
    path = out / f"{recipe.identifier}.fmu"
    write_archive(path, files)
    return path


def _binaries(identifier: str) -> dict[str, bytes]:
    """pythonfmu's libraries, which know nothing of any model, by their place in the archive."""
    folder = PYTHONFMU / "resources" / "binaries"
    return {
        f"binaries/{system}/{identifier}{Path(file).suffix}": (folder / system / file).read_bytes()
        for system, file in BINARIES.items()
    }


def _licence_of(package: str) -> str:
    """Text of an installed package's licence."""
    files = importlib.metadata.files(package) or []
    file = next(file for file in files if file.name == "LICENSE")
    return file.read_text()


def _dependencies(sources: Sources) -> str:
    """What has to be there where the FMU runs."""
    distributions = importlib.metadata.packages_distributions()
    major, minor, _ = platform.python_version_tuple()
    lines = [
        f"Python {major}.{minor} or later, in the process that loads the FMU: a Python program, or",
        "one that has loaded libpython (on Linux LD_PRELOAD=libpython3.x.so does; on Windows",
        "python3.dll has to be on the PATH). There is no binary for macOS.",
        "",
        "Packages, with the versions that the FMU was made with:",
    ]
    for module in sorted(sources.installed):
        package = distributions.get(module, [module])[0]
        lines.append(f"{package} {importlib.metadata.version(package)}")
    return "\n".join(lines) + "\n"
