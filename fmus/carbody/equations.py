"""The equations of a carbody by its modes, whatever these are. Equation numbers: README.md."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

import casadi as ca

from ..describe.block import Block, Signals
from ..describe.variables import FRAME_INPUTS
from .oscillator import Transition, oscillator, rigid
from .ports import ENDS, FORCES, INPUTS, MOTIONS, RIGID, TERMINALS, motion_names


class ModalBody(Block):
    """A body of five rigid and any elastic modes, loaded at two centre plates.

    Subclasses state parameters, outputs, states, constants and arrays with the functions of
    `ports`, and shapes. Their derived constants have `frequency` [rad/s] and `damping` (elastic,),
    and `mass`, `roll`, `yaw`, `pitch`: the inverse roots of mass and inertias.

    elastic: names of the elastic modes' initial values.
    points: rows of the shapes at further points, by the point's name.
    """

    inputs = INPUTS
    terminals = TERMINALS
    elastic: tuple[str, ...]
    points: Mapping[str, tuple[str, ...]] = {}

    @property
    def count(self) -> int:
        """Number of all modes."""
        return len(RIGID) + len(self.elastic)

    def shape(self, d: Signals, point: str) -> ca.SX:
        """Motion of a point (rows `MOTIONS`, or those of `points`) over all modes. README (2)"""
        raise NotImplementedError

    def constant(self, p: Signals, d: Signals) -> Signals:
        """The mode shapes, (2)."""
        entries = (ca.vertsplit(ca.vec(self.shape(d, end).T)) for end in ENDS)
        return {
            constant.name: entry
            for constant, entry in zip(self.constants, chain(*entries), strict=True)
        }

    def initial(self, p: Signals, d: Signals, u: Signals) -> Signals:
        """Rigid coordinates divided by the modes' scale, elastic ones as given. README (3)"""
        scale = _rigid_scale(d)
        found = {}
        for kind, suffix in (("q", ""), ("qd", "_rate")):
            for i, mode in enumerate((*RIGID, *self.elastic), start=1):
                name, bracket, index = mode.partition("[")
                value = p[f"initial.{name}{suffix}{bracket}{index}"]
                found[f"{kind}[{i}]"] = value / scale.get(mode, 1)
        return found

    def transition(self, d: Signals, h: ca.SX) -> Signals:
        """What a step does to each elastic mode, (6)."""
        return {
            f"transition[{i}]": oscillator(d["frequency"][i], d["damping"][i], h).column
            for i in range(len(self.elastic))
        }

    def step(
        self, x: Signals, u: Signals, rate: Signals, p: Signals, d: Signals, h: ca.SX
    ) -> tuple[Signals, Signals]:
        """Exact for forces linear over the step, (5), (6)."""
        force, ramp = self._modal_forces(u, d), self._modal_forces(rate, d)
        transitions = [rigid(h)] * len(RIGID) + [
            Transition(*ca.vertsplit(d[f"transition[{i}]"])) for i in range(len(self.elastic))
        ]
        end = {}
        for i, transition in enumerate(transitions, start=1):
            end[f"q[{i}]"], end[f"qd[{i}]"] = transition.apply(
                x[f"q[{i}]"], x[f"qd[{i}]"], force[i - 1], ramp[i - 1]
            )
        return end, {}

    def output(
        self, x: Signals, u: Signals, p: Signals, d: Signals, lookup: ca.SX | None
    ) -> Signals:
        moving = self._coordinate_vectors(x, u, d)
        q, qd, qdd = moving
        y: dict[str, ca.SX] = {}
        for point, rows in {**dict.fromkeys(ENDS, MOTIONS), **self.points}.items():
            shape = self.shape(d, point)
            for names, coordinates in zip(motion_names(rows), moving, strict=True):
                values = ca.vertsplit(shape @ coordinates)
                y |= {f"{point}.{n}": value for n, value in zip(names, values, strict=True)}
        scale = _rigid_scale(d)
        cg = ("cg.y", "cg.z", "cg.roll", "cg.yaw", "cg.pitch")
        y |= {
            name: scale[mode] * q[i] for i, (name, mode) in enumerate(zip(cg, RIGID, strict=True))
        }
        y |= {"cg.ay": d["mass"] * qdd[0], "cg.az": d["mass"] * qdd[1]}
        for i in range(self.count):
            y |= {f"q[{i + 1}]": q[i], f"qd[{i + 1}]": qd[i]}
        return y

    def derivative(self, x: Signals, u: Signals, p: Signals, d: Signals) -> Signals:
        _, qd, qdd = self._coordinate_vectors(x, u, d)
        return {
            f"{name}[{i + 1}]": values[i]
            for name, values in (("q", qd), ("qd", qdd))
            for i in range(self.count)
        }

    def _modal_forces(self, u: Signals, d: Signals) -> list[ca.SX]:
        """Forces on the modal coordinates, (1), or their rates, from inputs or from their rates."""
        forces = ca.vertsplit(
            sum(
                (self.shape(d, end).T @ ca.vertcat(*(u[f"{end}.{name}"] for name in FORCES)))
                for end in ENDS
            )
        )
        carried = _carried(u, d)
        return [force - carried.get(i, 0) for i, force in enumerate(forces)]

    def _coordinate_vectors(self, x: Signals, u: Signals, d: Signals) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Modal coordinates, rates and accelerations, (modes, 1) each."""
        numbers, first = range(1, self.count + 1), len(RIGID)
        q, qd = (ca.vertcat(*(x[f"{n}[{i}]"] for i in numbers)) for n in ("q", "qd"))
        w = d["frequency"]
        restoring = 2 * d["damping"] * w * qd[first:] + w * w * q[first:]
        qdd = ca.vertcat(*self._modal_forces(u, d)) - ca.vertcat(ca.SX(first, 1), restoring)
        return q, qd, qdd


def _carried(u: Signals, d: Signals) -> dict[int, ca.SX]:
    """Modal forces that carry the body along with the car's frame, by the mode's place, (9)."""
    ay, az, wx_dot, wz_dot = (u[port.name] for port in FRAME_INPUTS)
    mass, roll, yaw = ca.vertsplit(d["inertia"])
    return {
        0: mass * (ay - d["height"] * wx_dot),
        1: mass * az,
        2: roll * wx_dot,
        3: yaw * wz_dot,
    }


def _rigid_scale(d: Signals) -> dict[str, ca.SX]:
    """Displacement [m] or rotation [rad] of the body for a unit of each rigid coordinate."""
    factors = ("mass", "mass", "roll", "yaw", "pitch")
    return {mode: d[factor] for mode, factor in zip(RIGID, factors, strict=True)}
