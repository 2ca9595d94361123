"""Builds the two small native FMUs of `slaves/slave.c`, and FMUs that are wrong in some way."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from functools import cache
from pathlib import Path

import fmpy

SOURCE = Path(__file__).parent / "slaves" / "slave.c"

UNITS = """<UnitDefinitions><Unit name="N.s/m"><BaseUnit kg="1" s="-1"/></Unit>
<Unit name="wagonload"><BaseUnit kg="1" factor="80000"/></Unit></UnitDefinitions>
<TypeDefinitions><SimpleType name="Kind"><Enumeration>
<Item name="plain" value="1"/><Item name="fancy" value="2"/></Enumeration></SimpleType>
</TypeDefinitions>"""


def variable(name: str, causality: str, value: str, more: str = "") -> str:
    return f'<ScalarVariable name="{name}" causality="{causality}" {more}>{value}</ScalarVariable>'


def body(variables: list[str], structure: str) -> str:
    """Variables numbered from 0, and which outputs depend on what."""
    numbered = [
        text.replace(" causality", f' valueReference="{n}" causality', 1)
        for n, text in enumerate(variables)
    ]
    return (
        f"<ModelVariables>{''.join(numbered)}</ModelVariables>"
        f"<ModelStructure><Outputs>{structure}</Outputs></ModelStructure>"
    )


FIXED = 'variability="fixed"'
MASS = body(
    [
        variable("force", "input", '<Real unit="N" start="0"/>'),
        variable("force_per_v", "input", '<Real unit="N.s/m" start="0"/>'),
        variable("x", "output", '<Real unit="m"/>'),
        variable("v", "output", '<Real unit="m/s" derivative="3"/>', 'description="velocity"'),
        variable("m", "parameter", '<Real unit="kg" start="1"/>', FIXED),
        variable("start_v", "parameter", '<Real unit="m/s" start="0" max="100"/>', FIXED),
        variable("time_of_failure", "parameter", '<Real unit="s" start="1e9"/>', FIXED),
    ],
    '<Unknown index="3" dependencies=""/><Unknown index="4" dependencies=""/>',
)
DAMPER = body(
    [
        variable("v", "input", '<Real unit="m/s" start="0"/>'),
        variable("force", "output", '<Real unit="N"/>'),
        variable("c", "parameter", '<Real unit="N.s/m" start="0"/>', 'variability="tunable"'),
        variable("kind", "parameter", '<Enumeration declaredType="Kind" start="1"/>', FIXED),
        variable("locked", "parameter", '<Boolean start="false"/>', FIXED),
    ],
    '<Unknown index="2" dependencies="1"/>',
)
TANGENT = (
    '<VendorAnnotations><Tool name="tracktrain"><Coupling>'
    '<Tangent input="force" output="v" partial="force_per_v"/>'
    "</Coupling></Tool></VendorAnnotations>"
)


def description(variables: str, guid: str = "slave", version: str = "2.0", extra: str = "") -> str:
    return (
        f'<fmiModelDescription fmiVersion="{version}" modelName="Slave" guid="{guid}">'
        f'<CoSimulation modelIdentifier="slave" canInterpolateInputs="true" '
        f'canHandleVariableCommunicationStepSize="true" providesDirectionalDerivative="true"/>'
        f"{UNITS}{extra}{variables}</fmiModelDescription>"
    )


def library(folder: Path, *flags: str, source: Path = SOURCE) -> Path:
    """A shared library in a folder. flags: of the compiler."""
    path = folder / f"slave{fmpy.sharedLibraryExtension}"
    path.write_bytes(_compiled(source, flags))
    return path


@cache
def _compiled(source: Path, flags: tuple[str, ...]) -> bytes:
    compiler = ["cc"] if shutil.which("cc") else [sys.executable, "-m", "ziglang", "cc"]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "library"
        command = [*compiler, "-O2", "-w", "-fPIC", "-shared", *flags, source, "-o", path]
        subprocess.run(command, check=True)
        return path.read_bytes()


def archive(path: Path, text: str | None, binary: Path | None, folder: str | None = None) -> Path:
    """An FMU of a description and a binary, either of which may be missing."""
    with zipfile.ZipFile(path, "w") as fmu:
        if text is not None:
            fmu.writestr("modelDescription.xml", text)
        if binary is not None:
            fmu.write(binary, f"binaries/{folder or fmpy.platform}/{binary.name}")
    return path


def build_mass(folder: Path) -> Path:
    return archive(folder / "mass.fmu", description(MASS, extra=TANGENT), library(folder, "-DMASS"))


def build_damper(folder: Path) -> Path:
    return archive(folder / "damper.fmu", description(DAMPER), library(folder))


FUNCTIONS = re.compile(r"\b(fmi2\w+)\(")

PREFIXED = """\
#define JOINED_(one, other) one##other
#define JOINED(one, other) JOINED_(one, other)
#ifdef FMI2_FUNCTION_PREFIX
{names}
#endif
#define {kind}
{source}"""


def with_sources(fmu: Path, kind: str) -> Path:
    """The FMU with its C sources, whose functions have a prefix where one is defined."""
    source = SOURCE.read_text()
    named = re.findall(r"(?:ACCEPTED|REFUSED)\((fmi2\w+)\)", source) + FUNCTIONS.findall(source)
    names = "\n".join(
        f"#define {name} JOINED(FMI2_FUNCTION_PREFIX, {name})" for name in dict.fromkeys(named)
    )
    listed = '<SourceFiles><File name="slave.c"/></SourceFiles></CoSimulation>'
    with zipfile.ZipFile(fmu) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    text = files.pop("modelDescription.xml").decode()
    head, _, rest = text.partition("<CoSimulation ")
    attributes, _, rest = rest.partition("/>")
    with zipfile.ZipFile(fmu, "w") as archive:
        archive.writestr("modelDescription.xml", f"{head}<CoSimulation {attributes}>{listed}{rest}")
        archive.writestr("sources/slave.c", PREFIXED.format(names=names, kind=kind, source=source))
        for name, content in files.items():
            archive.writestr(name, content)
    return fmu
