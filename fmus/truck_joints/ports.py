"""What a truck of joints reads, writes and can be told: the truck's, and more."""

from __future__ import annotations

from ..describe.block import State
from ..describe.variables import NOMINAL, Array, Output, Parameter, Variable, vector
from ..truck import ports as truck
from .bodies import ELEMENTS, KEPT

FREE = {name for name in truck.ELEMENTS if not name.startswith("centre_plate")}
"""Elements of the analog that joints stand for."""


def _is_shared(parameter: Parameter) -> bool:
    element, _, kind = parameter.name.partition(".")
    return element not in FREE or kind == "measured_strain"


JOINT_PARAMETERS = tuple(
    parameter
    for name, (unit, symbol) in {
        e.parameters: (e.unit, e.symbol) for e in ELEMENTS if e.joint.b
    }.items()
    for parameter in truck.element_parameters(name, symbol, unit)
)

PARAMETERS = (*filter(_is_shared, truck.PARAMETERS), *JOINT_PARAMETERS)

_BODY = {way: "m" for way in ("x", "y", "z")} | {"roll": "rad", "yaw": "rad"}
_COORDINATES = tuple(
    (f"{body.replace('_', ' ').capitalize()} {way}", _BODY[way]) for body, way in KEPT
)
_FORCE = {"m": "N", "rad": "N.m"}


OUTPUTS = (
    *truck.OUTPUTS,
    *(Output(f"h[{i}]", unit, text) for i, (text, unit) in enumerate(_COORDINATES, start=1)),
    *(
        Output(f"hd[{i}]", f"{unit}/s", f"{text}, rate", derivative_of=f"h[{i}]")
        for i, (text, unit) in enumerate(_COORDINATES, start=1)
    ),
    *(
        Output(f"joint_strain[{i}]", e.unit, f"Strain, {e.title}", nominal=NOMINAL[e.unit])
        for i, e in enumerate(ELEMENTS, start=1)
    ),
    *(
        Output(f"joint_force[{i}]", _FORCE[e.unit], f"Force of spring and friction, {e.title}",
               nominal=NOMINAL[_FORCE[e.unit]])
        for i, e in enumerate(ELEMENTS, start=1)
    ),
)  # fmt: skip

STATES = (
    *(State(f"h[{i}]", unit, text) for i, (text, unit) in enumerate(_COORDINATES, start=1)),
    *(
        State(f"hd[{i}]", f"{unit}/s", f"{text}, rate")
        for i, (text, unit) in enumerate(_COORDINATES, start=1)
    ),
    *(
        State(f"slip[{i}]", e.unit, f"Slip of the friction, {e.title}", memory=True)
        for i, e in enumerate(ELEMENTS, start=1)
    ),
)

MODES = tuple(
    Variable(f"slider[{i}]", "1", f"Slider, {e.title}: 0 stuck, else the way that it slips")
    for i, e in enumerate(ELEMENTS, start=1)
)

_OF_THE_TRUCK = tuple(array for array in truck.ARRAYS if array.name != "slip")


def _each(name: str, text: str, titles: list[str]) -> Array:
    return vector(name, len(titles), f"{text}: {', '.join(titles)}")


_BODIES = [f"{text} [{unit}]" for text, unit in _COORDINATES]
_RATES = [f"{text} [{unit}/s]" for text, unit in _COORDINATES]
_STRAINS = [f"{e.title} [{e.unit}]" for e in ELEMENTS]

ARRAYS = (
    *_OF_THE_TRUCK,
    _each("h", "Coordinates of the bodies", _BODIES),
    _each("hd", "Their rates", _RATES),
    _each("slip", "Slips of the joints' friction", _STRAINS),
    _each("joint_strain", "Strains of the joints", _STRAINS),
    _each(
        "joint_force", "Forces of the joints", [f"{e.title} [{_FORCE[e.unit]}]" for e in ELEMENTS]
    ),
)
