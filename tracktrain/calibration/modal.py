"""Measured frequencies and damping ratios against the linear car, with exact derivatives."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.optimize import linear_sum_assignment

from orchestrator import choices

from ..car.linear import LinearCar, linear_car
from ..car.linear_motion import Complex
from ..car.modes import name_of
from ..errors import TracktrainError
from .chosen import Chosen
from .evidence import Array, Group

NUMBERED = re.compile(r"(?P<name>.*\S)\s+(?P<number>\d+)")
"""A mode's name with its place among those that are called so, from the lowest frequency on."""

KINDS = {"frequency": "frequencies", "damping": "damping ratios"}

GUESS = 0.02
"""Relative deviation that a fit begins with where none is given."""


@dataclass(frozen=True)
class Mode:
    """A measured number of a mode: kind of `KINDS`, value [Hz, or 1], its deviation (0 for not
    known), speed [m/s]."""

    kind: str
    mode: str
    value: float
    deviation: float
    speed: float


class Modal:
    """Modes of the linear car, each followed from its shape at the start by likeness.

    values: [SI] that the car has instead of its set's, by "block.parameter". Raises TracktrainError
    for a mode that the car has not.
    """

    def __init__(
        self,
        measured: Sequence[Mode],
        chosen: Sequence[Chosen],
        car: str,
        friction: str,
        values: Mapping[str, float],
    ) -> None:
        self.measured = sorted(measured, key=lambda m: (m.kind, not m.deviation))
        self.car, self.friction, self.values = car, friction, dict(values)
        self.omega = linear_car(car, friction, self.values).omega
        self.names = _of_linear_car(chosen, self._linear({}))
        self.chosen = tuple(chosen)
        self._shapes: dict[tuple[str, float], Complex] = {}
        self._find()
        sizes: dict[tuple[str, bool], int] = {}
        for m in self.measured:
            key = m.kind, bool(m.deviation)
            sizes[key] = sizes.get(key, 0) + 1
        self.groups = [
            Group(
                KINDS[kind],
                (1,) * count,
                1.0 if given else GUESS,
                given,
                "over their deviations" if given else "relative",
            )
            for (kind, given), count in sizes.items()
        ]

    def with_parameters(self, chosen: Sequence[Chosen]) -> Modal:
        """The same with further parameters, which the linear car has not."""
        self.chosen = tuple(chosen)
        self.names = _of_linear_car(chosen, self._linear({}))
        return self

    def residuals(self, at: Array) -> list[Array]:
        found = self.modelled(at)
        return self._split(
            np.array([(v - m.value) / _size(m) for v, m in zip(found, self.measured, strict=True)])
        )

    def modelled(self, at: Array) -> list[float]:
        """What the car has for each measured number."""
        roots = self._roots(self._linear_at(at), keep=False)
        return [_number(m.kind, roots[m.mode, m.speed]) for m in self.measured]

    def slopes(self, at: Array) -> list[Array]:
        linear = self._linear_at(at)
        roots = self._roots(linear, keep=True)
        along = {
            key: np.array(
                [
                    sum(f * slope.get(n, 0.0) for n, f in _parts(c, name).items()) if name else 0.0
                    for c, name in zip(self.chosen, self.names, strict=True)
                ]
            )
            for key, root in roots.items()
            for slope in (linear.slopes(key[1], root)[0],)
        }
        rows = [
            _derivative(m.kind, roots[m.mode, m.speed], along[m.mode, m.speed]) / _size(m)
            for m in self.measured
        ]
        return self._split(np.array(rows))

    def _split(self, rows: Array) -> list[Array]:
        return np.split(rows, np.cumsum([group.count for group in self.groups])[:-1])

    def _linear_at(self, at: Array) -> LinearCar:
        named = zip(self.chosen, self.names, at, strict=True)
        return self._linear(
            {n: f * v for c, name, v in named if name for n, f in _parts(c, name).items()}
        )

    def _linear(self, changes: Mapping[str, float]) -> LinearCar:
        return LinearCar(self.car, {**self.values, **changes}, self.friction, self.omega)

    def _find(self) -> None:
        """The shape of each measured mode in the car that the fit begins with."""
        start = self._linear_at(np.array([c.start for c in self.chosen]))
        for speed in {m.speed for m in self.measured}:
            roots, shapes = start.modes(speed)
            names = [name_of(start, shapes[:, n]) for n in range(len(roots))]
            taken: dict[int, str] = {}
            for mode in dict.fromkeys(m.mode for m in self.measured if m.speed == speed):
                frequency = next(
                    (
                        m.value
                        for m in self.measured
                        if (m.kind, m.mode, m.speed) == ("frequency", mode, speed)
                    ),
                    None,
                )
                place = _place(mode, names, roots.imag / (2 * pi), frequency)
                if place in taken:
                    raise TracktrainError(
                        f"'{mode}' and '{taken[place]}' are one mode of the car, at "
                        f"{roots[place].imag / (2 * pi):.3g} Hz; call them apart by a number, such "
                        f"as '{mode} 1', from the lowest frequency on"
                    )
                taken[place] = mode
                self._shapes[mode, speed] = shapes[:, place]

    def _roots(self, linear: LinearCar, keep: bool) -> dict[tuple[str, float], complex]:
        """Eigenvalues [1/s] of the modes most like those before; keep: for the next."""
        found = {}
        for speed in {speed for _, speed in self._shapes}:
            keys = [key for key in self._shapes if key[1] == speed]
            roots, shapes = linear.modes(speed)
            before = np.array([self._shapes[key] for key in keys])
            lines, columns = linear_sum_assignment(-np.abs(before.conj() @ shapes))
            for line, column in zip(lines, columns, strict=True):
                found[keys[line]] = complex(roots[column])
                if keep:
                    self._shapes[keys[line]] = shapes[:, column]
        return found


def _parts(one: Chosen, name: str) -> dict[str, float]:
    """What changes with a parameter in the linear car, by what it calls it; factors."""
    return {name: 1.0} | {f.target.partition(".")[2]: f.factor for f in one.followers}


def _of_linear_car(chosen: Sequence[Chosen], linear: LinearCar) -> list[str]:
    """What the linear car calls the parameters; empty for the clock and for numbers of the track.

    Raises TracktrainError for those of one of several instances.
    """
    known = {p.name: p for p in linear.parameters}
    names = []
    for one in chosen:
        found = known.get(one.parameter)
        if not one.targets or found is None or _instances(one) == {linear.layout.track}:
            names.append("")
            continue
        blocks = {linear.layout.blocks[instance] for instance in _instances(one)}
        whole = {i for block in found.blocks for i in linear.layout.instances(block)}
        if _instances(one) != whole:
            name = one.parameter if len(found.blocks) > 1 else f"{blocks.pop()}.{one.parameter}"
            raise TracktrainError(
                f"{one.name} is of {', '.join(sorted(_instances(one)))} alone, and the linear car "
                f"has it alike in {', '.join(sorted(whole))}; name it '{name}', or leave out modes"
            )
        names.append(one.parameter)
    return names


def _instances(one: Chosen) -> set[str]:
    return {target.partition(".")[0] for target in one.targets}


def _place(mode: str, names: Sequence[str], frequencies: Array, frequency: float | None) -> int:
    """Which mode of the car is called so; raises TracktrainError where none or several are."""
    numbered = NUMBERED.fullmatch(mode) if mode not in names else None
    name = numbered["name"] if numbered else mode
    found = [n for n, known in enumerate(names) if known == name]
    found = found or [n for n, known in enumerate(names) if known.split(" + ")[0] == name]
    found = found or [n for n, known in enumerate(names) if name in known.split(" + ")]
    at = {n: f"{names[n]} ({frequencies[n]:.3g} Hz)" for n in range(len(names))}
    if not found:
        raise TracktrainError(
            f"the car has no mode '{mode}'; {choices(name, dict.fromkeys(names))}; they are "
            f"{', '.join(at.values())}"
        )
    if numbered:
        if not 1 <= int(numbered["number"]) <= len(found):
            raise TracktrainError(
                f"there is no mode '{mode}': {len(found)} of the car's are called {name}, "
                f"{', '.join(at[n] for n in found)}"
            )
        return found[int(numbered["number"]) - 1]
    if frequency is None and len(found) > 1:
        raise TracktrainError(
            f"'{mode}' could be {' or '.join(at[n] for n in found)}; give its frequency, too, or "
            f"call it '{mode} 1' or the like, from the lowest frequency on"
        )
    if frequency is None:
        return found[0]
    return min(found, key=lambda n: abs(np.log(frequencies[n] / frequency)))


def _number(kind: str, root: complex) -> float:
    return root.imag / (2 * pi) if kind == "frequency" else -root.real / abs(root)


def _derivative(kind: str, root: complex, along: Complex) -> Array:
    """Of the frequency or the damping ratio, from that of the eigenvalue."""
    if kind == "frequency":
        return np.asarray(along.imag / (2 * pi))
    size = abs(root)
    return np.asarray(-along.real / size + root.real * (np.conj(root) * along).real / size**3)


def _size(m: Mode) -> float:
    return m.deviation or abs(m.value) or GUESS
