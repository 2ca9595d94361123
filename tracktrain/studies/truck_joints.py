"""From the joints to the analog: what six deflection shapes see of a truck of bodies and joints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import casadi as ca
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.catalogue import fmu_path
from fmus.describe.elements import friction_force, slip_after, spring_force
from fmus.truck.mass import mass_matrix
from fmus.truck.ports import ELEMENTS
from fmus.truck_joints.bodies import inertias
from fmus.truck_joints.reduction import KINDS, analog, shapes

from ..car.hopper import parameters_of
from ..figures import conversion
from ..options.car import car_option
from ..plots import BLUE, GREEN, RED, STYLE
from ..scales import INCH, POUND_FORCE
from .common.command import study_command
from .common.outcome import Outcome
from .truck_hysteresis import truck_hysteresis

Values = Mapping[str, float]

SYMBOLS = dict(zip(KINDS, ("K0", "K1", "Kf", "f", "Delta"), strict=True))
NO_STOP = 100.0
"""A free play [m or rad] beyond which there is no stop."""

NEVER = float("inf")
ROUND = 2 / 3
"""Lever of the friction of a plate under even pressure, over its radius."""


def truck_joints(car: str = "loaded") -> Outcome:
    """The truck of joints beside its analog of six shapes, report sections 4.2.2 and 4.2.3.

    Which parameters of Table 4-5 come out of the joints, which joint values two of its rows ask
    for that no joint has both of, and each shape's hysteresis on the rig (Figures 4-16, 4-17,
    4-20), at 100 kip and 2 s a cycle.
    """
    parameters = parameters_of(car)
    six, joints = parameters["truck"], parameters["truck_joints"]
    stands = {"analog": None, "joints": fmu_path("truck_joints")}
    loops = [_loops(car, fmu) for fmu in stands.values()]
    dataset = xr.concat(loops, pd.Index(list(stands), name="truck"))
    return Outcome(
        title=f"Truck of joints and its analog, {car}",
        dataset=dataset,
        tables={
            "analog": _analog(six, joints),
            "one_joint_two_rows": _demands(six, joints),
            "together": _together(six),
        },
        pictures={"figure_4_20": _figure(dataset), "figure_4_14": _parts(six, joints)},
        notes=[
            f"Phi^T M Phi of the five bodies and the mass matrix of the truck block differ by "
            f"{_mass_difference(joints):.1e} of its largest element, (4-29) to (4-31)",
            "warp: four adapters and two bolster ends turn alike, and only their sum shows; here "
            "each has a sixth",
            "the adapters' lever is that of 15 000 lb each if warp were theirs alone",
            "beyond 60 000 lb on axles that are held, four adapters slide where the analog is on "
            "its stop; the deflection is the rig's, from the axles to the carbody",
            "together: friction of one coil group that slides alone, as when one wheel runs over "
            "a dip. The analog's elements do not know of each other, the joints do",
        ],
    )


command = study_command(
    "truck-joints",
    car_option(),
    epilog="""\b
Examples:
  tracktrain study truck-joints""",
)(truck_joints)


def _loops(car: str, fmu: Path | None) -> xr.Dataset:
    """The third cycle of every shape of a truck on the rig."""
    found = truck_hysteresis(car, loads=(100.0,), periods=(2.0,), fmu=fmu)
    return found.dataset.isel(load=0, period=0)


def _units(unit: str) -> dict[str, tuple[str, float]]:
    """Report's unit of each kind of parameter, and its size in SI."""
    if unit == "m":
        stiffness, force, play = ("lb/in", POUND_FORCE / INCH), ("lb", POUND_FORCE), ("in", INCH)
    else:
        moment = POUND_FORCE * INCH
        stiffness, force, play = ("lb.in/rad", moment), ("lb.in", moment), ("rad", 1.0)
    return {**dict.fromkeys(KINDS[:3], stiffness), "friction_limit": force, "free_play": play}


def _analog(six: Values, joints: Values) -> pd.DataFrame:
    """Table 4-5 and what the joints give, in its units."""
    rows = []
    for name, own in analog(joints).items():
        for kind, (unit, size) in _units(ELEMENTS[name]).items():
            printed, given = six[f"{name}.{kind}"], own[kind]
            if kind == "free_play" and printed > NO_STOP:
                continue
            if printed or given:
                rows.append(
                    {
                        "element": name.replace("_", " "),
                        "parameter": f"{SYMBOLS[kind]} [{unit}]",
                        "Table 4-5": printed / size,
                        "joints": given / size,
                        "joints over table": given / printed if printed else NEVER,
                    }
                )
    return pd.DataFrame(rows).set_index("element")


def _demands(six: Values, joints: Values) -> pd.DataFrame:
    """What two rows of Table 4-5 ask of the same part."""
    arm, radius = joints["half_side_frame_spacing"], joints["centre_plate_radius"]
    plate, inch = joints["centre_plate_lateral.friction_limit"], INCH
    rows = []
    for kind, power in (("stiffness", 2), ("friction_stiffness", 2), ("friction_limit", 1)):
        unit, size = _units("m")[kind]
        rows.append(
            (
                f"{SYMBOLS[kind]} of a coil group [{unit}]",
                six[f"bolster_vertical.{kind}"] / 2 / size,
                six[f"bolster_roll.{kind}"] / (2 * arm**power) / size,
            )
        )
    lever = six["centre_plate_yaw.friction_limit"] / plate
    rows.append(("lever of plate friction [in]", ROUND * radius / inch, lever / inch))
    friction = joints["adapter_lateral.friction_limit"]
    rows.append(
        (
            "lever of adapter friction [in]",
            NEVER,
            six["warp.friction_limit"] / (4 * friction) / inch,
        )
    )
    columns = ("part", "by the first row", "by the second")
    table = pd.DataFrame(rows, columns=columns).set_index("part")
    table = table.replace(NEVER, np.nan)
    table["second over first"] = table["by the second"] / table["by the first row"]
    table.insert(0, "rows", ["vertical, roll"] * 3 + ["7 in plate, yaw", "none, warp"])
    return table


def _together(six: Values) -> pd.DataFrame:
    """Friction in vertical and roll while one coil group slides and the other stands."""
    limit, moment = (six[f"bolster_{name}.friction_limit"] for name in ("vertical", "roll"))
    force, lever = limit / POUND_FORCE, moment / POUND_FORCE / INCH
    return pd.DataFrame(
        {
            "truck": ["analog", "joints"],
            "vertical [lb]": [force, force / 2],
            "roll [lb.in]": [lever, lever / 2],
        }
    ).set_index("truck")


def _mass_difference(joints: Values) -> float:
    numbers = {name: ca.SX(value) for name, value in joints.items()}
    phi, mass = (
        np.array(ca.evalf(ca.densify(ca.SX(value))))
        for value in (shapes(numbers), ca.diag(ca.vertcat(*inertias(numbers))))
    )
    block = np.array(mass_matrix(joints))
    return float(np.abs(phi.T @ mass @ phi - block).max() / np.abs(block).max())


@mpl.rc_context(STYLE)
def _figure(dataset: xr.Dataset) -> Figure:
    """Loops of both trucks in each shape."""
    figure = Figure(figsize=(10.0, 6.8), layout="constrained")
    for axes, (name, unit) in zip(figure.subplots(2, 3).ravel(), ELEMENTS.items(), strict=True):
        for truck, colour, width in (("analog", BLUE, 2.6), ("joints", RED, 1.2)):
            own = dataset.sel(truck=truck)
            strain, force = (_closed(own[f"{name}.{what}"].values) for what in ("strain", "force"))
            axes.plot(1e3 * strain, 1e-3 * force, color=colour, linewidth=width, label=truck)
        axes.set_title(name.replace("_", " "))
        lengths, forces, factor, report = (
            ("mm", "kN", 1e3 / POUND_FORCE, "lb")
            if unit == "m"
            else ("mrad", "kN.m", 1e3 / POUND_FORCE / INCH, "lb.in")
        )
        axes.set_xlabel(f"deflection [{lengths}]")
        axes.set_ylabel(f"force [{forces}]")
        axes.secondary_yaxis("right", functions=conversion(factor)).set_ylabel(f"[{report}]")
    figure.axes[0].legend(frameon=False, fontsize=8)
    figure.suptitle("Hysteresis of each deflection shape: joints and analog", ha="left", x=0.01)
    return figure


PARTS = {"bolster_lateral": ("bolster_end_lateral", 2), "warp": ("adapter_yaw", 6)}
"""Shapes whose joints are all strained alike: one of these joints, and how many there are."""


@mpl.rc_context(STYLE)
def _parts(six: Values, joints: Values) -> Figure:
    """Spring, friction and both, of one joint, of all that a shape strains, and of the analog."""
    figure = Figure(figsize=(10.0, 6.2), layout="constrained")
    grid = figure.subplots(len(PARTS), 3)
    for row, (shape, (joint, count)) in zip(grid, PARTS.items(), strict=True):
        reach = 1.2 * six[f"{shape}.free_play"]
        turns = np.cumsum([0, 1, -2, 2]) * reach
        strain = np.interp(np.linspace(0, 3, 601), range(4), turns)
        one, analog_ = (_quasi_static(strain, v, n) for v, n in ((joints, joint), (six, shape)))
        length, force = ("mm", "kN") if ELEMENTS[shape] == "m" else ("mrad", "kN.m")
        for axes, single, whole, title in zip(
            row,
            one,
            analog_,
            ("spring (Figure 4-16)", "friction (4-17)", "both (4-14)"),
            strict=True,
        ):
            for values, colour, width, label in (
                (whole, BLUE, 3.0, "analog"),
                (count * single, RED, 1.2, f"{count} joints"),
                (single, GREEN, 1.2, "one joint"),
            ):
                axes.plot(1e3 * strain, 1e-3 * values, color=colour, linewidth=width, label=label)
            axes.set_title(f"{shape.replace('_', ' ')}: {title}")
            axes.set_xlabel(f"strain [{length}]")
            axes.set_ylabel(f"force [{force}]")
        row[0].legend(frameon=False, fontsize=8)
    return figure


def _quasi_static(strain: np.ndarray, values: Values, name: str) -> tuple[np.ndarray, ...]:
    """Force of spring, of friction and of both along a path of the strain."""
    k0, k1, kf, limit, play = (ca.SX(values[f"{name}.{kind}"]) for kind in KINDS)
    e, slip = ca.SX.sym("strain"), ca.SX.sym("slip")
    parts = spring_force(e, k0, k1, play), friction_force(e, slip, kf, limit)
    along = ca.Function("along", [slip, e], [slip_after(e, slip, limit / kf), *parts])
    _, *found = along.mapaccum(len(strain))(0.0, strain)
    spring, friction = (np.array(part).ravel() for part in found)
    return spring, friction, spring + friction


def _closed(values: np.ndarray) -> np.ndarray:
    """A cycle about its middle, with its first point again at its end."""
    return np.append(values, values[0]) - (values.max() + values.min()) / 2
