"""Files of modal data: TOML, the full format, and CSV, one row for a mode and point."""

from __future__ import annotations

import tomllib
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from ..describe.parameters import DEFAULT_SET, Entry, ParameterSet, parameter_set
from ..describe.variables import BASES
from ..errors import ParameterError
from .modal_data import DIRECTIONS, ENDS, PLATE_LOADS, Body, ModalData, Mode, Point
from .modal_table import factor, read_rows

IN_FMU = "extra/org.tracktrain/modal_data.toml"
"""Place of the modal data in the FMU of a carbody."""

Given = Callable[[], ParameterSet]
"""What gives the numbers that a file does not, read when it is needed."""

FIELDS = (
    "name", "provenance", "outputs", "edges", "body", "points", "modes", "residual_flexibility"
)  # fmt: skip
BODY_UNITS = {
    "mass": "kg", "roll_inertia": "kg.m2", "pitch_inertia": "kg.m2", "yaw_inertia": "kg.m2"
}  # fmt: skip


def read_modal_data(path: Path | str, parameters: ParameterSet | None = None) -> ModalData:
    """Modal data of a TOML or CSV file, or of the FMU of a carbody that was made of such.

    Raises ParameterError, with the place in the file.

    parameters: the set that gives body, centre plates and damping where the file does not
        (the loaded car's when none is given).
    """
    path = Path(path)
    readers = {".toml": _from_toml, ".csv": _from_csv, ".fmu": _from_toml}
    if path.suffix.lower() not in readers:
        raise ParameterError(
            f"{path.name} is no file of modes by its name; give .toml (the full format), .csv "
            "(one row for a mode and point) or an .fmu that 'tracktrain carbody' made"
        )
    try:
        text = _content(path).decode("utf-8-sig")
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ParameterError(f"{path.name} is no text in UTF-8: {error.reason}") from error

    def given() -> ParameterSet:
        return parameters or parameter_set(DEFAULT_SET)

    return readers[path.suffix.lower()](path, text, given)


def _content(path: Path) -> bytes:
    if path.suffix.lower() != ".fmu":
        return path.read_bytes()
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.read(IN_FMU)
    except (zipfile.BadZipFile, KeyError) as error:
        raise ParameterError(
            f"{path.name} is no FMU with modal data ({IN_FMU}); 'tracktrain carbody' makes such"
        ) from error


def write_modal_data(data: ModalData, path: Path | str) -> None:
    """Write the data as TOML, in SI; `read_modal_data` gives them back to the last bit."""
    Path(path).write_text(as_text(data), encoding="utf-8")


def as_text(data: ModalData) -> str:
    """The data as TOML."""
    body = data.body
    lines = [f"name = {_text(data.name)}"]
    for name in ("provenance", "outputs", "edges"):
        if getattr(data, name):
            lines.append(f"{name} = {_plain(getattr(data, name))}")
    lines += ["", "[body]"]
    lines += [_given(name, getattr(body, name), unit) for name, unit in BODY_UNITS.items()]
    lines += [f"basis = {_text(body.basis)}", f"source = {_text(body.source)}"]
    lines += ["", "[points]", 'unit = "m"', "[points.positions]"]
    lines += [f"{_text(p.name)} = {_plain(p.position)}" for p in data.points]
    for mode, shape in zip(data.modes, data.shapes, strict=True):
        lines += ["", "[[modes]]", f"name = {_text(mode.name)}"]
        lines += [_given("frequency", mode.frequency, "Hz"), _given("damping", mode.damping, "1")]
        lines += [f"basis = {_text(mode.basis)}", f"source = {_text(mode.source)}"]
        lines += ["[modes.shapes]"]
        lines += [
            f"{_text(p.name)} = {_plain(row)}" for p, row in zip(data.points, shape, strict=True)
        ]
    if data.residual_flexibility is not None:
        lines += ["", "[residual_flexibility]", f"rows = {_plain(PLATE_LOADS)}", "values = ["]
        lines += [f"    {_plain(row)}," for row in data.residual_flexibility]
        lines += ["]"]
    return "\n".join(lines) + "\n"


def _from_toml(path: Path, text: str, given: Given) -> ModalData:
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ParameterError(f"{path.name} is no TOML: {error}") from error
    _known(path.name, content, FIELDS)
    body, said = _body(path, content, given)
    points = _points(path, content, given)
    names = [point.name for point in points]
    modes, shapes = [], []
    listed = content.get("modes", [])
    if not isinstance(listed, list):
        raise ParameterError(f"{path.name}: modes is a table; write [[modes]] before each mode")
    for number, table in enumerate(listed, start=1):
        place = f"{path.name}: mode {table.get('name', number)}"
        _known(place, table, ("shapes", "modal_mass", *(field.name for field in fields(Mode))))
        scale = _number(place, table, "modal_mass", "kg", 1.0) ** -0.5
        modes.append(
            Mode(
                str(table.get("name", number)),
                _number(place, table, "frequency", "Hz"),
                _number(place, table, "damping", "1") if "damping" in table else _damping(given),
                *_where_from(place, table),
            )
        )
        shapes.append(scale * _rows(place, table.get("shapes", {}), names))
    return ModalData(
        str(content.get("name", path.stem)),
        body,
        tuple(modes),
        points,
        np.array(shapes).reshape(len(modes), len(points), len(DIRECTIONS)),
        tuple(content.get("outputs", ())),
        tuple(_edge(path, edge) for edge in content.get("edges", ())),
        _residual(path, content.get("residual_flexibility")),
        (*content.get("provenance", ()), *said),
    )


def _from_csv(path: Path, text: str, given: Given) -> ModalData:
    body, said = _body(path, {}, given)
    table = read_rows(path.name, text, _damping(given))
    plates = {point.name: point for point in _plates(given)}
    points = []
    for name, position in table.positions.items():
        if position is None and name not in plates:
            raise ParameterError(
                f"{path.name}: point {name} has no place; add the columns at_x, at_y, at_z [m] "
                "from the centre of gravity (only front and rear have theirs from the parameters)"
            )
        points.append(plates[name] if position is None else Point(name, *position))
    return ModalData(
        path.stem,
        body,
        table.modes,
        tuple(points),
        table.shapes,
        tuple(name for name in table.positions if name not in ENDS),
        provenance=(f"modes: {path.name}", *said),
    )


def _body(path: Path, content: Mapping[str, Any], given: Given) -> tuple[Body, tuple[str, ...]]:
    """The body, and what is to be said when the parameter set gives it."""
    if "body" not in content:
        found = {name: _entry(given, _PARAMETER.get(name, name)) for name in BODY_UNITS}
        values = {name: found[name].to(unit) for name, unit in BODY_UNITS.items()}
        source = f"parameter set {given().name}"
        return Body(**values, basis="assumed", source=source), (f"body: {source}",)
    place, table = f"{path.name}: [body]", content["body"]
    _known(place, table, (*BODY_UNITS, "basis", "source"))
    values = {name: _number(place, table, name, unit) for name, unit in BODY_UNITS.items()}
    basis, source = _where_from(place, table)
    return Body(**values, basis=basis, source=source), ()


_PARAMETER = {"mass": "body_mass"}


def _entry(given: Given, name: str) -> Entry:
    entry = given().entry(name, "carbody")
    if entry is None:
        raise ParameterError(f"{given().path.name} gives no {name} of the carbody; add it")
    return entry


def _damping(given: Given) -> float:
    return _entry(given, "modal_damping").to("1")


def _plates(given: Given) -> tuple[Point, ...]:
    """The centre plates of a parameter set."""
    half = _entry(given, "half_truck_spacing").to("m")
    height = _entry(given, "gravity_centre_height").to("m")
    return tuple(Point(end, x, 0.0, -height) for end, x in zip(ENDS, (half, -half), strict=True))


def _points(path: Path, content: Mapping[str, Any], given: Given) -> tuple[Point, ...]:
    place, table = f"{path.name}: [points]", content.get("points", {})
    _known(place, table, ("unit", "positions"))
    scale = factor(place, table.get("unit", "m"), "m")
    positions = table.get("positions", {})
    own = set(ENDS) <= set(positions)
    found = {} if own else {point.name: point for point in _plates(given)}
    for name, position in positions.items():
        x, y, z = scale * _numbers(f"{place} {name}", position, ("x", "y", "z"))
        found[name] = Point(name, float(x), float(y), float(z))
    return tuple(found.values())


def _rows(place: str, shapes: Mapping[str, Any], names: Sequence[str]) -> np.ndarray:
    """A mode's shape, (points, 6)."""
    unknown, missing = sorted(set(shapes) - set(names)), [n for n in names if n not in shapes]
    if unknown or missing:
        wrong = f"lacks the point {missing[0]}" if missing else f"has the point {unknown[0]}"
        raise ParameterError(
            f"{place} {wrong}; its shapes are one row ({', '.join(DIRECTIONS)}) for each of the "
            f"{len(names)} points {', '.join(names[:12])}"
        )
    return np.array([_numbers(f"{place}, point {n}", shapes[n], DIRECTIONS) for n in names])


def _residual(path: Path, table: Any) -> np.ndarray | None:
    if table is None:
        return None
    place = f"{path.name}: [residual_flexibility]"
    _known(place, table, ("rows", "values"))
    rows = table.get("rows", list(PLATE_LOADS))
    if sorted(rows) != sorted(PLATE_LOADS):
        raise ParameterError(f"{place} has the rows {rows}; they are {', '.join(PLATE_LOADS)}")
    values = table.get("values", [])
    if len(values) != len(rows):
        raise ParameterError(f"{place} has {len(values)} rows of values; give {len(rows)}")
    matrix = np.array([_numbers(place, row, rows) for row in values])
    order = [rows.index(load) for load in PLATE_LOADS]
    return matrix[np.ix_(order, order)]


def _edge(path: Path, edge: Any) -> tuple[str, str]:
    if not (isinstance(edge, list) and len(edge) == 2 and all(isinstance(n, str) for n in edge)):
        raise ParameterError(f"{path.name}: the edge {edge!r} is no pair of points' names")
    return edge[0], edge[1]


def _known(place: str, table: Any, names: Sequence[str]) -> None:
    if not isinstance(table, dict):
        raise ParameterError(f"{place} is {table!r}; write a table with {', '.join(names)}")
    unknown = sorted(set(table) - set(names))
    if unknown:
        raise ParameterError(
            f"{place} has the unknown entry {', '.join(unknown)}; there are {', '.join(names)}"
        )


def _where_from(place: str, table: Mapping[str, Any]) -> tuple[str, str]:
    basis, source = (str(table.get(name, "")) for name in ("basis", "source"))
    if basis not in BASES or not source:
        raise ParameterError(
            f"{place} has the basis {basis!r} and the source {source!r}; give both, the basis one "
            f"of {', '.join(BASES)}"
        )
    return basis, source


def _number(
    place: str, table: Mapping[str, Any], name: str, unit: str, default: float | None = None
) -> float:
    """A number with its unit, [unit]."""
    given = table.get(name)
    if given is None and default is not None:
        return default
    if not isinstance(given, dict) or set(given) != {"value", "unit"}:
        wrong = f"lacks {name}" if given is None else f"gives {name} as {given!r}"
        raise ParameterError(
            f'{place} {wrong}; write {name} = {{ value = ..., unit = "{_written(unit)}" }}'
        )
    return float(_numbers(f"{place} {name}", [given["value"]], (name,))[0]) * factor(
        f"{place} {name}", given["unit"], unit
    )


def _numbers(place: str, given: Any, names: Sequence[str]) -> np.ndarray:
    """Finite numbers, one for each name."""
    listed = given if isinstance(given, list) else [given]
    plain = [v for v in listed if isinstance(v, int | float) and not isinstance(v, bool)]
    if len(listed) != len(names) or len(plain) != len(names) or not np.isfinite(plain).all():
        raise ParameterError(
            f"{place} is {given!r}; give {len(names)} number(s): {', '.join(names)}"
        )
    return np.array(plain, float)


def _given(name: str, value: float, unit: str) -> str:
    return f"{name} = {{ value = {float(value)!r}, unit = {_text(_written(unit))} }}"


def _written(unit: str) -> str:
    """An FMI unit as parameter files write it: kg*m**2."""
    return unit.replace(".", "*").replace("m2", "m**2")


def _plain(value: Any) -> str:
    """A text, number or (nested) list of them as TOML."""
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, float | int | np.floating):
        return repr(float(value))
    return f"[{', '.join(map(_plain, value))}]"


def _text(text: str) -> str:
    """Text as TOML writes it."""
    shown = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in shown) + '"'
