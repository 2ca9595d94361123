"""Reads port maps, from TOML or from SSP parameter maps."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import CouplingError, choices
from ..fmu.archive import read_file
from ..fmu.port_map import Port, PortMap
from ..system.transformation import Linear
from .mapping import read_mapping

ENTRIES = {
    "name": str,
    "sign": int | float,
    "factor": int | float,
    "offset": int | float,
    "unit": str,
}
"""What an entry of a TOML file may say, and of which type it is."""


def read_port_map(path: Path | str) -> PortMap:
    """Read a map from TOML, or from an SSP parameter map (.ssm); raises OrchestratorError."""
    path = Path(path)
    if path.suffix.lower() == ".ssm":
        return _from_ssm(path)
    try:
        said = tomllib.loads(read_file(path, "port map").decode())
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise CouplingError(f"the port map '{path}' is no TOML: {error}") from None
    return PortMap(dict(_entries(path, "", said)))


def _entries(path: Path, prefix: str, said: Mapping[str, Any]) -> Iterator[tuple[str, Port]]:
    """Entries of a table; tables in it are groups of ports, unless they have a name."""
    for key, value in said.items():
        name = f"{prefix}{key}"
        if isinstance(value, str):
            yield name, Port(value)
        elif isinstance(value, dict) and isinstance(value.get("name"), str):
            yield name, _port(path, name, value)
        elif isinstance(value, dict) and value and not value.keys() & ENTRIES.keys():
            yield from _entries(path, f"{name}.", value)
        else:
            raise CouplingError(
                f"the port map '{path}' does not say what {name} is in the FMU; write it like "
                f'{key} = "their_name" or {key} = {{ name = "their_name", sign = -1 }}'
            )


def _port(path: Path, name: str, said: Mapping[str, Any]) -> Port:
    for key, value in said.items():
        if key not in ENTRIES:
            raise CouplingError(
                f"the port map '{path}' says '{key}' of {name}; {choices(key, ENTRIES)}"
            )
        if not isinstance(value, ENTRIES[key]) or isinstance(value, bool):
            wanted = "a text" if ENTRIES[key] is str else "a number"
            raise CouplingError(
                f"the port map '{path}' says {key} = {value!r} of {name}; give {wanted}"
            )
    sign, factor = said.get("sign", 1), float(said.get("factor", 1.0))
    if sign not in (1, -1):
        raise CouplingError(f"the port map '{path}' says sign = {sign} of {name}; give 1 or -1")
    if factor == 0.0:
        raise CouplingError(f"the port map '{path}' says factor = 0 of {name}; give another")
    return Port(said["name"], sign * factor, float(said.get("offset", 0.0)), said.get("unit"))


def _from_ssm(path: Path) -> PortMap:
    ports = {}
    for entry in read_mapping(path):
        to = entry.transformation
        if not isinstance(to, Linear) or to.factor == 0.0:
            raise CouplingError(
                f"the parameter map '{path}' sends {entry.source} to {entry.target} through "
                f"{'a map of values' if not isinstance(to, Linear) else 'a factor of 0'}; ports "
                "take a linear transformation with another factor"
            )
        ports[entry.source] = Port(entry.target, 1.0 / to.factor, -to.offset / to.factor)
    return PortMap(ports)
