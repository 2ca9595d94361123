"""One car of the sample: its critical speed, its limit cycle and its response, as a row."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan, pi
from typing import Any

import numpy as np

from orchestrator import dominant_frequency, rms, simulate

from ...car.changes import displaced
from ...car.hopper import layout_of
from ...car.modes import critical_speeds
from ...failures import PACKAGES, heard
from ...scales import FOOT
from ...sweep.one import LOAD_RATIOS, Row, session
from ..common.car import StudiedCar
from ..hunting.cycle import observed
from ..hunting.runs import LARGE

SPEEDS = np.linspace(10.0, 250.0, 25) * FOOT
"""Speeds between which the critical one is looked for [m/s]."""

PUSH = "6 mm"
"""Lateral displacement of the front truck from which a limit cycle is looked for."""

QUARTERS = 4
"""Parts of a run on perfect track; the last is the cycle, and tells with the one before whether it
has settled."""

SAME = 0.05
"""Relative change of the amplitude between these two below which it has."""


def one_car(options: Mapping[str, Any]) -> Row:
    """The numbers of a car with other parameters; a run that fails says why under "message".

    options: those of a `StudiedCar`, changes [SI] by parameter; speed [m/s], track, seed, and
    duration [s], of the response and on perfect track; of a response along a line, its end.
    """
    row: Row = {"units": {}, "message": ""}
    for part in (_critical, _cycle, _response):
        try:
            for name, (value, unit) in part(options).items():
                row[name] = value
                row["units"][name] = unit
        except Exception as error:
            if type(error).__module__.partition(".")[0] not in PACKAGES:
                error = RuntimeError(f"{type(error).__name__}: {error}")
            row["message"] = f"{row['message']} {error}".strip()
    return row


Numbers = dict[str, tuple[float, str]]


def _car(options: Mapping[str, Any]) -> StudiedCar:
    return StudiedCar.taken(dict(options))


def _critical(options: Mapping[str, Any]) -> Numbers:
    """The lowest speed at which a mode grows; the ends of the search stand for beyond them."""
    linear = _car(options).linear(options["changes"])
    found = critical_speeds(linear, SPEEDS)
    if found:
        first = found[0]
        return {
            "critical_speed": (first.speed, "m/s"),
            "critical_frequency": (first.root.imag / (2 * pi), "Hz"),
        }
    already = linear.growth(SPEEDS[0]) > 0.0
    return {"critical_speed": (float(SPEEDS[0 if already else -1]), "m/s")}


def _cycle(options: Mapping[str, Any]) -> Numbers:
    """Amplitude and frequency of what is left of a push on perfect track."""
    system = _car(options).system(
        options["changes"], along=False, speed=options["speed"], track="perfect"
    )
    layout = layout_of(system)
    system = displaced(system, layout.front.instance, "lateral", PUSH)
    motion = observed(layout)
    run = simulate(
        system, duration=options["duration"], record=[motion], every=5, session=session()
    )
    if not heard(run).completed:
        raise RuntimeError(str(run.message))
    y = run.dataset[motion]
    before, last = (np.ptp(part) / 2 for part in np.array_split(y.values, QUARTERS)[-2:])
    hunts = last > LARGE
    frequency = dominant_frequency(y[len(y) // 2 :]) if hunts else nan
    return {
        "limit_cycle": (float(last), "m"),
        "limit_cycle_frequency": (float(frequency), "Hz"),
        "hunts": (float(hunts), "1"),
        "settled": (float(abs(last - before) < SAME * max(last, LARGE)), "1"),
    }


def _response(options: Mapping[str, Any]) -> Numbers:
    """Rms of what a run prints, and the largest L/V of any wheel."""
    car = _car(options)
    shape = {name: options[name] for name in ("speed", "track", "seed")}
    if car.layout is None:
        shape["duration"] = options["duration"]
    system = car.system(options["changes"], **shape)
    shown = [s for s in layout_of(system).quantities.values() if not s.variable.endswith(RATIO)]
    names = [s.variable for s in shown]
    run = simulate(
        system,
        duration=system.experiment.stop,
        record=[*names, LOAD_RATIOS],
        session=session(),
    )
    if not heard(run).completed:
        raise RuntimeError(str(run.message))
    data = run.dataset
    ratios = [str(name) for name in data.data_vars if str(name).endswith(RATIO)]
    return {
        **{f"{n}.rms": (rms(data[n]), str(data[n].attrs["units"])) for n in names},
        "l_over_v.max": (max(float(abs(data[name]).max()) for name in ratios), "1"),
    }


RATIO = LOAD_RATIOS.lstrip("*.")
