"""The wheelset alone: the wave that it rolls in, and the speed at which it loses its stability."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from pathlib import Path

import click
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from scipy.linalg import expm
from scipy.optimize import brentq

from fmus.wheelrail.wheelset import Restraint, klingel_wavelength
from orchestrator import Component, Connection, InlineModel, Run, System, Tangent, Value, simulate

from ..car.hopper import parameters_of
from ..options.car import car_option, fmu_option
from ..plots import BLUE, MUTED, RED, STYLE
from ..scales import FOOT
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome
from .common.rig import FORCES, MOTION, completed, under_test
from .common.ringdown import Oscillation, oscillation

LATERAL_STIFFNESS, YAW_STIFFNESS = 2e6, 2e6
"""Of the springs to the ground [N/m, N.m/rad]; assumed, those of a published closed-form case."""

SLOW = 2.0
"""Speed at which inertia does not matter [m/s]."""

ROLLED = 100.0
"""Distance over which the kinematic wave is measured [m]."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Frame:
    """A rigid body on wheelsets at the stations x [m], with springs to the ground, [SI]."""

    mass: float
    inertia: float
    stations: tuple[float, ...] = (0.0,)
    lateral: float = 0.0
    yaw: float = 0.0


@taking(lateral_stiffness="N/m", yaw_stiffness="N.m/rad")
def wheelset(
    car: str = "loaded",
    lateral_stiffness: float = LATERAL_STIFFNESS,
    yaw_stiffness: float = YAW_STIFFNESS,
    settings: Mapping[str, float] | None = None,
    fmu: Path | None = None,
) -> Outcome:
    """Kinematic wave of a free wheelset and of a rigid truck; critical speed of a restrained one.

    Each is found by running the wheel/rail FMU under a mass, and stands beside Klingel's formula
    and the closed form of the restrained wheelset. Stiffnesses [N/m, N.m/rad]; `settings` are
    further parameters [SI] of the block, or `wheelset_mass` and `wheelset_yaw_inertia`. Flange and
    gravity are off, as in the closed forms. `fmu` is a wheel/rail block to test instead of ours.
    """
    settings, parameters = dict(settings or {}), parameters_of(car)
    mass, inertia = (
        settings.pop(name, parameters["truck"][name])
        for name in ("wheelset_mass", "wheelset_yaw_inertia")
    )
    values = parameters["wheelrail"] | {"flange_stiffness": 0.0, "gravity_factor": 0.0, **settings}
    place, given = under_test(car, "wheelrail", fmu)
    stand = _Stand(place, {name: values.get(name, value) for name, value in given.items()})

    half_wheelbase = parameters["truck"]["half_wheelbase"]
    light = Frame(0.01 * mass, 0.01 * inertia)
    rigid = replace(light, stations=(half_wheelbase, -half_wheelbase))
    paths = {
        name: stand.run(frame, SLOW, ROLLED / SLOW)
        for name, frame in (("free wheelset", light), ("rigid truck", rigid))
    }
    formula = {
        "free wheelset": klingel_wavelength(values),
        "rigid truck": klingel_wavelength(values, half_wheelbase),
    }
    held = Frame(mass, inertia, lateral=lateral_stiffness, yaw=yaw_stiffness)
    restraint = Restraint(mass, inertia, lateral_stiffness, yaw_stiffness)
    exact, frequency = restraint.critical_oracle(values)
    critical, found, curve = _critical_speed(stand, held, exact)
    by_roots = restraint.critical_speed(values, 0.5 * exact, 2.0 * exact)
    return Outcome(
        title=f"Wheelset, {car}",
        dataset=_dataset(paths, curve).assign_attrs(
            car=car, lateral_stiffness=lateral_stiffness, yaw_stiffness=yaw_stiffness
        ),
        tables={
            "wavelength": _wavelengths(paths, formula),
            "critical_speed": _criticals(critical, found, by_roots, (exact, frequency)),
        },
        pictures={
            "paths": _path_figure(paths, formula),
            "critical_speed": _growth_figure(curve, restraint, values, exact),
        },
        notes=["flange and gravity are off, as in the closed forms"],
    )


command = study_command(
    "wheelset",
    car_option(),
    click.option(
        "--lateral-stiffness",
        type=click.FloatRange(min=0.0, min_open=True),
        default=LATERAL_STIFFNESS,
        show_default=True,
        metavar="N/M",
        help="Lateral spring to the ground.",
    ),
    click.option(
        "--yaw-stiffness",
        type=click.FloatRange(min=0.0, min_open=True),
        default=YAW_STIFFNESS,
        show_default=True,
        metavar="N.M/RAD",
        help="Yaw spring to the ground.",
    ),
    fmu_option("wheel/rail block"),
    epilog="""\b
Examples:
  tracktrain study wheelset
  tracktrain study wheelset --car empty --lateral-stiffness 5e6""",
)(wheelset)


@dataclass(frozen=True)
class _Stand:
    """Where wheelsets run under a frame."""

    fmu: Path
    parameters: Mapping[str, Value]

    def run(self, frame: Frame, speed: float, duration: float) -> Run:
        """Roll from a yaw of 0.1 mrad at a speed [m/s] for a time [s]."""
        axles = range(1, len(frame.stations) + 1)
        rolling = {**self.parameters, "speed": speed}
        system = System(
            {f"axle_{k}": Component(self.fmu, rolling) for k in axles}
            | {"rig": Component(_mass_on_wheelsets(frame))},
            tuple(
                Connection(*ends)
                for k in axles
                for ends in (
                    *((f"rig.axle[{k}].{n}", f"axle_{k}.{n}") for n in MOTION),
                    *((f"axle_{k}.{n}", f"rig.axle[{k}].{n}") for n in FORCES),
                )
            ),
            bonds=(),
        )
        run = simulate(system, duration=duration, step=2e-3 if speed < 10 else 1e-3)
        return completed(run, f"the wheelset at {speed:g} m/s")


def _mass_on_wheelsets(frame: Frame) -> InlineModel:
    """The frame as a component: exact under loads linear in time and in its motion."""
    axles = range(1, len(frame.stations) + 1)
    inverse = np.diag([1 / frame.mass, 1 / frame.inertia])
    springs = np.diag([frame.lateral, frame.yaw])
    partials = {
        f"axle[{k}].{load}_per_{own}": (k, load, own)
        for k in axles
        for load in FORCES
        for own in MOTION
    }
    moved = np.array([[[1.0, x], [0.0, 1.0]] for x in frame.stations])  # (y, yaw) at each axle

    @cache
    def transition(following: tuple[float, ...], h: float) -> np.ndarray:
        """(motion, motion at the start, loads, their rates) after h, for the axles' partials."""
        slope = np.array(following).reshape(len(frame.stations), 2, 4)
        own = sum(
            m.T @ np.hstack([s[:, :2] @ m, s[:, 2:] @ m])
            for m, s in zip(moved, slope, strict=True)
        )  # fmt: skip
        system = np.zeros((12, 12))
        system[:2, 2:4] = np.eye(2)
        system[2:4, :4] = inverse @ (own - np.hstack([springs, np.zeros((2, 2))]))
        system[2:4, 4:8] = -inverse @ own
        system[2:4, 8:10] = inverse
        system[8:10, 10:12] = np.eye(2)
        return expm(system * h)

    def step(
        x: np.ndarray, u: Values, rate: Values, p: Values, time: float, size: float
    ) -> np.ndarray:
        def loads(signals: Values) -> np.ndarray:
            at_axles = np.array([[signals[f"axle[{k}].{load}"] for load in FORCES] for k in axles])
            return np.einsum("kij,ki->j", moved, at_axles)

        follows = tuple(u[name] for name in partials)
        return (transition(follows, size) @ np.concatenate([x, x, loads(u), loads(rate)]))[:4]

    def output(x: np.ndarray, u: Values, p: Values) -> dict[str, float]:
        at_axle = [np.concatenate([m @ x[:2], m @ x[2:]]) for m in moved]
        return {
            f"axle[{k}].{name}": float(value)
            for k, motion in zip(axles, at_axle, strict=True)
            for name, value in zip(MOTION, motion, strict=True)
        }

    def per(load: str, own: str) -> str:
        return f"{FORCES[load]}/({MOTION[own]})"

    return InlineModel(
        outputs={f"axle[{k}].{n}": unit for k in axles for n, unit in MOTION.items()},
        inputs={f"axle[{k}].{n}": unit for k in axles for n, unit in FORCES.items()}
        | {name: per(load, own) for name, (_, load, own) in partials.items()},
        derivative_of={
            f"axle[{k}].{r}": f"axle[{k}].{n}"
            for k in axles
            for n, r in (("y", "vy"), ("yaw", "wz"))
        },
        tangents=tuple(
            Tangent(f"axle[{k}].{load}", f"axle[{k}].{own}", name)
            for name, (k, load, own) in partials.items()
        ),
        initial=lambda p: np.array([0.0, 1e-4, 0.0, 0.0]),
        step=step,
        output=output,
    )


def _critical_speed(
    stand: _Stand, frame: Frame, near: float
) -> tuple[float, Oscillation, tuple[np.ndarray, np.ndarray]]:
    """Speed [m/s] at which the growth of the motion vanishes, the oscillation there, and the
    growth [1/s] at the speeds that were tried."""
    tried: dict[float, Oscillation] = {}

    def growth(speed: float) -> float:
        run = stand.run(frame, speed, 4.0)
        late = run.dataset["rig.axle[1].y"].sel(time=slice(1.0, None))
        tried[speed] = oscillation(late.time.values, late.values)
        return tried[speed].growth

    for share in (0.6, 0.8, 1.2, 1.4):
        growth(share * near)
    critical = brentq(growth, 0.8 * near, 1.2 * near, xtol=1e-4 * near)
    speeds = np.array(sorted(tried))
    nearest = min(tried, key=lambda speed: abs(speed - critical))
    return critical, tried[nearest], (speeds, np.array([tried[s].growth for s in speeds]))


def _dataset(paths: Mapping[str, Run], curve: tuple[np.ndarray, np.ndarray]) -> xr.Dataset:
    """Lateral motion over the distance of both vehicles, and growth over speed."""
    metres = {"units": "m"}
    motions = {
        f"{name.replace(' ', '_')}.y": ("distance", run.dataset["rig.axle[1].y"].values, metres)
        for name, run in paths.items()
    }
    distance = SLOW * paths["free wheelset"].dataset.time.values
    return xr.Dataset(
        {**motions, "growth": ("speed", curve[1], {"units": "1/s"})},
        {
            "distance": ("distance", distance, metres),
            "speed": ("speed", curve[0], {"units": "m/s"}),
        },
    )


def _wavelengths(paths: Mapping[str, Run], formula: Mapping[str, float]) -> pd.DataFrame:
    rows = {}
    for name, run in paths.items():
        y = run.dataset["rig.axle[1].y"]
        length = SLOW / oscillation(y.time.values, y.values).frequency
        rows[name] = {
            "found [m]": length,
            "found [ft]": length / FOOT,
            "Klingel [m]": formula[name],
            "Klingel [ft]": formula[name] / FOOT,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("vehicle")


def _criticals(
    critical: float,
    found: Oscillation,
    by_roots: tuple[float, float],
    exact: tuple[float, float],
) -> pd.DataFrame:
    ways = {
        "run of the FMU": (critical, found.frequency),
        "eigenvalues of the block": (by_roots[0], by_roots[1] / (2 * pi)),
        "closed form": (exact[0], exact[1] / (2 * pi)),
    }
    columns = ["critical speed [m/s]", "frequency [Hz]"]
    return pd.DataFrame.from_dict(ways, orient="index", columns=columns).rename_axis("by")


@mpl.rc_context(STYLE)
def _path_figure(paths: Mapping[str, Run], formula: Mapping[str, float]) -> Figure:
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    grid = figure.subplots(2, 1, sharex=True)
    for axes, (name, run), colour in zip(grid, paths.items(), (BLUE, RED), strict=True):
        y = run.dataset["rig.axle[1].y"]
        axes.plot(SLOW * y.time, 1e3 * y, color=colour)
        for wave in np.arange(formula[name], float(SLOW * y.time[-1]), formula[name]):
            axes.axvline(wave, color=MUTED, lw=0.8, ls=(0, (4, 3)))
        axes.set_title(f"{name}; dashed: Klingel's wave of {formula[name]:.2f} m")
        axes.set_ylabel("lateral [mm]")
    grid[-1].set_xlabel("distance [m]")
    return figure


@mpl.rc_context(STYLE)
def _growth_figure(
    curve: Sequence[np.ndarray], restraint: Restraint, values: Values, exact: float
) -> Figure:
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    axes = figure.subplots()
    speeds = np.linspace(curve[0].min(), curve[0].max(), 60)
    roots = [restraint.roots(values, speed).real.max() for speed in speeds]
    axes.axhline(0.0, color=MUTED, lw=0.8)
    axes.plot(speeds, roots, color=BLUE, label="eigenvalues of the block")
    axes.plot(*curve, "o", color=RED, markersize=4, label="runs of the FMU")
    axes.axvline(exact, color=MUTED, ls=(0, (4, 3)), label=f"closed form, {exact:.2f} m/s")
    axes.set(xlabel="speed [m/s]", ylabel="growth [1/s]")
    axes.set_title("Restrained wheelset: growth of its oscillation")
    axes.legend(frameon=False)
    return figure
