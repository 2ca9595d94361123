"""FMUs of `slaves/manners.c`: each has one bad or rare manner."""

from __future__ import annotations

from pathlib import Path

from orchestrator import Component
from support.native_slaves import FIXED, archive, body, library, variable

SOURCE = Path(__file__).parent / "slaves" / "manners.c"
EXPERIMENT = '<DefaultExperiment startTime="0" stopTime="1" tolerance="1e-7"/>'
CATEGORIES = '<LogCategories><Category name="logStatusError"/></LogCategories>'

VARIABLES = body(
    [
        variable("u", "input", '<Real start="1"/>'),
        variable("y", "output", "<Real/>"),
        variable("now", "output", "<Real/>"),
        variable("twice", "local", "<Real/>"),
        variable("at", "parameter", '<Real start="1e9"/>', FIXED),
        variable("answer", "parameter", '<Real start="0"/>', FIXED),
        variable("tolerance", "output", "<Real/>"),
    ],
    '<Unknown index="2" dependencies=""/><Unknown index="3" dependencies="1"/>'
    '<Unknown index="7" dependencies=""/>',
)


def manners(folder: Path, manner: str, experiment: str = "", **values: float) -> Component:
    """An instance of the FMU of a manner of the source, with values of its parameters."""
    text = (
        '<fmiModelDescription fmiVersion="2.0" modelName="Manners" guid="manners">'
        '<CoSimulation modelIdentifier="slave" canHandleVariableCommunicationStepSize="true"/>'
        f"{CATEGORIES}{experiment}{VARIABLES}</fmiModelDescription>"
    )
    binary = library(folder, f"-DMANNER={manner}", "-lm", source=SOURCE)
    return Component(archive(folder / f"{manner.lower()}.fmu", text, binary), {**values})
