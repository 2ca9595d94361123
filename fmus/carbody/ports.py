"""What a carbody reads and writes, whatever its elastic modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..describe.states import State
from ..describe.terminals import CENTRE_PLATE, FRAME, Terminal
from ..describe.variables import FRAME_INPUTS, Array, Constant, Input, Output, Parameter, vector

MODAL = "kg^(1/2).m"
"""Unit of a modal coordinate. It is only a name, since FMI defines units by whole exponents."""

RIGID = {"lateral": "m", "vertical": "m", "roll": "rad", "yaw": "rad", "pitch": "rad"}
"""The rigid modes 1..5, with the unit of their initial value."""

ELASTIC = ("torsion", "lateral_bending", "vertical_bending")
MODES = (*RIGID, *ELASTIC)
"""The modes 1..8 of the default carbody."""

BEAM_WAVE_NUMBER = 4.730040744862704
"""First root of cos(k) cosh(k) = 1, the free-free beam's."""

ENDS = {"front": 1, "rear": -1}
FORCES = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
MOTIONS = ("y", "z", "roll", "yaw")
"""Rows of the mode shapes at a centre plate, each the motion on which a force does work."""

_RATES = {
    "x": ("vx", "ax"),
    "y": ("vy", "ay"),
    "z": ("vz", "az"),
    "roll": ("wx", "wx_dot"),
    "pitch": ("wy", "wy_dot"),
    "yaw": ("wz", "wz_dot"),
}
_WORDS = {"x": "Longitudinal", "y": "Lateral", "z": "Vertical"}

TERMINALS = (
    *(
        Terminal(end, CENTRE_PLATE, f"Truck under the {end} centre plate", place, prefix=f"{end}.")
        for end, place in (("front", (50, -64)), ("rear", (-50, -64)))
    ),
    Terminal("frame", FRAME, "Frame that the carbody moves in", (0, -64), prefix="frame."),
)


def inertia(mode: str, axis: str) -> Parameter:
    return Parameter(
        f"{mode}_inertia",
        "kg.m2",
        f"{mode.capitalize()} inertia about the centre of gravity",
        symbol=f"I_{axis}{axis}",
        minimum=1.0,
    )


MASS = (
    Parameter("body_mass", "kg", "Mass of the carbody with lading", symbol="m", minimum=1.0),
    inertia("roll", "x"),
    inertia("pitch", "y"),
    inertia("yaw", "z"),
    Parameter(
        "centre_plate_height",
        "m",
        "Height of the centre plates above the rails",
        symbol="h_cp",
        default=0.65405,
    ),
)

PLATE_LOADS = tuple(
    Input(f"{end}.{force}", unit, f"{text} on the carbody at the {end} centre plate")
    for end in ENDS
    for (force, unit), text in zip(
        FORCES.items(),
        ("Lateral force", "Vertical force, beyond the static,", "Roll moment", "Yaw moment"),
        strict=True,
    )
)
INPUTS = (*PLATE_LOADS, *FRAME_INPUTS)

CENTRE_OF_GRAVITY = (
    Output("cg.y", "m", "Lateral displacement of the centre of gravity", nominal=1e-2),
    Output("cg.z", "m", "Vertical displacement of the centre of gravity", nominal=1e-2),
    Output("cg.roll", "rad", "Rigid roll", nominal=1e-2),
    Output("cg.pitch", "rad", "Rigid pitch", nominal=1e-2),
    Output("cg.yaw", "rad", "Rigid yaw", nominal=1e-2),
    Output("cg.ay", "m/s2", "Lateral acceleration of the centre of gravity"),
    Output("cg.az", "m/s2", "Vertical acceleration of the centre of gravity"),
)


def initial_values(modes: Mapping[str, tuple[str, str]]) -> tuple[Parameter, ...]:
    """Parameters for coordinates and rates at the start: unit and title of each mode by name.

    The rate of a name such as `mode[1]` is `mode_rate[1]`.
    """
    found = []
    for suffix, text in (("", ""), ("_rate", ", rate")):
        for mode, (unit, title) in modes.items():
            name, bracket, index = mode.partition("[")
            found.append(
                Parameter(
                    f"initial.{name}{suffix}{bracket}{index}",
                    f"{unit}/s" if suffix else unit,
                    f"{title} at the start{text}",
                    default=0.0,
                )
            )
    return tuple(found)


def motions(point: str, place: str, names: Sequence[str] = MOTIONS) -> tuple[Output, ...]:
    """Displacements of a point, velocities and accelerations, in the order of the names."""
    kinds = (("displacement", ""), ("velocity", "/s"), ("acceleration", "/s2"))
    found = []
    for kind, (word, per) in enumerate(kinds):
        for name in names:
            chain = (name, *_RATES[name])
            turns = ("", " rate", " acceleration")[kind]
            text = f"{_WORDS[name]} {word}" if name in _WORDS else f"{name.capitalize()}{turns}"
            found.append(
                Output(
                    f"{point}.{chain[kind]}",
                    ("m" if name in _WORDS else "rad") + per,
                    f"{text} of {place}",
                    nominal=None if kind else 1e-2,
                    derivative_of=f"{point}.{chain[kind - 1]}" if kind else None,
                )
            )
    return tuple(found)


def motion_names(names: Sequence[str] = MOTIONS) -> tuple[tuple[str, ...], ...]:
    """Names of displacements, velocities and accelerations."""
    chains = [(name, *_RATES[name]) for name in names]
    return tuple(zip(*chains, strict=True))


def coordinates(modes: Sequence[str]) -> tuple[Output, ...]:
    """Modal coordinates and rates of the modes with these titles."""
    return (
        *(
            Output(f"q[{i}]", MODAL, f"Modal coordinate {i}, {mode}")
            for i, mode in enumerate(modes, start=1)
        ),
        *(
            Output(
                f"qd[{i}]",
                f"{MODAL}/s",
                f"Rate of modal coordinate {i}, {mode}",
                derivative_of=f"q[{i}]",
            )
            for i, mode in enumerate(modes, start=1)
        ),
    )


def states(count: int) -> tuple[State, ...]:
    return (
        *(State(f"q[{i}]", MODAL, f"Modal coordinate {i}") for i in range(1, count + 1)),
        *(
            State(f"qd[{i}]", f"{MODAL}/s", f"Rate of modal coordinate {i}")
            for i in range(1, count + 1)
        ),
    )


def shape_constants(modes: Sequence[str]) -> tuple[Constant, ...]:
    """Mode shapes at the centre plates, for the user to read."""
    return tuple(
        Constant(
            f"{end}.mode_shape[{row},{column}]",
            shape_unit(motion),
            f"{_WORDS.get(motion, motion.capitalize())} of the {end} centre plate for a unit of "
            f"modal coordinate {column}, {mode}",
        )
        for end in ENDS
        for row, motion in enumerate(MOTIONS, start=1)
        for column, mode in enumerate(modes, start=1)
    )


def shape_unit(motion: str) -> str:
    """Unit of a motion for a unit of a modal coordinate."""
    return "kg^(-1/2)" if motion in _WORDS else "kg^(-1/2).rad/m"


def arrays(modes: Sequence[str]) -> tuple[Array, ...]:
    """Coordinates, rates and mode shapes. modes: names of all."""
    listed = ", ".join(modes)
    return (
        vector("q", len(modes), f"Modal coordinates: {listed}"),
        vector("qd", len(modes), f"Rates of the modal coordinates: {listed}"),
        *(
            matrix(
                f"{end}.mode_shape",
                f"Motion of the {end} centre plate (rows y, z: kg^(-1/2); roll, yaw: "
                f"kg^(-1/2).rad/m) over the modal coordinates (columns {listed})",
                (len(MOTIONS), len(modes)),
            )
            for end in ENDS
        ),
    )


def matrix(name: str, description: str, shape: tuple[int, int]) -> Array:
    """The array of the variables name[1,1] to name[rows,columns]."""
    members = tuple(
        f"{name}[{row},{column}]"
        for row in range(1, shape[0] + 1)
        for column in range(1, shape[1] + 1)
    )
    return Array(name, description, members, shape)
