"""The car's response to irregular track: histories, spectra, and envelopes over realisations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import click
import numpy as np
import pandas as pd
import xarray as xr
from scipy import signal

from orchestrator import Run, Session, System, dominant_frequency, peak, rms, simulate

from ...car.hopper import layout_of, vehicle
from ...car.layout import Layout, Shown
from ...options.car import REPORT_SPEEDS, duration_option, speeds_option, track_option
from ...scales import ANGLE, FOOT, MILE_PER_HOUR, Scale
from ...terminal import Progress, unseen
from ..common.car import CarGiven, StudiedCar, of_options, studied, studied_car_options
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from ..common.rig import completed
from .pictures import envelope_figure, history_sheets, spectra_figure, transfer_figure

SPEEDS = (60 * FOOT, 80 * FOOT, 100 * FOOT)
"""The report's three speeds [m/s]."""

DURATION = 8.0
"""Of a run that goes along no line [s]."""

SEEDS = 20
"""Realisations of the track that envelopes are made of."""

SEGMENT = 4.0
"""Length of the segments that spectra are averaged over [s]; shorter where the run is."""

HIGHEST = 25.0
"""Frequency up to which spectra are kept [Hz]."""

SHARES = (0.05, 0.5, 0.95)
"""Shares of the realisations below the envelopes' lines."""

KINDS = ("rms", "peak")
"""Numbers that envelopes are made of."""

Array = np.ndarray

ALIGNMENT = ("y_left", "y_right")
"""Rails whose mean is the alignment."""


def responses(layout: Layout) -> dict[str, Shown]:
    """What is looked at: the leading axle, the carbody's centre of gravity, the front truck."""
    names = ("force", "displacement", "lateral_acceleration", "vertical_acceleration")
    shown = {name: layout.quantities[name] for name in names}
    return {**shown, "truck_yaw": Shown(f"{layout.front.instance}.q[2]", "truck yaw", ANGLE)}


@taking(speeds=["m/s"], duration="s")
def response(
    car: CarGiven = "loaded",
    track: str = "report",
    speeds: Sequence[float] = SPEEDS,
    duration: float | None = None,
    seeds: int = SEEDS,
    progress: Progress = unseen,
) -> Outcome:
    """Response of the leading axle and the carbody to irregular track, with spectra.

    Report Figures 6-1 to 6-6, of the track's realisation 1, and what the report asks for beside
    them: spectra, coherence and transfer function with the alignment under the leading axle.
    Envelopes are over the realisations 1 to `seeds`. speeds [m/s], duration [s] of each run. Along
    a line runs last as long as the fastest one, and what its curves do is part of all numbers.
    """
    speeds, car = sorted(set(speeds)), studied(car)
    if duration is None:
        duration = DURATION if car.layout is None else _to_the_end(car, speeds[-1])
    drawn: list[xr.Dataset] = []
    found: list[list[Spectra]] = []
    with Session() as session:
        for number, speed in enumerate(speeds):
            found.append([])
            for seed in range(1, seeds + 1):
                system = car.system(speed=speed, track=track, seed=seed, duration=duration)
                run = _run(system, duration, f"{speed:g} m/s with seed {seed}", session)
                found[-1].append(_spectra(run))
                if seed == 1:
                    drawn.append(run.dataset)
                progress((number * seeds + seed) / (len(speeds) * seeds))
    shown = responses(vehicle(car.car).layout)
    data = _dataset(speeds, drawn, found, shown)
    tables = {name: _table(data, name, shown[name].scale) for name in ("force", "displacement")}
    return Outcome(
        title=f"Response to the track {track}, {car}, {duration:g} s",
        dataset=data.assign_attrs(car=str(car), track=track, duration=duration),
        tables={**tables, **{f"{kind}_envelope": _envelope(data, kind, shown) for kind in KINDS}},
        pictures={
            **history_sheets(drawn, speeds, SPEEDS),
            "spectra": spectra_figure(data, shown, SHARES),
            "transfer_functions": transfer_figure(data, shown),
            "envelopes": envelope_figure(data, shown, SHARES),
        },
        notes=_notes(data, duration),
    )


command = study_command(
    "response",
    studied_car_options,
    track_option("report"),
    speeds_option("--speed", "speeds", REPORT_SPEEDS, "Speed of the train."),
    duration_option(
        "8s", "Simulated time of each run.", "8s, or along a line that of the fastest run"
    ),
    click.option(
        "--seeds",
        type=click.IntRange(min=1),
        default=SEEDS,
        show_default=True,
        help="Realisations of the track for the envelopes; the first is drawn.",
    ),
    epilog="""\b
Examples:
  tracktrain study response
  tracktrain study response --car empty --track fra4 --speed "50 mph" --seeds 50
  tracktrain study response --set track.report_rms="0.05 in" --duration 60s
  tracktrain study response --wheel worn --rail crown --layout curve.toml --track fra4""",
)(of_options(response))


@dataclass(frozen=True)
class Spectra:
    """Of one run: rms and peak, one-sided densities, and cross densities with the alignment.

    Arrays are by response; the last of the densities is the alignment's own [m^2/Hz].
    """

    frequency: Array
    rms: Array
    peak: Array
    density: Array
    cross: Array
    segments: int


def _to_the_end(car: StudiedCar, speed: float) -> float:
    """How long [s] the car goes along its line at a speed [m/s]."""
    stop = car.system(speed=speed, track="perfect").experiment.stop
    assert stop is not None
    return stop


def _run(system: System, duration: float, what: str, session: Session) -> Run:
    layout = layout_of(system)
    shown = (shown.variable for shown in responses(layout).values())
    wanted = [*shown, *(layout.rails[name] for name in ALIGNMENT), layout.speed]
    run = simulate(system, duration=duration, record=wanted, session=session)
    return completed(run, f"the run at {what}")


def _spectra(run: Run) -> Spectra:
    """Welch's estimates with half overlapping Hann windows."""
    layout = layout_of(run.dataset)
    found = [run.dataset[shown.variable] for shown in responses(layout).values()]
    alignment = sum(run.dataset[layout.rails[name]].values for name in ALIGNMENT) / 2
    rate = 1 / float(run.time[1] - run.time[0])
    size = min(round(SEGMENT * rate), len(run.time) // 2)
    how = {"fs": rate, "nperseg": size}
    values = np.array([*(r.values for r in found), alignment])
    frequency, density = signal.welch(values, **how)
    _, cross = signal.csd(alignment, values[:-1], **how)
    kept = frequency <= HIGHEST
    return Spectra(
        frequency[kept],
        np.array([rms(r) for r in found]),
        np.array([peak(r) for r in found]),
        density[:, kept],
        cross[:, kept],
        segments=(len(run.time) - size // 2) // (size - size // 2),
    )


def _dataset(
    speeds: Sequence[float],
    drawn: Sequence[xr.Dataset],
    found: Sequence[Sequence[Spectra]],
    shown: Mapping[str, Shown],
) -> xr.Dataset:
    """Histories of the first realisation, numbers and densities of all, transfer functions."""
    first = found[0][0]
    by_seed = ("speed", "seed")
    by_frequency = (*by_seed, "frequency")
    averaged = ("speed", "frequency")
    density = np.array([[s.density for s in line] for line in found])
    cross = np.array([[s.cross for s in line] for line in found]).mean(axis=1)
    mean = density.mean(axis=1)
    own = mean[:, -1]
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = np.abs(cross) / own[:, None]
        coherence = np.abs(cross) ** 2 / (mean[:, :-1] * own[:, None])
    data: dict[str, tuple[tuple[str, ...], Array, dict[str, str]]] = {
        "alignment_density": (by_frequency, density[:, :, -1], {"units": "m2/Hz"})
    }
    for n, (name, r) in enumerate(shown.items()):
        history = np.array([d[r.variable].values for d in drawn])
        unit = drawn[0][r.variable].attrs["units"]
        values = {
            kind: np.array([[getattr(s, kind)[n] for s in line] for line in found])
            for kind in KINDS
        }
        data |= {
            name: (("speed", "time"), history, {"units": unit}),
            f"{name}_rms": (by_seed, values["rms"], {"units": unit}),
            f"{name}_peak": (by_seed, values["peak"], {"units": unit}),
            f"{name}_density": (by_frequency, density[:, :, n], {"units": f"({unit})2/Hz"}),
            f"{name}_coherence": (averaged, coherence[:, n], {"units": "1"}),
            f"{name}_gain": (averaged, gain[:, n], {"units": f"{unit}/m"}),
        }
    coordinates = {
        "speed": ("speed", np.array(speeds), {"units": "m/s"}),
        "seed": ("seed", np.arange(1, len(found[0]) + 1)),
        "time": ("time", drawn[0]["time"].values, {"units": "s"}),
        "frequency": ("frequency", first.frequency, {"units": "Hz"}),
    }
    return xr.Dataset(data, coordinates, {"segments": first.segments * len(found[0])})


def _table(data: xr.Dataset, name: str, scale: Scale) -> pd.DataFrame:
    """Rms and peak of the first realisation, in both systems of units."""
    rows = []
    for speed in data.speed.values:
        one = data.sel(speed=speed)
        row = {"speed [ft/s]": speed / FOOT, "speed [mph]": speed / MILE_PER_HOUR}
        for kind in KINDS:
            value = float(one[f"{name}_{kind}"].sel(seed=1))
            row[f"{kind} [{scale.unit}]"] = value * scale.factor
            row[f"{kind} [{scale.report_unit}]"] = value * scale.report_factor
        rows.append({**row, "dominant frequency [Hz]": dominant_frequency(one[name])})
    return pd.DataFrame(rows).set_index("speed [ft/s]")


def _envelope(data: xr.Dataset, kind: str, shown: Mapping[str, Shown]) -> pd.DataFrame:
    """Rms or peak of all realisations: the shares of `SHARES`."""
    rows = []
    for name, r in shown.items():
        for speed in data.speed.values:
            values = data[f"{name}_{kind}"].sel(speed=speed).values * r.scale.factor
            row = {"response": f"{r.label} [{r.scale.unit}]", "speed [ft/s]": speed / FOOT}
            levels = np.quantile(values, SHARES)
            rows.append(row | dict(zip((f"{s:.0%}" for s in SHARES), levels, strict=True)))
    return pd.DataFrame(rows).set_index(["response", "speed [ft/s]"])


def _notes(data: xr.Dataset, duration: float) -> list[str]:
    segments = int(data.attrs["segments"])
    notes = [
        f"coherence and transfer function are averages over {segments} segments, half overlapping: "
        f"of unrelated signals the coherence would be about {min(1.0, 1.5 / segments):.2g}",
        "the other axles feel the same track later, so that the transfer function is that of the "
        "whole car on its track, with the alignment under the leading axle as the reference",
    ]
    if float(np.abs(data["vertical_acceleration"]).max()) < 1e-9:
        notes.append("this track moves nothing vertically: it has no profile and no cross-level")
    return notes
