"""Reference results of each block, made without its FMU; they travel in the FMU.

python -m fmus.reference     writes fmus/<block>/reference/*.csv
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from pathlib import Path

import numpy as np

from . import (
    carbody,
    track,
    truck,
    wheelrail,
)
from .carbody import rig as carbody_rig
from .describe.parameters import (
    DEFAULT_SET,
    parameter_set,
)
from .describe.twin import Twin
from .track import rig as track_rig

STEP = 1e-3
"""Communication step [s] of all experiments."""

TIMES = np.linspace(0.0, 1.0, 51)
PLATEAU = 0.02
"""Time [s] for which the inputs of a block without states stand still."""

Values = Mapping[str, float]
Table = dict[str, np.ndarray]
"""Columns by name; the first is `time` [s]."""


@dataclass(frozen=True)
class Experiment:
    """Inputs that stand still while results are read, and the results that belong to them.

    tolerance: largest difference over the largest value of a column, with its reason in `method`.
    parameters: what differs from the values that the FMU starts with.
    """

    block: str
    method: str
    tolerance: float
    compute: Callable[[Values], tuple[Table, Table]]
    parameters: Values = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Where the tables are kept."""
        return Path(__file__).parent / self.block / "reference"


def _held(inputs: Values) -> Table:
    """Inputs that never change."""
    ends = TIMES[[0, -1]]
    return {"time": ends, **{name: np.full(2, value) for name, value in inputs.items()}}


def _carbody(values: Values) -> tuple[Table, Table]:
    """The exponential of the whole modal system, apart from the block's own equations."""
    force = {"front.force_y": 8e3, "front.moment_x": -6e3, "rear.force_z": 5e3}
    force |= {"front.force_z": -2e3, "rear.force_y": -3e3, "rear.moment_z": 4e3}
    motion = [carbody_rig.oracle(values, np.zeros(16), force, {}, duration) for duration in TIMES]
    q, qd = np.hsplit(np.array(motion), 2)
    w = carbody_rig.frequencies(values)
    shapes = {
        end: carbody_rig.mode_shapes(values, sign) for end, sign in carbody.block.ENDS.items()
    }
    loads = {
        end: np.array([force.get(f"{end}.{name}", 0.0) for name in carbody.block.FORCES])
        for end in shapes
    }
    modal = sum(shapes[end].T @ loads[end] for end in shapes)
    qdd = modal - 2 * values["modal_damping"] * w * qd - w**2 * q
    results: Table = {"time": TIMES}
    for end, shape in shapes.items():
        for names, coordinates in (
            (("y", "z", "roll", "yaw"), q),
            (("vy", "vz", "wx", "wz"), qd),
            (("ay", "az", "wx_dot", "wz_dot"), qdd),
        ):
            columns = (coordinates @ shape.T).T
            results |= {f"{end}.{n}": column for n, column in zip(names, columns, strict=True)}
    inertias = ("body_mass", "body_mass", "roll_inertia", "yaw_inertia", "pitch_inertia")
    for i, name in enumerate(("y", "z", "roll", "yaw", "pitch")):
        results[f"cg.{name}"] = q[:, i] / values[inertias[i]] ** 0.5
    for i, name in enumerate(("ay", "az")):
        results[f"cg.{name}"] = qdd[:, i] / values["body_mass"] ** 0.5
    for i in range(8):
        results |= {f"q[{i + 1}]": q[:, i], f"qd[{i + 1}]": qd[:, i]}
    return _held(force), results


def _truck(values: Values) -> tuple[Table, Table]:
    """The Python twin with micro steps five times shorter: springs, stops, slipping friction."""
    inputs = {"car.y": 0.004, "car.yaw": 0.002, "axle[1].force_y": 2e3, "axle[2].force_y": -2e3}
    heights = {"left": 0.006, "right": 0.004}
    inputs |= {f"axle[{k}].rail_z_{side}": z for k in (1, 2) for side, z in heights.items()}
    twin = Twin(truck.Truck(), {**values, "micro_step": values["micro_step"] / 5})
    for name, value in inputs.items():
        twin.set(name, value)
    twin.initialize()
    rows = [twin.outputs()]
    for size in np.diff(TIMES):
        twin.step(float(size))
        rows.append(twin.outputs())
    return _held(inputs), _columns([v.name for v in truck.Truck.outputs], TIMES, rows)


def _wheelrail(values: Values) -> tuple[Table, Table]:
    """The report's linear law, evaluated by hand; flanges strike on some plateaus."""
    rng = np.random.default_rng(1980)
    count = len(TIMES) - 1
    size = {"y": 0.012, "yaw": 4e-3, "vy": 0.05, "wz": 0.02, "rail_y_left": 3e-3}
    size |= {"rail_y_right": 3e-3}
    u = {name: s * rng.uniform(-1, 1, count) for name, s in size.items()}
    u |= {name: rng.uniform(6e4, 1.8e5, count) for name in ("load_left", "load_right")}
    u["speed"] = rng.uniform(5.0, 40.0, count)
    u = {name: np.round(value, 6) for name, value in u.items()}
    half, conicity, radius = (
        values[n] for n in ("half_contact_spacing", "conicity", "rolling_radius")
    )
    y_rel = u["y"] - (u["rail_y_left"] + u["rail_y_right"]) / 2
    gravity = -values["gravity_factor"] * values["axle_load"] * conicity / half * y_rel
    force, moment = gravity.copy(), np.zeros(count)
    results: Table = {}
    for side, sign in (("left", 1), ("right", -1)):
        off = u["y"] - u[f"rail_y_{side}"]
        creep_x = -sign * (conicity * off / radius + half * u["wz"] / u["speed"])
        creep_y = u["vy"] / u["speed"] - u["yaw"]
        force_x = -values["longitudinal_creep_coefficient"] * creep_x
        force_y = -values["lateral_creep_coefficient"] * creep_y
        beyond = np.maximum(sign * off - values["flange_clearance"], 0)
        damped = np.maximum(1 + values["flange_damping"] * sign * u["vy"], 0)
        flange = -sign * values["flange_stiffness"] * beyond * damped
        force += force_y + flange
        moment -= sign * half * force_x
        load = u[f"load_{side}"]
        results |= {
            f"{side}.force_x": force_x,
            f"{side}.force_y": force_y,
            f"{side}.creep_x": creep_x,
            f"{side}.creep_y": creep_y,
            f"{side}.l_over_v": -sign * (force_y + flange + gravity / 2) / load,
            f"{side}.saturation": np.hypot(force_x, force_y)
            / (values["friction_coefficient"] * load),
        }
    ends = TIMES[1:]
    starts = ends - PLATEAU + STEP
    both = np.column_stack([starts, ends]).ravel()
    stimuli = {"time": both, **{name: np.repeat(value, 2) for name, value in u.items()}}
    head = {"time": ends, "force_y": force, "moment_z": moment}
    return stimuli, {**head, **results, "y_rel": y_rel}


def _track(values: Values) -> tuple[Table, Table]:
    """The sum of the spectrum's waves at every axle, without the block's table."""
    speed = 18.288
    distance = speed * TIMES
    behind = 2 * values["half_wheelbase"] * np.array([0, 1, 0, 1])
    behind += 2 * values["half_truck_spacing"] * np.array([0, 0, 1, 1])
    results: Table = {"time": TIMES, "distance": distance, "speed_out": np.full(51, speed)}
    lines = track_rig.lines(values)
    for axle, offset in enumerate(behind, start=1):
        station = np.maximum(distance - offset, 0)
        fade = np.minimum(station / values["fade_length"], 1)
        fade = fade**3 * (10 - 15 * fade + 6 * fade**2)
        channel = {
            name: np.cos(2 * pi * (np.outer(station, frequency) + phase)) @ amplitude
            for name, (frequency, phase, amplitude) in lines.items()
        }
        for middle, across, axis in (("alignment", "gauge", "y"), ("profile", "cross_level", "z")):
            for side, sign in (("left", 1), ("right", -1)):
                rail = channel[middle] + sign * channel[across] / 2
                results[f"axle[{axle}].rail_{axis}_{side}"] = fade * rail
    return _held({"speed": speed}), results


def _columns(names: Sequence[str], times: np.ndarray, rows: Sequence[np.ndarray]) -> Table:
    return {"time": times, **dict(zip(names, np.array(rows).T, strict=True))}


EXPERIMENTS = {
    experiment.block: experiment
    for experiment in (
        Experiment(
            "carbody",
            "Constant forces at both centre plates. Results: the matrix exponential of all modes "
            "at once, with mode shapes derived from rigid-body motion and the beam's shape.",
            1e-8,
            _carbody,
        ),
        Experiment(
            "truck",
            "A carbody that stands displaced, rails that are uneven, constant wheel forces; the "
            "elements slip and strike their stops. Results: the same equations in Python with "
            "micro steps of 5 us in place of 25 us; the tolerance is the error of the latter.",
            1e-3,
            _truck,
            {"micro_step": 2.5e-5},
        ),
        Experiment(
            "wheelrail",
            "Inputs that change every 20 ms and stand still for the rest, flanges on and off the "
            "rails. Results, at the end of each 20 ms: the linear creep law, evaluated by hand.",
            1e-8,
            _wheelrail,
        ),
        Experiment(
            "track",
            "Constant speed over the report's track, seed 1. Results: the sum of 300 waves for "
            "each channel at each axle; the tolerance is the error of interpolating in a table.",
            3e-5,
            _track,
        ),
    )
}


def compute(experiment: Experiment) -> tuple[Table, Table]:
    """Stimuli and results, SI."""
    block = {"carbody": carbody.Carbody, "truck": truck.Truck, "track": track.Track}.get(
        experiment.block, wheelrail.WheelRail
    )
    values = parameter_set(DEFAULT_SET).values(block())
    return experiment.compute({**values, **experiment.parameters})


def write(table: Table, path: Path) -> None:
    """Write the table as CSV: names in the first line, ten digits."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        writer.writerows(
            [f"{x + 0.0:.10g}" for x in row] for row in zip(*table.values(), strict=True)
        )


def read(path: Path) -> Table:
    """The table that `write` wrote."""
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, float).T, strict=True))


if __name__ == "__main__":
    for experiment in EXPERIMENTS.values():
        experiment.folder.mkdir(exist_ok=True)
        for name, table in zip(("stimuli", "results"), compute(experiment), strict=True):
            write(table, experiment.folder / f"{name}.csv")
