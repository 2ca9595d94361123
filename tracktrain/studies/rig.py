"""A test rig as a component of a system: it imposes motion or forces on one FMU and reads it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from orchestrator import Mock, Run
    from orchestrator.system import Value

Signals = Mapping[str, float]


def rig(
    outputs: Mapping[str, str],
    inputs: Mapping[str, str],
    law: Callable[[float, Signals], Signals],
    rates: Mapping[str, str] | None = None,
    depends: Mapping[str, tuple[str, ...]] | None = None,
) -> Mock:
    """A rig that gives law(time [s], inputs) -> outputs; both with their units.

    The law must be linear in the inputs. depends: for each output the inputs that it depends on;
    rates: for an output the one that it is the rate of.
    """
    from orchestrator import Mock

    def along(time: float, u: Signals, p: Signals, seed: Signals) -> Signals:
        base, moved = law(time, u), law(time, {name: u[name] + seed[name] for name in u})
        return {name: moved[name] - base[name] for name in base}

    return Mock(
        outputs=outputs,
        inputs=inputs,
        derivative_of=rates or {},
        depends=depends or {},
        initial=lambda p: 0.0,
        step=lambda x, u, rate, p, time, step: time + step,
        output=lambda x, u, p: law(x, u),
        directional=along if depends else None,
    )


def run_on_rig(
    fmu: Path,
    parameters: Mapping[str, Value],
    stand: Mock,
    duration: float,
    step: float = 1e-3,
) -> Run:
    """Run an FMU `unit` on a rig `rig`: ports of the same name are connected."""
    from orchestrator import Component, Connection, System, simulate

    system = System(
        {"unit": Component(fmu, parameters), "rig": Component(stand)},
        (
            *(Connection(f"rig.{name}", f"unit.{name}") for name in stand.outputs),
            *(Connection(f"unit.{name}", f"rig.{name}") for name in stand.inputs),
        ),
        bonds=(),
    )
    return simulate(system, duration=duration, step=step)
