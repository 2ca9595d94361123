"""A test rig as a component of a system: it imposes motion or forces on one FMU and reads it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from orchestrator import Component, Connection, InlineModel, Run, System, Value, simulate

from ...car.changes import swapped
from ...car.hopper import hopper_car, vehicle
from ...errors import TracktrainError
from ...failures import heard

Signals = Mapping[str, float]

MOTION = {"y": "m", "yaw": "rad", "vy": "m/s", "wz": "rad/s"}
FORCES = {"force_y": "N", "moment_z": "N.m"}
"""What an axle and its wheelset give each other, and the units."""


def rig(
    outputs: Mapping[str, str],
    inputs: Mapping[str, str],
    law: Callable[[float, Signals], Signals],
    rates: Mapping[str, str] | None = None,
    depends: Mapping[str, tuple[str, ...]] | None = None,
) -> InlineModel:
    """A rig that gives law(time [s], inputs) -> outputs; both with their units.

    The law must be linear in the inputs, with gains that do not change. depends: for each output
    the inputs that it depends on; rates: for an output the one that it is the rate of.
    """
    rest = dict.fromkeys(inputs, 0.0)
    still, pushed = law(0.0, rest), {name: law(0.0, {**rest, name: 1.0}) for name in inputs}
    gains = {
        name: {own: pushed[own][name] - still[name] for own in of}
        for name, of in (depends or {}).items()
    }
    return InlineModel(
        outputs=outputs,
        inputs=inputs,
        derivative_of=rates or {},
        depends=depends or {},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: law(x, u),
        gains=gains if depends else None,
    )


def under_test(car: str, block: str, fmu: Path | None) -> tuple[Path, Mapping[str, Value]]:
    """The FMU of a block of the car, or `fmu` in its place, and the values that it is given."""
    system, instance = hopper_car(car), vehicle(car).layout.instances(block)[0]
    if fmu is not None:
        system, _ = swapped(system, instance, fmu)
    component = system.components[instance]
    return Path(str(component.fmu)), component.parameters


def completed(run: Run, what: str) -> Run:
    """The run; raises TracktrainError for one that stopped, of which `what` tells what it was."""
    if not heard(run).completed:
        raise TracktrainError(f"{what} stopped: {run.message}")
    return run


def run_on_rig(
    fmu: Path,
    parameters: Mapping[str, Value],
    stand: InlineModel,
    duration: float,
    step: float = 1e-3,
) -> Run:
    """Run an FMU `unit` on a rig `rig`: ports of the same name are connected."""
    system = System(
        {"unit": Component(fmu, parameters), "rig": Component(stand)},
        (
            *(Connection(f"rig.{name}", f"unit.{name}") for name in stand.outputs),
            *(Connection(f"unit.{name}", f"rig.{name}") for name in stand.inputs),
        ),
        bonds=(),
    )
    return simulate(system, duration=duration, step=step)
