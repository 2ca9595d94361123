"""Random inputs of a plausible size, and runs of single FMUs under them."""

from __future__ import annotations

import numpy as np

STEP = 1e-3


def scaled_inputs(instance, rng, names=None):
    """Random inputs of a plausible size: a few mm and mrad, tens of kN, tens of m/s."""
    size = {"m": 5e-3, "rad": 2e-3, "m/s": 0.1, "rad/s": 0.05, "N": 2e4, "N.m": 1e4}
    size |= {"m/s2": 1.0, "rad/s2": 0.05, "1/m": 1e-3}
    values = {}
    for name in names or instance.names("input"):
        unit = instance.variables[name].unit
        values[name] = size.get(unit, 0.0) * rng.uniform(-1, 1)
        if name == "speed":
            values[name] = rng.uniform(5.0, 40.0)
        if name.startswith("load"):
            values[name] = rng.uniform(5e4, 2e5)
    return values


def advance(instance, steps, rng, start=0):
    """Outputs (steps, outputs) of macro steps under random inputs."""
    rows = []
    for k in range(start, start + steps):
        instance.set(scaled_inputs(instance, rng))
        instance.slave.doStep(k * STEP, STEP)
        rows.append(instance.outputs())
    return np.array(rows)


def march(instance, steps, seed, step=1e-4):
    """Derivatives and outputs of explicit Euler steps under random inputs, events included."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(steps):
        instance.slave.newDiscreteStates()
        instance.slave.enterContinuousTimeMode()
        instance.set(scaled_inputs(instance, rng))
        instance.slave.setTime(k * step)
        rates = instance.derivatives()
        pairs = zip(instance.states(), rates, strict=True)
        instance.set_states([x + step * rate for x, rate in pairs])
        instance.slave.completedIntegratorStep()
        rows.append([*rates, *instance.indicators(), *instance.outputs()])
        instance.slave.enterEventMode()
    return rows
