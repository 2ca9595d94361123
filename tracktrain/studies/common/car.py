"""The car that a study runs: one of ours, on profiles and along a line where that is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial, wraps
from pathlib import Path
from typing import Any

from orchestrator import System

from ...car.changes import changed, with_settings
from ...car.friction import tuned
from ...car.hopper import SPEED, layout_of
from ...car.linear import linear_car
from ...car.linear_fmus import LinearFmus
from ...car.linear_motion import LinearMotion
from ...car.rolling_line import lines_of
from ...options.car import car_option, layout_option, profile_options, set_option
from ...options.chosen import PROFILES, Assigned, Shape, chosen_car
from ...options.fields import adding
from .outcome import Outcome

NO_CHANGES: Mapping[str, float] = {}


@dataclass(frozen=True)
class StudiedCar:
    """A car of `CARS`, and what it has instead of cones, straight track and its parameters' values.

    All but the car's name: as `tracktrain run` takes it.
    """

    car: str = "loaded"
    wheel: str | None = None
    rail: str | None = None
    right_wheel: str | None = None
    right_rail: str | None = None
    right_radius: float | None = None
    layout: str | Path | None = None
    settings: Sequence[Assigned] = ()

    @classmethod
    def taken(cls, options: dict[str, Any]) -> StudiedCar:
        """Take what the options say out of a command's, `cones` and `straight` as of a run."""
        own = {f.name: options.pop(f.name) for f in fields(cls) if f.name in options}
        shape = Shape.taken(own)
        return cls(**{f.name: getattr(shape, f.name) for f in fields(cls)})

    def system(
        self, changes: Mapping[str, float] = NO_CHANGES, along: bool = True, **shape: Any
    ) -> System:
        """The car with its experiment; changes: as of `car.changes.changed`.

        along: its layout, and not straight track. shape: more of `Shape`. Settings stand above
        changes. Raises as `chosen_car`.
        """
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        if self.layout is not None:
            own["layout"] = Path(self.layout) if along else None
        system = changed(chosen_car(Shape.taken(own | shape)), changes)
        return with_settings(system, self.settings) if changes else system

    @staticmethod
    def lines(system: System) -> dict[str, float]:
        """Where each wheelset of such a car runs straight [m], off the middle if sides differ."""
        wheelsets = [axle.wheelset for axle in layout_of(system).axles]
        return lines_of({name: Path(str(system.components[name].fmu)) for name in wheelsets})

    def linear(
        self, changes: Mapping[str, float] = NO_CHANGES, friction: str = "stuck"
    ) -> LinearMotion:
        """For small motion on straight track; friction: a name of `car.friction.FRICTION`."""
        if not any(getattr(self, name) for name in PROFILES) and not self.settings:
            return linear_car(self.car, friction, changes)
        system = self.system(changes, along=False, speed=SPEED, track="perfect")
        return tuned(partial(LinearFmus.of, system), friction)

    def __str__(self) -> str:
        profiles = self.wheel, self.rail, self.right_wheel, self.right_rail
        given = " and ".join(Path(name).stem for name in profiles if name is not None)
        on = f" on {given}" if given else ""
        if self.right_radius is not None:
            on += f", right wheels of {1e3 * self.right_radius:.6g} mm"
        line = f" along {Path(self.layout).name}" if self.layout is not None else ""
        return f"{self.car} car{on}{line}"


CarGiven = str | StudiedCar


def studied(car: CarGiven) -> StudiedCar:
    """A car by its name is one on cones."""
    return car if isinstance(car, StudiedCar) else StudiedCar(car)


straight_car_options = adding((car_option(), profile_options(), set_option()))
"""Of a study on straight track."""

studied_car_options = adding((car_option(), profile_options(), layout_option(), set_option()))


def of_options(study: Callable[..., Outcome]) -> Callable[..., Outcome]:
    """A study that takes what these options say."""

    @wraps(study)
    def call(**given: Any) -> Outcome:
        return study(car=StudiedCar.taken(given), **given)

    return call
