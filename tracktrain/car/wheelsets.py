"""Wheelsets on real profiles: from a wheel's and a rail's profile into a car."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fmus.export.wheelrail import wheelrail_fmu
from fmus.profiles.conicity import RadiusDifference
from fmus.wheelrail.contact_table import ContactTable
from fmus.wheelrail.profiled import FROM_TABLE
from orchestrator import System, in_unit

from .changes import swapped
from .hopper import layout_of
from .kept import keep
from .rolling_line import of_fmu, rolling_line

SPACING_TOLERANCE = 0.02
"""Part by which the contacts may be elsewhere than the trucks have them before it is said."""

EQUAL = 1e-6
"""Difference of rolling radii [m] up to which they are equal."""


def nominal_radius(system: System) -> float:
    """Rolling radius of the car's wheels [m]."""
    wheelset = layout_of(system).leading.wheelset
    radius = system.components[wheelset].parameters["rolling_radius"]
    return in_unit(radius, "m", "rolling_radius")


def with_profiles(system: System, pair: ContactTable | Path) -> tuple[System, list[str]]:
    """The car with all four wheelsets on the profiles of a table, or of its FMU; and notes.

    The FMU is built when it is first asked for. Raises HopperError, fmus.ParameterError.
    """
    table, fmu = (of_fmu(pair), pair) if isinstance(pair, Path) else (pair, wheelrail_fmu(pair))
    keep(fmu)
    layout = layout_of(system)
    wheelsets = [w for truck in layout.trucks for w in truck.wheelsets]
    notes = [f"profiles {': '.join(filter(None, (table.name, '; '.join(table.said))))}"]
    for instance in wheelsets:
        coned = system.components[instance]
        kept = {name: v for name, v in coned.parameters.items() if name not in FROM_TABLE}
        components = {**system.components, instance: replace(coned, parameters=kept)}
        system, said = swapped(replace(system, components=components), instance, fmu)
        notes += said
    return system, [*notes, *_off_centre(table), *_elsewhere(system, table)]


def _off_centre(table: ContactTable) -> list[str]:
    """What is to be said where a wheelset does not run in the middle."""
    if table.right is None:
        return []
    radii, line = RadiusDifference.of_table(table), rolling_line(table)
    if abs(radii.at(line)) > EQUAL:
        return [
            f"the rolling radii of {table.name} are equal nowhere on the treads, at "
            f"{1e3 * line:+.3g} mm {1e3 * radii.at(line):+.3g} mm unlike: a free wheelset runs "
            "against a flange"
        ]
    return [
        f"a free wheelset runs {1e3 * line:+.3g} mm off the middle (left above zero), where the "
        "rolling radii are equal"
    ]


def _elsewhere(system: System, table: ContactTable) -> list[str]:
    """What is to be said where the trucks are made for other contact points."""
    given = {
        truck.instance: in_unit(
            system.components[truck.instance].parameters.get(
                "half_contact_spacing", table.half_spacing
            ),
            "m",
            "half_contact_spacing",
        )
        for truck in layout_of(system).trucks
    }
    apart = {
        name: value
        for name, value in given.items()
        if abs(value - table.half_spacing) > SPACING_TOLERANCE * table.half_spacing
    }
    return [
        f"{name} has its wheels' contacts at {value:.4g} m (half_contact_spacing), the profiles at "
        f"{table.half_spacing:.4g} m; give --set {name}.half_contact_spacing="
        f"'{table.half_spacing:.4g} m'"
        for name, value in apart.items()
    ]
