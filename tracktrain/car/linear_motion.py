"""Small motion of a car, dx/dt = A x, whatever its matrix is made of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fmus.carbody.default_data import default_data, outlined
from fmus.carbody.modal_data import ModalData
from fmus.truck.mass import mass_matrix

from .layout import Layout
from .spreads import Uncertain

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Parameter:
    """A number of the car: its name, the blocks that have it, its value [SI], unit and meaning.

    value: nan where instances have unlike ones.
    """

    name: str
    blocks: tuple[str, ...]
    value: float
    unit: str
    description: str


class LinearMotion(ABC):
    """dx/dt = A x of a car on perfect track.

    states: names of x, by instance. carbody: its modal data, None for the default one.
    """

    layout: Layout
    states: tuple[str, ...]
    carbody: ModalData | None

    @abstractmethod
    def matrix(self, speed: float) -> Array:
        """A at a speed [m/s], (states, states)."""

    @abstractmethod
    def slopes_along(
        self, speed: float, root: complex, numbers: Sequence[Uncertain]
    ) -> tuple[dict[str, complex], complex]:
        """Derivative of an eigenvalue at a speed [m/s] by these numbers, and by the speed.

        By name [1/s per SI unit], with what follows a number. Numbers that the car does not have,
        or has otherwise than they are known, are left out.
        """

    @abstractmethod
    def relative_slopes(self, speed: float, root: complex) -> tuple[dict[str, complex], complex]:
        """Derivative of an eigenvalue at a speed [m/s] by the relative change of each parameter,
        by name [1/s]; and by the speed."""

    @abstractmethod
    def moved(self, speed: float, share: float) -> Iterator[tuple[Parameter, Array, Array]]:
        """Each parameter, and A at a speed [m/s] with more and with less of it, by a share."""

    @abstractmethod
    def values(self, block: str) -> Mapping[str, float]:
        """Parameters of a block [SI]; where its instances have unlike ones, those of the first."""

    @property
    def body(self) -> ModalData:
        """The carbody as modal data that can be drawn."""
        given = self.carbody
        return default_data(self.values("carbody")) if given is None else outlined(given)

    def modes(self, speed: float) -> tuple[Complex, Complex]:
        """Eigenvalues [1/s] with a positive imaginary part, and their shapes in the columns."""
        roots, shapes = np.linalg.eig(self.matrix(speed))
        swinging = roots.imag > 1e-6 * np.abs(roots).max() * 1e-3
        order = np.argsort(roots.imag[swinging])
        return roots[swinging][order], shapes[:, swinging][:, order]

    def growth(self, speed: float) -> float:
        """Largest growth rate [1/s] of any oscillation."""
        roots = np.linalg.eigvals(self.matrix(speed))
        return float(roots.real[roots.imag > 1e-6 * np.abs(roots).max() * 1e-3].max())

    def weights(self, speed: float, root: complex) -> Complex:
        """Derivative of the eigenvalue near `root` by each element of A, (states, states).

        w v^T/(w^T v) with the left and right eigenvectors: exact.
        """
        roots, right = np.linalg.eig(self.matrix(speed))
        place = int(np.abs(roots - root).argmin())
        return np.outer(np.linalg.inv(right)[place], right[:, place])

    def coordinates(self, shapes: Complex) -> Complex:
        """The rows of shapes (states, ...) that are coordinates, those of the carbody first."""
        return shapes[[place for place, name in enumerate(self.states) if ".q[" in name]]

    def energies(self, shape: Complex) -> dict[str, float]:
        """Share of the kinetic energy of a mode in each coordinate, by "instance.q[i]"."""
        shares: dict[str, float] = {}
        at = {name: shape[i] for i, name in enumerate(self.states)}
        for instance in self.layout.bodies:
            rates = [n for n in self.states if n.startswith(f"{instance}.qd[")]
            v = np.array([at[n] for n in rates])
            own = instance == self.layout.carbody
            moved = v if own else np.array(mass_matrix(self.values("truck"))) @ v
            for name, value, momentum in zip(rates, v, moved, strict=True):
                shares[name.replace(".qd[", ".q[")] = float((np.conj(value) * momentum).real) / 2
        total = sum(shares.values())
        return {name: value / total for name, value in shares.items()}
