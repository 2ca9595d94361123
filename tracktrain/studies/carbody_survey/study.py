"""Find the carbody's modes as the report's modal survey did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.carbody.default_data import default_data
from fmus.carbody.modal_data import ModalData
from fmus.carbody.residual import with_residual_modes
from fmus.export.carbody import carbody_fmu
from orchestrator import Value
from structures.springs import RIGID, without_springs

from ...car.carbody import carbody_data
from ...car.hopper import parameters_of, vehicle
from ...errors import TracktrainError
from ...options.car import car_option, carbody_option, fmu_option
from ...plots import BLUE, MUTED, RED, STYLE
from ...terminal import Progress, unseen
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from ..common.rig import under_test
from .found import Found, damping_of, free_of_springs, mode_of, sought
from .rig import DECAY, DWELL, SWEEP, TAIL, AirSprings, Shakers, chirp, dwell, shaken, transfer

TABLE = {
    "bounce on air": (2.15, None),
    "roll on air": (3.30, 3.45),
    "torsion": (6.30, 6.75),
    "lateral bending": (8.85, 17.64),
    "vertical bending": (14.55, 29.57),
}
"""Report Table 4-1 [Hz], loaded and empty."""

Transfer = Mapping[Shakers, xr.Dataset]


@taking()
def carbody_survey(
    car: str = "empty",
    fmu: Path | None = None,
    carbody: ModalData | Path | None = None,
    progress: Progress = unseen,
) -> Outcome:
    """Find the carbody's modes as the report's modal survey did.

    The carbody hangs on air springs; shakers at the centre plates sweep through 0.5 to 45 Hz. A
    mode stands where the imaginary part of acceleration over force peaks (Figure 4-8); its damping
    shows in the decay after a dwell there (Figure 4-9). What the air springs add is taken out by
    (4-20) to (4-23). `fmu` is a carbody to survey instead of ours; its modes are sought where the
    default carbody's are. `carbody` is one of your own (modal data, their file or FMU), whose modes
    are to come back.
    """
    data, place, given = _under_test(car, fmu, carbody)
    springs = AirSprings.under(data.body)
    modes = sought(data, springs)
    vectors = list(dict.fromkeys(mode.shakers for mode in modes))
    jobs, done = len(vectors) + len(modes), 0
    ratios: dict[Shakers, xr.Dataset] = {}
    for shakers in vectors:
        ratios[shakers] = transfer(shaken(place, given, springs, shakers, chirp, SWEEP + TAIL))
        done += 1
        progress(done / jobs)
    found = []
    for mode in modes:
        frequency, rows = mode_of(ratios[mode.shakers], mode)
        decay = shaken(place, given, springs, mode.shakers, dwell(frequency), DWELL + DECAY)
        trace = decay[f"unit.{mode.shakers.accelerometer}"]
        found.append(Found(mode, frequency, damping_of(trace, frequency), rows, trace))
        done += 1
        progress(done / jobs)
    return Outcome(
        title=f"Modal survey of the carbody on air springs, {data.name if carbody else car}",
        dataset=_dataset(ratios, found, car),
        tables={"modes": _table(found, data, springs, car)},
        pictures={
            "figure_4_8": _transfer_figure(ratios, found),
            "figure_4_9": _decay_figure(found),
        },
        notes=[
            f"air springs per end: {springs.stiffness['z'] / 1e6:.3g} MN/m, "
            f"{springs.stiffness['roll'] / 1e6:.3g} MN.m/rad",
            "the air springs are one set for both cars, whose stiffness follows the pressure: it "
            f"grows with the weight on them and {springs.atmosphere:.4g} kg of atmosphere; this "
            "meets Table 4-1's rolls of both cars and the bounce of the loaded one, and gives that "
            "of the empty one, which the report does not print",
            "free: the springs taken out of each mode alone, as the report did (4-23); free, all: "
            "out of all modes at once, which their coupling by the springs asks for",
        ],
    )


command = study_command(
    "carbody-survey",
    car_option("empty"),
    fmu_option("carbody"),
    carbody_option(),
    epilog="""\b
Examples:
  tracktrain study carbody-survey
  tracktrain study carbody-survey --car loaded
  tracktrain study carbody-survey --carbody modes.csv""",
)(carbody_survey)


def _under_test(
    car: str, fmu: Path | None, carbody: ModalData | Path | None
) -> tuple[ModalData, Path, Mapping[str, Value]]:
    """What the carbody is known to be, its FMU, and what that is given."""
    if carbody is None:
        place, given = under_test(car, "carbody", fmu)
        return default_data(parameters_of(car)["carbody"]), place, given
    if fmu is not None:
        raise TracktrainError("fmu and carbody both name what is surveyed; give one of them")
    if isinstance(carbody, ModalData):
        data = with_residual_modes(carbody)
    else:
        data = carbody_data(carbody, car)
        if carbody.suffix.lower() == ".fmu":
            return data, carbody, {}
    return data, carbody_fmu(data), {}


def _table(found: Sequence[Found], data: ModalData, springs: AirSprings, car: str) -> pd.DataFrame:
    known = {mode.name: mode.frequency for mode in data.modes}
    together = free_of_springs(found, springs)
    rows = []
    for f in found:
        elastic = f.mode.coordinate not in RIGID
        free = without_springs(f.frequency, f.rows, springs.matrix)
        printed = TABLE.get(f.mode.name, (None, None))[vehicle(car).parameters == "empty"]
        rows.append(
            {
                "mode": f.mode.name,
                "put in [Hz]": f.mode.frequency,
                "found [Hz]": f.frequency,
                "Table 4-1 [Hz]": np.nan if printed is None else printed,
                "free [Hz]": float(free) if elastic else np.nan,
                "free, all [Hz]": together.get(f.mode.name, np.nan),
                "block [Hz]": known.get(f.mode.coordinate, np.nan),
                "damping [%]": 100 * f.damping,
            }
        )
    return pd.DataFrame(rows).set_index("mode")


def _dataset(ratios: Transfer, found: Sequence[Found], car: str) -> xr.Dataset:
    data = {}
    for shakers, of in ratios.items():
        label = f"{shakers.load}_{'in' if shakers.rear > 0 else 'anti'}phase"
        for name, ratio in of.items():
            for part in ("real", "imag"):
                data[f"{label}.{name}.{part}"] = getattr(ratio, part).drop_attrs()
    for f in found:
        data[f"decay.{f.mode.name.replace(' ', '_')}"] = f.decay
    return xr.Dataset(data, attrs={"car": car})


@mpl.rc_context(STYLE)
def _transfer_figure(ratios: Transfer, found: Sequence[Found]) -> Figure:
    """Imaginary part and phase of each force vector's transfer function, with the modes found."""
    figure = Figure(figsize=(9.0, 1.0 + 2.0 * len(ratios)), layout="constrained")
    grid = figure.subplots(len(ratios), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (shakers, of) in zip(grid, ratios.items(), strict=True):
        ratio = of[shakers.accelerometer]
        axes.semilogx(ratio.frequency, 1e6 * ratio.imag, color=BLUE, label="imaginary part")
        axes.semilogx(ratio.frequency, 1e6 * ratio.real, color=MUTED, lw=0.7, label="real part")
        for f in (f for f in found if f.mode.shakers == shakers):
            axes.axvline(f.frequency, color=RED, lw=0.8, ls=(0, (4, 3)))
            axes.annotate(
                f"{f.mode.name}\n{f.frequency:.2f} Hz", (f.frequency, 1.0), (4, -3),
                xycoords=("data", "axes fraction"), textcoords="offset points", color=RED, va="top",
                fontsize=8,
            )  # fmt: skip
        axes.set_ylabel("[1e-6/kg]" if shakers.load.startswith("force") else "[1e-6/(kg.m2)]")
        phase = "in" if shakers.rear > 0 else "against"
        axes.set_title(f"{shakers.accelerometer} over {shakers.load}, rear {phase} phase")
    grid[0].legend(frameon=False, loc="upper left")
    grid[-1].set_xlabel("frequency [Hz]")
    figure.suptitle(
        "Transfer functions, acceleration over force (report Figure 4-8)", ha="left", x=0.01
    )
    return figure


@mpl.rc_context(STYLE)
def _decay_figure(found: Sequence[Found]) -> Figure:
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    grid = figure.subplots(len(found), 1, sharex=True)
    for axes, f in zip(grid, found, strict=True):
        late = f.decay.sel(time=slice(DWELL, None))
        time = late.time.values - DWELL
        axes.plot(time, late / abs(late).max(), color=BLUE, lw=0.8)
        envelope = np.exp(-2 * pi * f.frequency * f.damping * time)
        for sign in (1, -1):
            axes.plot(time, sign * envelope, color=RED, lw=0.9)
        axes.set_title(f"{f.mode.name}: {f.frequency:.2f} Hz, damping {100 * f.damping:.2f} %")
    grid[-1].set_xlabel("time after the shakers stop [s]")
    figure.suptitle("Decay traces (report Figure 4-9)", ha="left", x=0.01)
    return figure
