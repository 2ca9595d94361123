"""The largest stable macro step, before the run: from the gains around the couplings' loops.

Near the start, with every input held over a step H, the outputs of the slaves of a loop follow

    w(n+1) = w(n) + B u(n),   y = w + D u,   u = K y

w: what of the outputs comes from states; B: its change over a step by the inputs; D: feedthrough;
K: the connections. So w(n+1) = (I + B G) w(n) with G = (I - K D)^-1 K, and each eigenvalue r of
-B G is what c H/m is for a damper c between a mass m and the rest. Its largest stable value is that
of the Adams-Bashforth method whose extrapolation the master shares: 2 held, 1 linear, 6/11
quadratic. A motion that is led by its declared rate, for a force that then runs to its known end,
is Heun's method, 2 again. Inputs by a tangent, and those that are iterated, have none. Only loops
that damp count (|Im r| <= Re r): in those that swing, a large step makes the answer wrong first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack

import numpy as np

from ..errors import CouplingError, OrchestratorError
from ..masters.base import Master
from ..masters.coupling import continuous, dependent
from ..plan.plan import Link, Plan
from ..slaves.session import Session
from .findings import FAR, SelfTest, StepLimit
from .probe import Array, Probe, Start
from .self_test import differences

CLOSE = 0.02
"""Relative change of the limit from one trial to the next that ends the search."""

FORCES = (1e-6, 1e-3, 1.0)
"""Changes of an input to try, relative to its value or 1, until they tell above rounding."""

TELLING = 1e6
"""How many roundings of an output a change of it must have."""


def step_limit(
    start: Start, step: float, master: Master, tests: Mapping[str, SelfTest]
) -> tuple[StepLimit | None, list[str]]:
    """The limit of a system by a master, searched from a step [s] on; and why it is not known.

    None without loops, and where it is not known. tests: self-tests by instance; what failed
    rollback is loaded anew for each trial.
    """
    plan = start.plan
    parts = [set(part) for part in dependent(plan) if len(part) > 1]
    links = [
        k
        for k in plan.links
        if continuous(k) and any({k.source, k.target} <= part for part in parts)
    ]
    if not links:
        return None, []
    distrusted = {n for n, test in tests.items() if test.failed("rollback")}
    rigid = {
        i
        for i, (n, d) in enumerate(zip(plan.names, plan.descriptions, strict=True))
        if n in distrusted or not d.saves_state
    }
    ratios = master.stable_ratios(plan, links, rigid)
    if ratios is None:
        return None, [
            f"largest stable step: not known, since the master '{master.name}' does not say what "
            "ratio it is stable at"
        ]
    weights = np.array([1.0 / ratios[k] for k in links])
    if not np.any(weights):
        return StepLimit(step, math.inf), []
    try:
        with ExitStack() as stack:
            session = stack.enter_context(Session())
            loaded = sorted({i for k in links for i in (k.source, k.target)})
            probes = {i: start.probe(i, session, stack) for i in loaded}
            return _Loops(probes, distrusted, plan, links, weights).limit(step), []
    except OrchestratorError as error:
        return None, [f"largest stable step: not known, since {error}"]


class _Loops:
    """Gains around the loops of `links`, by trials with the instances that they connect."""

    def __init__(
        self,
        probes: Mapping[int, Probe],
        distrusted: set[str],
        plan: Plan,
        links: list[Link],
        weights: Array,
    ) -> None:
        self._probes, self._plan, self._links, self._weights = probes, plan, links, weights
        self._outputs = list(dict.fromkeys((k.source, k.output.name) for k in links))
        self._saved = {
            i for i, p in probes.items() if p.rolls_back and plan.names[i] not in distrusted
        }
        for i in self._saved:
            probes[i].save()
        carried = np.zeros((len(links), len(self._outputs)))
        for n, k in enumerate(links):
            carried[n, self._outputs.index((k.source, k.output.name))] = k.gain
        through = self._columns(self._feedthrough)
        loop = np.eye(len(links)) - carried @ through
        try:
            self._around = np.linalg.solve(loop, carried)
        except np.linalg.LinAlgError:
            raise CouplingError("its algebraic loop has no solution") from None

    def limit(self, step: float) -> StepLimit:
        """The largest stable step, searched from `step` on."""
        rigid = [i for i, probe in self._probes.items() if not probe.description.variable_step]
        size, (ratio, link) = step, self._ratio(step)
        if ratio <= 0.0:
            return StepLimit(step, math.inf)
        for _ in range(6):
            if rigid or size > FAR * step or abs(ratio - 1.0) < CLOSE:
                break
            trial = min(max(size / ratio, size / FAR), 2.0 * FAR * step)
            try:
                found, again = self._ratio(trial)
            except OrchestratorError:  # a step that long is refused
                break
            if found <= 0.0:
                return StepLimit(step, math.inf)
            size, ratio, link = trial, found, again
        largest = size / ratio
        if largest > FAR * step:
            return StepLimit(step, math.inf)
        plan = self._plan
        name = f"{plan.name(link.source, link.output)} -> {plan.name(link.target, link.input)}"
        return StepLimit(step, largest, name)

    def _ratio(self, size: float) -> tuple[float, Link]:
        """Largest r of a step [s] over its limit, and the link that takes most part in it."""
        states = self._columns(lambda probe, i: self._stepped(probe, i, size))
        gains = -(self._weights[:, None] * self._around) @ states
        values, right = np.linalg.eig(gains)
        damping = np.where(np.abs(values.imag) <= values.real, values.real, 0.0)
        worst = int(np.argmax(damping))
        mirrored, left = np.linalg.eig(gains.T)
        same = int(np.argmin(np.abs(mirrored - values[worst])))
        share = np.abs(left[:, same] * right[:, worst])
        # Ratios are of r to its limit; a link that is not led has no part in it.
        return float(damping[worst]), self._links[int(np.argmax(share * (self._weights > 0.0)))]

    def _columns(self, measured: Callable[[Probe, int], Array]) -> Array:
        """Derivatives of the outputs by the inputs, shape (outputs, links)."""
        found = np.zeros((len(self._outputs), len(self._links)))
        for i, probe in self._probes.items():
            names = [v.name for v in probe.outputs]
            rows = [n for n, (owner, _name) in enumerate(self._outputs) if owner == i]
            own = [names.index(self._outputs[n][1]) for n in rows]
            slopes = measured(probe, i)
            for n, k in enumerate(self._links):
                if k.target == i:
                    found[rows, n] = slopes[own, self._place(probe, k)]
        return found

    @staticmethod
    def _place(probe: Probe, link: Link) -> int:
        return next(j for j, v in enumerate(probe.inputs) if v.name == link.input.name)

    def _inputs(self, probe: Probe, i: int) -> Iterator[int]:
        return iter(sorted({self._place(probe, k) for k in self._links if k.target == i}))

    def _feedthrough(self, probe: Probe, i: int) -> Array:
        """By directional derivatives where the FMU gives them, else by differences."""
        slopes = np.zeros((len(probe.outputs), len(probe.inputs)))
        u, base = probe.at_start, probe.get()
        for j in self._inputs(probe, i):
            known = probe.inputs[j]
            depending = [
                n
                for n, v in enumerate(probe.outputs)
                if v.kind == "real" and known.name in (v.dependencies or ())
            ]
            whole = all(v.dependencies is not None for v in probe.outputs)
            if whole and not depending:
                continue
            if whole and probe.description.gives_derivatives:
                unknowns = [probe.outputs[n] for n in depending]
                slopes[depending, j] = probe.directional(unknowns, known)
            else:
                slopes[:, j] = np.mean(differences(probe, u, base, j), axis=0)
        return slopes

    def _stepped(self, probe: Probe, i: int, size: float) -> Array:
        """What a step with a changed input leaves in the outputs once the input is back."""
        slopes = np.zeros((len(probe.outputs), len(probe.inputs)))
        u = probe.at_start
        base = self._after(probe, i, u, size)
        telling = TELLING * np.finfo(float).eps * np.abs(base)
        for j in self._inputs(probe, i):
            for force in FORCES:
                moved = u.copy()
                moved[j] += force * max(1.0, abs(u[j]))
                change = self._after(probe, i, moved, size) - base
                if np.all((change == 0.0) | (np.abs(change) > telling)) and np.any(change):
                    break
            slopes[:, j] = change / (moved[j] - u[j])
        return slopes

    def _after(self, probe: Probe, i: int, inputs: Array, size: float) -> Array:
        if i in self._saved:
            probe.restore()
        else:
            probe.open()
        probe.set(inputs)
        probe.step(size)
        probe.set(probe.at_start)
        return probe.get()
