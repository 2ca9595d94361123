"""The FMU of a model whose equations are those of other FMUs, compiled into it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..describe.block import Block
from ..describe.variables import Input, Limit, Output, Parameter, Values
from .accompanying import licence
from .archive import NO_GUID
from .build import Contents, identified, write
from .code import frame, variable_counts
from .compiler import FLAGS, targets
from .documentation import documentation
from .xml import fmi2, fmi3
from .xml.description import Dependencies, Interface
from .xml.terminals import terminals_and_icons


@dataclass(frozen=True)
class Able:
    """What the model can do, as FMI's attributes say it."""

    saves_state: bool = True
    serializes_state: bool = True
    variable_step: bool = True
    only_once: bool = False


ALIASED = "-fno-strict-aliasing"
"""Tables in C are words, whatever they hold."""


class Assembly(Block):
    """Variables of such a model. now: by output, the inputs that it depends on at each instant."""

    def __init__(
        self,
        name: str,
        description: str,
        variables: tuple[Sequence[Parameter], Sequence[Input], Sequence[Output]],
        now: Mapping[str, Sequence[str]],
        limits: Sequence[Limit],
        usual: tuple[float, float],
        able: Able,
    ) -> None:
        self.name, self.description = name, description
        self.parameters, self.inputs, self.outputs = variables
        self.now, self.limits, self.usual, self.able = now, limits, usual, able


def build_assembly(
    assembly: Assembly,
    core: Mapping[str, str],
    further: Mapping[str, bytes],
    out: Path,
    fmi: str = "2.0",
    platforms: Iterable[str] = ("host",),
) -> Path:
    """Write the FMU to the file `out`, and return its path.

    core: C files of the equations; those without a folder are compiled. further: other files by
    their place in the archive, `documentation/README.md` among them. platforms: names of
    compiler.TARGETS, `host` or `all`. Raises CompileError, or OSError for a place that cannot be
    written.
    """
    chosen = targets(platforms)
    start = {p.name: float(p.default or 0.0) for p in assembly.parameters}
    sources = frame(assembly, start, fmi, NO_GUID, variable_counts(assembly), assembly.now)
    sources = {**sources, **core}
    units = [name for name in sources if name.endswith(".c") and "/" not in name]
    xml = _description(assembly, start, fmi, units)
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as name:
        folder = Path(name)
        readme = folder / "README.md"
        readme.write_bytes(further["documentation/README.md"])
        files = {
            **further,
            "documentation/index.html": documentation(assembly, None, start, readme, xml).encode(),
            "documentation/licenses/license.txt": licence().encode(),
            "terminalsAndIcons/terminalsAndIcons.xml": terminals_and_icons(assembly).encode(),
        }
        whole = Contents(assembly.name, fmi, files, sources, units, (*FLAGS, ALIASED))
        (built,) = write([identified(whole, xml)], folder, chosen)
        built.replace(out)
    return out


def _description(assembly: Assembly, start: Values, fmi: str, units: Sequence[str]) -> str:
    now, own = assembly.now, assembly.able
    common = {
        "modelIdentifier": assembly.name,
        "canBeInstantiatedOnlyOncePerProcess": _said(own.only_once),
        "canHandleVariableCommunicationStepSize": _said(own.variable_step),
    }
    at_start: Dependencies = dict.fromkeys(v.name for v in assembly.outputs)
    if fmi == "3.0":
        able = {
            **fmi3.SLAVE,
            "canGetAndSetFMUState": _said(own.saves_state),
            "canSerializeFMUState": _said(own.serializes_state),
            "providesPerElementDependencies": "true",
        }
        interface = Interface("CoSimulation", {**able, **common})
        return fmi3.described(assembly, start, [interface], now, at_start)
    able = {
        **fmi2.SLAVE,
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": _said(own.saves_state),
        "canSerializeFMUstate": _said(own.serializes_state),
    }
    interface = Interface("CoSimulation", {**able, **common}, units)
    head = {**fmi2.OURS, "numberOfEventIndicators": "0"}
    return fmi2.described(assembly, start, head, [interface], now, at_start)


def _said(value: bool) -> str:
    return "true" if value else "false"
