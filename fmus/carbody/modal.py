"""The carbody of any elastic modes and any points: a block made from modal data."""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import casadi as ca

from ..describe.block import Signals
from ..describe.parameters import Entry, ParameterSet
from ..describe.states import with_nominals
from ..describe.variables import Parameter
from ..errors import ParameterError
from .equations import ModalBody
from .modal_data import DIRECTIONS, ENDS, LARGEST_DAMPING, ModalData
from .ports import (
    CENTRE_OF_GRAVITY,
    MASS,
    MODAL,
    MOTIONS,
    RIGID,
    arrays,
    coordinates,
    initial_values,
    matrix,
    motions,
    shape_constants,
    shape_unit,
    states,
)

INERTIAS = ("body_mass", "roll_inertia", "yaw_inertia")


class ModalCarbody(ModalBody):
    """Carbody of the modes of `data`; its outputs are those of the default, and further points'.

    name: of the block, letters, digits and _. Equation numbers: README.md of this folder.
    """

    home = "carbody"

    def __init__(self, data: ModalData, name: str = "carbody") -> None:
        count = len(data.modes)
        if not count:
            raise ParameterError(f"{data.name} has no elastic mode; give at least one")
        self.data, self.name = data, name
        self.description = (
            f"Freight car body {data.name!r}: five rigid and {count} elastic modes, two centre "
            f"plates, {len(data.outputs)} further points"
        )
        self.elastic = tuple(f"mode[{i}]" for i in range(1, count + 1))
        self.points = dict.fromkeys(data.outputs, DIRECTIONS)
        self._rows = {**dict.fromkeys(ENDS, MOTIONS), **self.points}
        titles = [re.sub(r"[^\w .,()+-]", " ", mode.name) for mode in data.modes]
        self.parameters = (
            *MASS,
            *(place for point in self._rows for place in _place(point)),
            *(p for i, title in enumerate(titles, start=1) for p in _mode(f"mode[{i}]", title)),
            *(p for point, rows in self._rows.items() for p in _shape(point, rows, titles)),
            *initial_values(
                {
                    **{mode: (unit, mode.capitalize()) for mode, unit in RIGID.items()},
                    **{
                        name: (MODAL, f"Modal coordinate of {title}")
                        for name, title in zip(self.elastic, titles, strict=True)
                    },
                }
            ),
        )
        every = (*RIGID, *titles)
        outputs = (
            *(output for end in ENDS for output in motions(end, f"the {end} centre plate")),
            *(o for point in self.points for o in motions(point, f"point {point}", DIRECTIONS)),
            *CENTRE_OF_GRAVITY,
            *coordinates(every),
        )
        self.outputs, self.states = with_nominals(outputs, states(self.count))
        self.constants = shape_constants(every)
        self.arrays = (
            *arrays(every),
            *(
                matrix(
                    f"{point}.elastic_shape",
                    f"Motion of {point} (rows {', '.join(rows)}) over the elastic modes",
                    (len(rows), count),
                )
                for point, rows in self._rows.items()
            ),
        )  # fmt: skip

    @property
    def given(self) -> ParameterSet:
        """The numbers of the data, with unit, basis and source, as a parameter set of the block."""
        data, body = self.data, self.data.body
        values: dict[str, tuple[float, str, str]] = {
            name: (value, body.basis, body.source)
            for name, value in (
                ("body_mass", body.mass),
                ("roll_inertia", body.roll_inertia),
                ("pitch_inertia", body.pitch_inertia),
                ("yaw_inertia", body.yaw_inertia),
            )
        }
        where = "; ".join(data.provenance) or data.name
        for point in self._rows:
            for axis, value in zip("xyz", data.point(point).position, strict=True):
                values[f"{point}.at_{axis}"] = (float(value), "derived", where)
        for i, mode in enumerate(data.modes, start=1):
            values[f"mode[{i}].frequency"] = (mode.frequency, mode.basis, mode.source)
            values[f"mode[{i}].damping"] = (mode.damping, mode.basis, mode.source)
            for point, rows in self._rows.items():
                shape = data.shapes[i - 1, data.index(point)]
                for row, motion in enumerate(rows, start=1):
                    value = float(shape[DIRECTIONS.index(motion)])
                    values[f"{point}.elastic_shape[{row},{i}]"] = (value, mode.basis, mode.source)
        own = {p.name: p for p in self.parameters}
        entries = {
            name: Entry(
                value, own[name].unit, own[name].symbol, basis, source, own[name].description
            )
            for name, (value, basis, source) in values.items()
        }
        return ParameterSet(Path(f"{data.name}.toml"), self.description, {self.name: entries})

    def derived(self, p: Signals) -> Signals:
        """Rigid motion of each point for a unit of the rigid modes, shapes, frequencies."""
        numbers = range(1, len(self.elastic) + 1)
        found = {
            name: 1 / ca.sqrt(p[of])
            for name, of in (
                ("mass", "body_mass"),
                ("roll", "roll_inertia"),
                ("yaw", "yaw_inertia"),
                ("pitch", "pitch_inertia"),
            )
        }
        for point, rows in self._rows.items():
            for turn in ("roll", "pitch", "yaw"):
                for axis in "xyz":
                    found[f"{point}.{turn}_{axis}"] = p[f"{point}.at_{axis}"] * found[turn]
            found[f"{point}.elastic"] = ca.vertcat(
                *(
                    ca.horzcat(*(p[f"{point}.elastic_shape[{row},{i}]"] for i in numbers))
                    for row in range(1, len(rows) + 1)
                )
            )
        return found | {
            "inertia": ca.sqrt(ca.vertcat(*(p[of] for of in INERTIAS))),
            "height": p["centre_plate_height"] - p["front.at_z"],
            "damping": ca.vertcat(*(p[f"mode[{i}].damping"] for i in numbers)),
            "frequency": 2 * pi * ca.vertcat(*(p[f"mode[{i}].frequency"] for i in numbers)),
        }

    def shape(self, d: Signals, point: str) -> ca.SX:
        """Rigid columns: displacement plus rotation times arm, (7)."""
        rows = self._rows[point]
        rigid = ca.SX(len(DIRECTIONS), len(RIGID))
        x, y, z, roll, pitch, yaw = range(len(DIRECTIONS))
        rigid[y, 0], rigid[z, 1] = d["mass"], d["mass"]
        rigid[y, 2], rigid[z, 2] = -d[f"{point}.roll_z"], d[f"{point}.roll_y"]
        rigid[x, 3], rigid[y, 3] = -d[f"{point}.yaw_y"], d[f"{point}.yaw_x"]
        rigid[x, 4], rigid[z, 4] = d[f"{point}.pitch_z"], -d[f"{point}.pitch_x"]
        rigid[roll, 2], rigid[yaw, 3], rigid[pitch, 4] = d["roll"], d["yaw"], d["pitch"]
        own = [DIRECTIONS.index(row) for row in rows]
        return ca.horzcat(rigid[own, :], d[f"{point}.elastic"])


def _place(point: str) -> tuple[Parameter, ...]:
    axes = {"x": "forward", "y": "to the left", "z": "upwards"}
    return tuple(
        Parameter(f"{point}.at_{axis}", "m", f"Place of {point}, {way} from the centre of gravity")
        for axis, way in axes.items()
    )


def _mode(name: str, title: str) -> tuple[Parameter, ...]:
    return (
        Parameter(
            f"{name}.frequency",
            "Hz",
            f"Frequency of {title}, free-free",
            minimum=0.0,
            tunable=True,
        ),
        Parameter(
            f"{name}.damping",
            "1",
            f"Damping ratio of {title}",
            minimum=0.0,
            maximum=LARGEST_DAMPING,
            tunable=True,
        ),
    )


def _shape(point: str, rows: tuple[str, ...], titles: list[str]) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(
            f"{point}.elastic_shape[{row},{column}]",
            shape_unit(motion),
            f"{motion} of {point} for a unit of {title}",
        )
        for row, motion in enumerate(rows, start=1)
        for column, title in enumerate(titles, start=1)
    )
