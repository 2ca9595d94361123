"""Changes to a hopper car that know what its instances are: another FMU, initial coordinates."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from orchestrator import (
    Connection,
    Description,
    PortMap,
    Profile,
    System,
    Value,
    choices,
    describe,
    is_pattern,
    picked,
    read_profile,
)

from ..columns import file_and_column
from ..errors import HopperError
from .hopper import layout_of

COORDINATE = "initial."


def swapped(
    system: System, instance: str, path: Path, ports: PortMap | None = None
) -> tuple[System, list[str]]:
    """The car with another FMU as `instance`, and notes about what it lacks.

    ports: what the block's names are in the FMU. Parameters that it has keep the car's values,
    converted where it has them in other units; velocities that it does not give are differentiated
    from its positions. Raises HopperError when ports are missing, and orchestrator.FmuError for a
    file that cannot be coupled.
    """
    own = describe(_fmu(system, instance))
    bare = (ports or PortMap()).unitless(own, describe(path))
    ports, found = seen(system, instance, path, ports)
    missing = sorted(name for name in connected_ports(system, instance) if found.find(name) is None)
    if missing:
        block = layout_of(system).blocks[instance]
        raise HopperError(
            f"'{path}' cannot stand in for {instance}: it lacks the ports {', '.join(missing)}; "
            f"give an FMU with all ports of the block '{block}', or a map that says what they are "
            f"called{_straight(system, instance, missing)}"
        )
    swap = system.with_fmu(instance, path, ports)
    component = swap.components[instance]
    kept = {
        name: _with_unit(value, own.variables[name].unit)
        for name, value in component.parameters.items()
        if takes(found, name)
    }
    components = {**swap.components, instance: replace(component, parameters=kept)}
    lacking = [name for name in component.parameters if name not in kept]
    absent = [
        v.name
        for v in (*own.inputs, *own.outputs)
        if found.find(v.name) is None and v.name not in own.partials
    ]
    label = f"{path} as {instance}"
    notes = [
        f"{label} lacks the {what} {', '.join(names)}"
        for what, names in (("parameters", lacking), ("optional ports", absent))
        if names
    ]
    if bare:
        notes.append(
            f"{label} says no units of {len(bare)} variables: taken to be in the block's, SI"
        )
    if ports is not None and ports.rates:
        notes.append(f"{label}: {differentiated(ports)}")
    optional = _optional(system)
    connections = tuple(
        c for c in swap.connections if c not in optional or not _ends_in(c, instance, absent)
    )
    if any(_ends_in(c, instance, absent) for c in in_curves(system)):
        notes.append(
            f"{label} knows no curves: the forces that carry its own masses round a curve are left "
            "out, and what they add to the loads"
        )
    return replace(swap, components=components, connections=connections), notes


def takes(found: Description, name: str) -> bool:
    """Whether an FMU has a variable that can be given a value; what it calculates cannot."""
    variable = found.find(name)
    return variable is not None and variable.takes_value


def curved(system: System) -> System:
    """The car on a track with curves as its track is, with what its blocks need of that.

    Raises HopperError for a block that lacks it.
    """
    layout = layout_of(system)
    connections = tuple(layout.curve_connections())
    for connection in connections:
        instance, _, port = connection.target.partition(".")
        if describe(_fmu(system, instance)).find(port) is None:
            raise HopperError(
                f"{instance} cannot run in a curve: '{_fmu(system, instance)}' lacks the port "
                f"{port}; run it on straight track, or build it again with such ports"
            )
    return replace(system, connections=(*system.connections, *connections))


def in_curves(system: System) -> set[Connection]:
    """The connections of a system that only a track with curves gives."""
    return {*layout_of(system).curve_connections()} & {*system.connections}


def _optional(system: System) -> set[Connection]:
    """Connections that an FMU may lack an end of."""
    layout = layout_of(system)
    return {*layout.optional_connections(), *layout.trucks_in_curves()}


def _straight(system: System, instance: str, missing: Collection[str]) -> str:
    """That an FMU fits on straight track, where it does."""
    bent = {c.target.partition(".")[2] for c in in_curves(system)}
    return "; it can on straight track, without curves" if {*missing} <= bent else ""


def driven(system: System, instance: str, name: str, table: str) -> tuple[System, Profile]:
    """The system with an input that follows a table, FILE or FILE:COLUMN.

    Without a column the table's only one is taken, or that which is called as the input is.
    Raises orchestrator.ProfileError, or CouplingError for an input that cannot be driven.
    """
    path, column = file_and_column(table)
    full = f"{instance}.{name}"
    profile = read_profile(path, column or None, (full, name))
    return system.driven(full, profile), profile


def seen(
    system: System, instance: str, path: Path, ports: PortMap | None
) -> tuple[PortMap | None, Description]:
    """A map fitted to an instance, None if it changes nothing, and an FMU as seen through it."""
    own, found = describe(_fmu(system, instance)), describe(path)
    fitted = (ports or PortMap()).fitted(own, found, connected_ports(system, instance))
    if fitted == PortMap():
        return None, found
    return fitted, fitted.applied(found)


def connected_ports(system: System, instance: str) -> set[str]:
    """Names of the variables that an FMU standing in for `instance` must have."""
    optional = _optional(system)
    needed = (c for c in system.connections if c not in optional)
    ends = [end for c in needed for end in (c.source, c.target)]
    owned = (end.partition(".")[::2] for end in ends)
    return {name for owner, name in owned if owner == instance}


def _ends_in(connection: Connection, instance: str, ports: Collection[str]) -> bool:
    """Whether an end is one of these ports of the instance."""
    ends = (end.partition(".")[::2] for end in (connection.source, connection.target))
    return any(owner == instance and name in ports for owner, name in ends)


def differentiated(ports: PortMap) -> str:
    """Which outputs a map differentiates, and how well."""
    return (
        f"{', '.join(ports.rates)} differentiated from {', '.join(ports.rates.values())}: backward "
        "differences of second order over the macro steps, wrong by a third of the step squared "
        "times the third derivative; 0 at the start"
    )


def changed(system: System, changes: Mapping[str, float]) -> System:
    """The car with other parameters [SI] in all instances that have them.

    changes: values by "block.parameter", or by "parameter" for every block with such a one.
    """
    blocks = layout_of(system).blocks
    values: dict[str, dict[str, float]] = {}
    for name, value in changes.items():
        block, _, parameter = name.partition(".")
        if block not in blocks.values():
            block, parameter = "", name
        for instance, own in blocks.items():
            if block == own or (not block and name in system.components[instance].parameters):
                values.setdefault(instance, {})[parameter] = value
    return system.with_values(values)


def displaced(system: System, instance: str, coordinate: str, value: str) -> System:
    """The car with a coordinate of a truck or of the carbody at `value`, say "0.005 deg".

    Raises HopperError for a coordinate that the instance has not.
    """
    variables = describe(_fmu(system, instance)).variables
    known = [name.removeprefix(COORDINATE) for name in variables if name.startswith(COORDINATE)]
    if not known:
        *others, last = layout_of(system).bodies
        raise HopperError(
            f"{instance} has no initial coordinates; {', '.join(others)} and {last} have"
        )
    if coordinate not in known:
        raise HopperError(
            f"{instance} has no initial coordinate '{coordinate}'; {choices(coordinate, known)}"
        )
    return assigned(system, instance, f"{COORDINATE}{coordinate}", value)


def with_settings(system: System, settings: Sequence[tuple[str, str, str]]) -> System:
    """The car with parameters at values as typed, see `meant`; raises as it and as `assigned`."""
    for (instance, name), value in meant(system, settings).items():
        system = assigned(system, instance, name, value)
    return system


def meant(system: System, settings: Sequence[tuple[str, str, str]]) -> dict[tuple[str, str], str]:
    """Values by instance and name; settings: each an instance, a name and a value, as typed.

    `*` and `?` in an instance mean all that fit and have such a parameter; an instance by its full
    name stands above them. Raises HopperError for a pattern that means none, or what another one
    means with another value.
    """
    given: dict[tuple[str, str], tuple[str, str]] = {}
    exact = {}
    for instance, name, value in settings:
        if instance in system.components or not is_pattern(instance):
            exact[instance, name] = value
            continue
        for one in _fitting(system, instance, name):
            pattern, other = given.setdefault((one, name), (instance, value))
            if other != value:
                raise HopperError(
                    f"{one}.{name} is '{other}' by '{pattern}' and '{value}' by '{instance}'; "
                    "leave out one, or give it by its full name"
                )
    return {target: value for target, (_, value) in given.items()} | exact


def _fitting(system: System, pattern: str, name: str) -> list[str]:
    """The instances that fit a pattern and have a variable; raises HopperError for none."""
    known = {
        instance: describe(component.file).variables
        for instance, component in system.components.items()
        if component.file is not None
    }
    fitting = picked(pattern, known)
    if not fitting:
        raise HopperError(f"no instance fits '{pattern}'; {choices(pattern, known)}")
    found = [instance for instance in fitting if name in known[instance]]
    if not found:
        own = [v for i in fitting for v in known[i].values() if v.causality == "parameter"]
        raise HopperError(
            f"no instance that fits '{pattern}' has a parameter '{name}'; "
            f"{choices(name, dict.fromkeys(v.name for v in own))}"
        )
    return found


def assigned(system: System, instance: str, name: str, value: str) -> System:
    """The car with a parameter of an instance at `value`, say "200 lbf/in".

    Raises HopperError for a number without the unit that it needs; the orchestrator refuses
    whatever else does not fit when the run begins.
    """
    variable = describe(_fmu(system, instance)).variables.get(name)
    unit = variable.unit if variable else None
    if unit not in (None, "", "1") and _is_bare_number(value):
        raise HopperError(
            f"{instance}.{name} cannot be '{value}': the unit is missing; "
            f'write it in {unit} or a unit that measures the same, as in "{value} {unit}"'
        )
    return system.with_value(f"{instance}.{name}", value)


def _with_unit(value: Value, unit: str | None) -> Value:
    """The number as a quantity, so that it means the same in whatever unit it is read."""
    plain = isinstance(value, float) and unit not in (None, "", "1")
    return f"{value!r} {unit}" if plain else value


def _fmu(system: System, instance: str) -> Path:
    if instance not in system.components:
        raise HopperError(
            f"there is no instance '{instance}'; {choices(instance, system.components)}"
        )
    return Path(str(system.components[instance].fmu))


def _is_bare_number(value: str) -> bool:
    try:
        return float(value) != 0.0 and math.isfinite(float(value))
    except ValueError:
        return False
