"""What a truck reads, writes and can be told: its variables and parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..describe.states import State
from ..describe.terminals import CENTRE_PLATE, FRAME, RAILS, WHEELSET, Terminal
from ..describe.variables import (
    FRAME_INPUTS,
    Array,
    Input,
    Output,
    Parameter,
    Tangent,
    Variable,
    choice,
    vector,
)

AXLES = (1, 2)
SIDES = ("left", "right")
COORDINATES = {
    "lateral": ("m", "Trailing axle lateral"),
    "yaw": ("rad", "Rigid yaw"),
    "roll": ("rad", "Bolster roll"),
    "warp": ("rad", "Warp (lozenge) angle of the side frames"),
    "bolster_lateral": ("m", "Bolster lateral relative to the side frames"),
    "bolster_vertical": ("m", "Bolster vertical"),
}
"""The coordinates q[1..6], with unit and description."""

ELEMENTS = {
    "centre_plate_lateral": "m",
    "centre_plate_yaw": "rad",
    "bolster_roll": "rad",
    "bolster_vertical": "m",
    "bolster_lateral": "m",
    "warp": "rad",
}
"""The spring-and-friction elements 1..6, with the unit of their strain; report Table 4-5."""

SHARES = {"force_y": "N", "moment_z": "N.m"}
"""Wheel/rail loads of one axle."""

OWN_MOTION = {"y": "m", "yaw": "rad", "vy": "m/s", "wz": "rad/s"}
"""Motion of one axle, that the wheel/rail loads follow."""

_FORCE = {"m": "N", "rad": "N.m"}
_STIFFNESS = {"m": "N/m", "rad": "N.m/rad"}
_NOMINAL = {"m": 1e-2, "rad": 1e-3, "m/s": 1e-1, "rad/s": 1e-2, "N": 1e4, "N.m": 1e4}


def element_parameters(name: str, number: int | str, unit: str) -> Sequence[Parameter]:
    """K0, K1, Kf, f and Delta of an element; `number` is its index in their symbols."""
    title = name.replace("_", " ")
    stiffness = _STIFFNESS[unit]

    def parameter(which: str, kind: str, symbol: str, text: str) -> Parameter:
        return Parameter(
            f"{name}.{which}",
            kind,
            f"{text}, {title}",
            symbol=f"{symbol}_{number}",
            minimum=0.0,
            tunable=True,
        )

    return (
        parameter("stiffness", stiffness, "K0", "Spring stiffness"),
        parameter("stop_stiffness", stiffness, "K1", "Further stiffness beyond the free play"),
        parameter("friction_stiffness", stiffness, "Kf", "Stiffness of the stuck friction"),
        parameter("friction_limit", _FORCE[unit], "f", "Largest friction"),
        parameter("free_play", unit, "Delta", "Free play to the stop"),
    )


def _measured_strain(name: str, number: int, unit: str) -> Parameter:
    return Parameter(
        f"{name}.measured_strain",
        unit,
        f"Largest strain that was measured, {name.replace('_', ' ')}",
        symbol=f"eps_{number}",
        minimum=0.0,
    )


def _contact_parameters(name: str, unit: str, suffix: str, inertia: str) -> Sequence[Parameter]:
    title = name.removeprefix("contact_")
    return (
        Parameter(
            f"{name}.stiffness",
            unit,
            f"Centre plate contact stiffness, {title}",
            symbol=f"k_c{suffix}",
            minimum=0.0,
        ),
        Parameter(
            f"{name}.damping_ratio",
            "1",
            f"Damping ratio of the {title} contact on the {inertia}",
            symbol=f"zeta_c{suffix}",
            minimum=0.0,
        ),
    )


def _mass(name: str, symbol: str, what: str) -> Parameter:
    return Parameter(name, "kg", f"Mass of {what}", symbol=symbol, minimum=1.0)


def _inertia(name: str, symbol: str, what: str) -> Parameter:
    return Parameter(name, "kg.m2", what, symbol=symbol, minimum=1.0)


def _length(name: str, symbol: str, what: str) -> Parameter:
    return Parameter(name, "m", what, symbol=symbol, minimum=0.01)


PARAMETERS = (
    _length("half_wheelbase", "L_X", "Half wheelbase"),
    _length("half_contact_spacing", "L_Y", "Half distance of the contact points of a wheelset"),
    _length("half_side_frame_spacing", "d", "Half distance of the side frames"),
    _length("centre_plate_height", "h_cp", "Height of the centre plate above the rails"),
    _length("mass_height", "h_t", "Height of the truck's own centre of gravity above the rails"),
    Parameter(
        "axle_load", "N", "Static weight on the rails of one axle", symbol="W_axle", minimum=1.0
    ),
    _mass("wheelset_mass", "m_w", "one wheelset"),
    _inertia("wheelset_yaw_inertia", "I_w", "Yaw inertia of one wheelset"),
    _mass("side_frame_mass", "m_s", "one side frame"),
    _inertia("side_frame_yaw_inertia", "I_s", "Yaw inertia of one side frame"),
    _mass("bolster_mass", "m_b", "the bolster"),
    _inertia("bolster_yaw_inertia", "I_bz", "Yaw inertia of the bolster"),
    _inertia("bolster_roll_inertia", "I_bx", "Roll inertia of the bolster"),
    *_contact_parameters("contact_vertical", "N/m", "z", "bolster mass"),
    *_contact_parameters("contact_roll", "N.m/rad", "r", "bolster roll inertia"),
    *(
        parameter
        for number, (name, unit) in enumerate(ELEMENTS.items(), start=1)
        for parameter in (
            *element_parameters(name, number, unit),
            _measured_strain(name, number, unit),
        )
    ),
    choice(
        "centre_plate_contact",
        "Whether the carbody may rock and lift off the plate, or always touches (report 6.1)",
        ("unilateral", "bilateral"),
        symbol="contact",
    ),
    choice(
        "centre_plate_friction",
        "Friction of the plate (elements 1, 2): constant or proportional to its load",
        ("constant", "load_proportional"),
    ),
    Parameter(
        "centre_plate_weight", "N", "Static load on the centre plate", symbol="W_cp", minimum=1.0
    ),
    _length("centre_plate_radius", "r_cp", "Radius of the centre plate"),
    _length("half_side_bearing_spacing", "b_sb", "Half distance of the side bearings"),
    *(
        Parameter(f"side_bearing_{name}", unit, text, symbol=symbol, minimum=0.0)
        for name, unit, text, symbol in (
            ("gap", "m", "Gap of a side bearing at rest", "g_sb"),
            ("stiffness", "N/m", "Stiffness of a closed side bearing", "k_sb"),
            (
                "damping",
                "s/m",
                "Damping over elastic force of a side bearing, per velocity",
                "l_sb",
            ),
            ("friction", "1", "Friction coefficient of a side bearing", "mu_sb"),
            ("preload", "N", "Load of a constant contact side bearing at rest; 0: none", "N_sb"),
            (
                "preload_stiffness",
                "N/m",
                "Stiffness of a constant contact side bearing before its stop",
                "k_cc",
            ),
        )
    ),
    choice(
        "wedge_law",
        "Friction of the wedges: constant (ASF) or proportional to the spring load (Barber)",
        ("constant", "load_proportional"),
    ),
    choice(
        "wedge_friction",
        "Friction of the wedges: as measured, or in proportion by their geometry and springs",
        ("measured", "geometry"),
    ),
    *(
        Parameter(f"wedge_{name}", unit, text, symbol=symbol, minimum=least, maximum=most)
        for name, unit, text, symbol, least, most in (
            ("angle", "rad", "Angle of a wedge's slope to the vertical", "theta_w", 0.1, 1.4),
            ("column_friction", "1", "Friction coefficient of a column", "mu_1", 0.0, 2.0),
            ("slope_friction", "1", "Friction coefficient of a slope", "mu_2", 0.0, 2.0),
            ("toe", "rad", "Lean of the columns: they part upwards", "gamma_w", -0.1, 0.1),
            ("spring_load", "N", "Force of a wedge's spring at rest", "S_w", 0.0, None),
        )
    ),
    Parameter(
        "micro_step",
        "s",
        "Largest step of the integration inside a macro step",
        symbol="h",
        minimum=1e-7,
        maximum=1e-2,
        tunable=True,
        default=2.5e-4,
    ),
    *(
        Parameter(
            f"initial.{name}{suffix}", f"{unit}{per}", f"{text} at the start{rate}", default=0
        )
        for suffix, per, rate in (("", "", ""), ("_rate", "/s", ", rate"))
        for name, (unit, text) in COORDINATES.items()
    ),
)

_CAR_MOTION = {
    "y": ("m", "Lateral displacement"),
    "z": ("m", "Vertical displacement"),
    "roll": ("rad", "Roll"),
    "yaw": ("rad", "Yaw"),
    "vy": ("m/s", "Lateral velocity"),
    "vz": ("m/s", "Vertical velocity"),
    "wx": ("rad/s", "Roll rate"),
    "wz": ("rad/s", "Yaw rate"),
}

INPUTS = (
    *(
        Input(f"car.{name}", unit, f"{text} of the carbody at the centre plate")
        for name, (unit, text) in _CAR_MOTION.items()
    ),
    *(
        Input(f"axle[{k}].{name}", unit, f"{text} of the rails on wheelset {k}")
        for k in AXLES
        for name, unit, text in (
            ("force_y", "N", "Lateral force"),
            ("moment_z", "N.m", "Yaw moment"),
        )
    ),
    *(
        Input(f"axle[{k}].rail_z_{side}", "m", f"Height of the {side} rail under axle {k}")
        for k in AXLES
        for side in SIDES
    ),
    *(
        Input(
            f"axle[{k}].rail_az_{side}",
            "m/s2",
            f"Vertical acceleration of the {side} rail under axle {k}",
            optional=True,
        )
        for k in AXLES
        for side in SIDES
    ),
    *(
        Input(
            f"axle[{k}].{load}_per_{motion}",
            f"{load_unit}.s/{unit.removesuffix('/s')}"
            if unit.endswith("/s")
            else f"{load_unit}/{unit}",
            f"Derivative of axle[{k}].{load} with respect to axle[{k}].{motion}",
            optional=True,
        )
        for k in AXLES
        for motion, unit in OWN_MOTION.items()
        for load, load_unit in SHARES.items()  # in turn, as a tangent's results are
    ),
    *FRAME_INPUTS,
)

TANGENTS = tuple(
    Tangent(f"axle[{k}].{load}", f"axle[{k}].{motion}", f"axle[{k}].{load}_per_{motion}")
    for k in AXLES
    for load in SHARES
    for motion in OWN_MOTION
)


def _axle_outputs(k: int) -> Sequence[Output]:
    axle = f"axle[{k}]"
    return (
        Output(f"{axle}.y", "m", f"Lateral displacement of axle {k}", nominal=1e-2),
        Output(f"{axle}.yaw", "rad", f"Yaw of axle {k}", nominal=1e-3),
        Output(f"{axle}.vy", "m/s", f"Lateral velocity of axle {k}", derivative_of=f"{axle}.y"),
        Output(f"{axle}.wz", "rad/s", f"Yaw rate of axle {k}", derivative_of=f"{axle}.yaw"),
        *(
            Output(f"{axle}.load_{side}", "N", f"Load on the {side} wheel of axle {k}", nominal=1e5)
            for side in SIDES
        ),
    )


OUTPUTS = (
    *(output for k in AXLES for output in _axle_outputs(k)),
    Output("car.force_y", "N", "Lateral force on the carbody", nominal=1e4),
    Output("car.force_z", "N", "Vertical force on the carbody, beyond the static", nominal=1e4),
    Output("car.moment_x", "N.m", "Roll moment on the carbody", nominal=1e4),
    Output("car.moment_z", "N.m", "Yaw moment on the carbody", nominal=1e4),
    Output("centre_plate_load", "N", "Load on the centre plate", nominal=1e5),
    *(
        Output(f"side_bearing_{side}", "N", f"Load on the {side} side bearing", nominal=1e5)
        for side in SIDES
    ),
    *(
        Output(f"lift_{side}", "m", f"Height of the {side} wheels above their rail", nominal=1e-2)
        for side in SIDES
    ),
    *(
        Output(f"q[{i}]", unit, text, nominal=_NOMINAL[unit])
        for i, (unit, text) in enumerate(COORDINATES.values(), start=1)
    ),
    *(
        Output(
            f"qd[{i}]",
            f"{unit}/s",
            f"{text}, rate",
            nominal=_NOMINAL[f"{unit}/s"],
            derivative_of=f"q[{i}]",
        )
        for i, (unit, text) in enumerate(COORDINATES.values(), start=1)
    ),
    *(
        Output(
            f"{part}[{i}]",
            _FORCE[unit],
            f"Force of the {part} in element {i}, {name.replace('_', ' ')}",
            nominal=_NOMINAL[_FORCE[unit]],
        )
        for part in ("spring", "friction")
        for i, (name, unit) in enumerate(ELEMENTS.items(), start=1)
    ),
    *(
        Output(
            f"strain_ratio[{i}]",
            "1",
            f"Strain of element {i}, {name.replace('_', ' ')}, over the largest that was measured",
            nominal=1.0,
        )
        for i, name in enumerate(ELEMENTS, start=1)
    ),
)

STATES = (
    *(State(f"q[{i}]", unit, text) for i, (unit, text) in enumerate(COORDINATES.values(), start=1)),
    *(
        State(f"qd[{i}]", f"{unit}/s", f"{text}, rate")
        for i, (unit, text) in enumerate(COORDINATES.values(), start=1)
    ),
    *(
        State(
            f"slip[{i}]",
            unit,
            f"Slip of the friction in element {i}, {name.replace('_', ' ')}",
            memory=True,
        )
        for i, (name, unit) in enumerate(ELEMENTS.items(), start=1)
    ),
)

MODES = tuple(
    Variable(f"slider[{i}]", "1", f"Slider of element {i}: 0 stuck, else the way that it slips")
    for i in range(1, len(ELEMENTS) + 1)
)

_AXLE_PLACE = {1: 54.0, 2: -54.0}

TERMINALS = (
    Terminal("car", CENTRE_PLATE, "Carbody on the centre plate", (0, 60), prefix="car."),
    *(
        Terminal(f"axle[{k}]", WHEELSET, f"Wheelset {k}", (x, -28), prefix=f"axle[{k}].")
        for k, x in _AXLE_PLACE.items()
    ),
    *(
        Terminal(f"rails[{k}]", RAILS, f"Rails under axle {k}", (x, -80), prefix=f"axle[{k}].")
        for k, x in _AXLE_PLACE.items()
    ),
    Terminal("frame", FRAME, "Frame that the truck moves in", (0, -80), prefix="frame."),
)


def _each(name: str, text: str, units: Mapping[str, str]) -> Array:
    """The array name[1..6], described by what each element is and its unit."""
    each = ", ".join(f"{title.replace('_', ' ')} [{unit}]" for title, unit in units.items())
    return vector(name, len(units), f"{text}: {each}")


_COORDINATE_UNITS = {name: unit for name, (unit, _) in COORDINATES.items()}
_ELEMENT_FORCES = {name: _FORCE[unit] for name, unit in ELEMENTS.items()}

ARRAYS = (
    _each("q", "Coordinates", _COORDINATE_UNITS),
    _each(
        "qd",
        "Rates of the coordinates",
        {name: f"{unit}/s" for name, unit in _COORDINATE_UNITS.items()},
    ),
    _each("spring", "Spring forces of the elements", _ELEMENT_FORCES),
    _each("friction", "Friction forces of the elements", _ELEMENT_FORCES),
    _each("slip", "Slips of the elements' friction", ELEMENTS),
    _each("strain_ratio", "Strains over those that were measured", dict.fromkeys(ELEMENTS, "1")),
)
