"""Runs of the hunting study: a driver who changes the speed when the motion has settled."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from orchestrator import (
    Component,
    Connection,
    InlineModel,
    Session,
    System,
    dominant_frequency,
    simulate,
)

from ...car.changes import displaced
from ...car.hopper import layout_of
from ...car.values import values_of
from ...scales import FOOT
from ..common.car import CarGiven, StudiedCar, studied
from ..common.rig import completed
from ..common.ringdown import Oscillation, oscillation
from .cycle import Cycle, limit_cycle, needed, observed

WINDOW = 5.0
"""Time over which an amplitude is taken, half the distance between the extremes [s]."""

SETTLED = 2e-3
"""Relative change of the amplitude from one window to the next below which it has settled."""

LARGE = 2e-3
"""Amplitude from which the car hunts [m], as field tests have it: 1 to 2 mm."""

SMALL = 5e-5
"""Amplitude below which a motion that falls has died [m]; it is the disturbance that lets the car
leave an unstable equilibrium at the next speed."""

STAYS = 5e-4
"""Amplitude from which a motion that stays what it is has settled [m]: on profiles limit cycles may
be small. Less may still be on its way."""

RAMP = 5 * FOOT
"""Change of the speed between two plateaus [m/s per s]."""

EVERY, TRANSIENT_EVERY = 5, 2
"""Macro steps between two rows that are kept, of the driven car and of a transient."""

LINEAR, ON_PROFILES = 4e-3, 5e-4
"""Motion of the leading axle up to which friction sticks and no flange touches [m], on cones; and
up to which what profiles do is that of their middle."""

UNEXPLAINED = 0.2
"""Share of a motion that its wave may leave out."""

DRIVER = "driver"
"""The instance that sets the speed, and ends the run."""


@dataclass(frozen=True)
class Transient:
    """A run from the initial yaw at one speed [m/s], its small motion and its limit cycle.

    growth: None where the small motion is not one wave.
    """

    speed: float
    dataset: xr.Dataset
    growth: Oscillation | None
    exact: float
    cycle: Cycle | None


@dataclass(frozen=True)
class Plateau:
    """A speed [m/s] that was held: amplitude [m] by the end of each window, frequency [Hz]."""

    speed: float
    amplitudes: np.ndarray
    frequency: float

    @property
    def amplitude(self) -> float:
        return float(self.amplitudes[-1])

    @property
    def settled(self) -> bool:
        return len(self.amplitudes) > 1 and has_settled(*self.amplitudes[-2:])

    @property
    def hunts(self) -> bool:
        """Whether the motion has settled to a large limit cycle."""
        return self.settled and self.amplitude > LARGE

    def amplitude_after(self, time: float) -> float:
        """Amplitude [m] when so much time [s] was watched; the last one if it settled before."""
        place = min(max(int(time / WINDOW), 1), len(self.amplitudes)) - 1
        return float(self.amplitudes[place])


def has_settled(before: float, now: float) -> bool:
    """Whether an amplitude [m] has died, or stays what it is."""
    died = now < SMALL and now <= before
    return died or (now > STAYS and abs(now - before) < SETTLED * now)


def on_perfect_track(car: CarGiven, speed: float, initial_yaw: float) -> System:
    """The car at a speed [m/s] where it runs straight, its front truck yawed by an angle [rad]."""
    system = studied(car).system(along=False, speed=speed, track="perfect")
    layout = layout_of(system)
    line = StudiedCar.lines(system)[layout.leading.wheelset]
    for body in layout.bodies if line else ():
        system = displaced(system, body, "lateral", f"{line!r} m")
    return displaced(system, layout.front.instance, "yaw", f"{float(initial_yaw)!r} rad")


def transient(
    car: StudiedCar, speed: float, duration: float, initial_yaw: float, session: Session
) -> Transient:
    """Run the car for a time [s] at a speed [m/s] from a yaw [rad] of its front truck."""
    system = on_perfect_track(car, speed, initial_yaw)
    layout = layout_of(system)
    run = simulate(
        system, duration=duration, record=needed(layout), every=TRANSIENT_EVERY, session=session
    )
    y = completed(run, f"the run at {speed:g} m/s").dataset[observed(layout)].values
    y = y - StudiedCar.lines(system)[layout.leading.wheelset]
    large = np.flatnonzero(np.abs(y) > (ON_PROFILES if car.wheel else LINEAR))
    end = int(large[0]) if large.size else len(y)
    late = slice(end - end // 2, end)
    growth = oscillation(run.time[late], y[late] / float(np.abs(y[late]).max()))
    cycles = growth.frequency * (end // 2) * (run.time[1] - run.time[0])
    one_wave = cycles > 1.0 and growth.unexplained < UNEXPLAINED
    half = round(duration / 4 / (run.time[1] - run.time[0]))
    kept = [np.ptp(part) / 2 for part in (y[-2 * half : -half], y[-half:])]
    steady = min(kept) > LARGE / 10 and abs(kept[1] / kept[0] - 1) < 0.02
    values = {name: values_of(system.components[name]) for name in layout.bodies}
    cycle = limit_cycle(run.dataset, values) if steady else None
    exact = car.linear().growth(speed)
    return Transient(speed, run.dataset, growth if one_wave else None, exact, cycle)


def driven(
    system: System, speeds: Sequence[float], longest: float, session: Session
) -> list[Plateau]:
    """Hold one speed [m/s] after the other until the motion has settled, at most `longest` [s].

    The state is carried from plateau to plateau.
    """
    layout = layout_of(system)
    axle, track = observed(layout), system.components[layout.track]
    free = {name: value for name, value in track.parameters.items() if name != "speed"}
    driver = Component(_driver(speeds, longest))
    car = replace(
        system,
        components={
            **system.components,
            layout.track: replace(track, parameters=free),
            DRIVER: driver,
        },
        connections=(
            *system.connections,
            Connection(f"{DRIVER}.speed", f"{layout.track}.speed"),
            Connection(axle, f"{DRIVER}.y"),
        ),
    )
    way = float(np.abs(np.diff(speeds)).sum()) / RAMP
    duration = len(speeds) * (longest + 2 * WINDOW) + way
    with tempfile.TemporaryDirectory() as folder:
        run = simulate(
            car,
            duration=duration,
            record=[axle, f"{DRIVER}.plateau"],
            every=EVERY,
            out=folder,
            session=session,
        )
        if run.outcome is None or run.outcome.instance != DRIVER:
            completed(run, f"the run through {len(speeds)} speeds")
        with run.dataset as dataset:
            return list(_plateaus(dataset, axle, speeds))


def _plateaus(dataset: xr.Dataset, axle: str, speeds: Sequence[float]) -> Iterator[Plateau]:
    place = dataset[f"{DRIVER}.plateau"].values
    time = dataset["time"].values
    for number, speed in enumerate(speeds):
        held = dataset[axle][place == number]
        size = round(WINDOW / (time[1] - time[0]))
        windows = held.values[: len(held) // size * size].reshape(-1, size)
        yield Plateau(speed, np.ptp(windows, axis=1) / 2, dominant_frequency(held[-2 * size :]))


class _Drive:
    """Where the driver is: the plateau, the speed [m/s], and the extremes of the window."""

    def __init__(self, speeds: Sequence[float], longest: float) -> None:
        self.speeds, self.longest = speeds, longest
        self.place, self.speed = 0, float(speeds[0])
        self.held = self.first = self.before = 0.0
        self.low, self.high = np.inf, -np.inf

    @property
    def plateau(self) -> int:
        """Number of the plateau; -1 on the way to it."""
        return self.place if self.speed == self.speeds[self.place] else -1

    def move(self, y: float, step: float) -> None:
        if self.plateau < 0:
            way = self.speeds[self.place] - self.speed
            self.speed += float(np.clip(way, -RAMP * step, RAMP * step))
            if abs(way) <= RAMP * step:
                self.speed = self.speeds[self.place]
            return
        self.low, self.high = min(self.low, y), max(self.high, y)
        self.held += step
        if self.held - self.first < WINDOW - step / 2:
            return
        amplitude = (self.high - self.low) / 2
        done = self.first > 0.0 and has_settled(self.before, amplitude)
        self.before, self.first = amplitude, self.held
        self.low, self.high = np.inf, -np.inf
        if done or self.held >= self.longest - step / 2:
            if self.place + 1 == len(self.speeds):
                raise StopIteration("all speeds were held")
            self.place, self.held, self.first = self.place + 1, 0.0, 0.0


def _driver(speeds: Sequence[float], longest: float) -> InlineModel:
    def step(
        x: _Drive, u: Mapping[str, float], rate: object, p: object, time: float, step: float
    ) -> _Drive:
        x.move(u["y"], step)
        return x

    return InlineModel(
        outputs={"speed": "m/s", "plateau": "1"},
        inputs={"y": "m"},
        initial=lambda p: _Drive(speeds, longest),
        step=step,
        output=lambda x, u, p: {"speed": x.speed, "plateau": float(x.plateau)},
    )


def bisected(
    system: System, low: float, high: float, watched: float, resolution: float, session: Session
) -> list[Plateau]:
    """Speeds [m/s] at which the limit cycle of `high` was brought to, until the lowest that keeps
    it is known to `resolution`; empty where the car does not hunt at `high`.

    Each is watched until it has settled, at most `watched` [s].
    """
    found: list[Plateau] = []
    bottom, top, tried = low, high, low
    while tried == low or top - bottom > resolution:
        above, now = driven(system, [high, tried], watched, session)
        if not above.hunts:
            return []
        found.append(now)
        if now.hunts:
            top = tried
        else:
            bottom = tried
        if top == low:
            break
        tried = (bottom + top) / 2
    return found
