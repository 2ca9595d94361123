"""Units of a model whose file has none: a length, a force and a time, the rest follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pint

from fmus.describe.units import registry

from .errors import StructureError

USUAL = ("m, N, s", "mm, N, s", "in, lbf, s")
"""Systems that models are written in. Their masses: kg, t, lbf.s2/in."""

DENSITY = (20.0, 1e5)
"""Least and largest density [kg/m3] that a part of a carbody has, lading smeared over it too."""

YOUNG = (1e9, 1e13)
"""Least and largest Young's modulus [Pa] of a structure's stiffest material."""


@dataclass(frozen=True)
class UnitSystem:
    """What one unit of a model is in SI: length [m], force [N], time [s].

    weight: mass units in one of the model's (the parameter WTMASS of Nastran).
    """

    name: str = "m, N, s"
    length: float = 1.0
    force: float = 1.0
    time: float = 1.0
    weight: float = 1.0

    @property
    def mass(self) -> float:
        """[kg]: what a unit of force accelerates by a unit of length over time squared."""
        return self.weight * self.force * self.time**2 / self.length

    @property
    def pressure(self) -> float:
        """[Pa]"""
        return self.force / self.length**2

    @property
    def density(self) -> float:
        """[kg/m3]"""
        return self.mass / self.length**3


def unit_system(text: str, weight: float = 1.0) -> UnitSystem:
    """That of a text such as "in, lbf, s"; raises StructureError for anything else."""
    found: dict[str, float] = {}
    for word in (part.strip() for part in text.split(",")):
        try:
            quantity = registry().Quantity(1.0, word)
        except (pint.PintError, ValueError, AttributeError, TypeError) as error:
            raise StructureError(f"the units '{text}': '{word}' is no unit; {_advice()}") from error
        for kind, unit in (("length", "m"), ("force", "N"), ("time", "s")):
            if word and quantity.check(f"[{kind}]"):
                if kind in found:
                    raise StructureError(f"the units '{text}' give the {kind} twice; {_advice()}")
                found[kind] = float(quantity.to(unit).magnitude)
                break
        else:
            raise StructureError(
                f"the units '{text}': '{word}' is no length, force or time; {_advice()}"
            )
    missing = [kind for kind in ("length", "force", "time") if kind not in found]
    if missing:
        raise StructureError(f"the units '{text}' lack a {missing[0]}; {_advice()}")
    return UnitSystem(text, **found, weight=weight)


def _advice() -> str:
    return "give a length, a force and a time, such as " + " or ".join(f'"{u}"' for u in USUAL)


def fitting(materials: Sequence[tuple[float, float]], weight: float = 1.0) -> list[str]:
    """The usual systems in which materials (Young's modulus, density) could be real."""
    return [name for name in USUAL if fits(unit_system(name, weight), materials)]


def fits(units: UnitSystem, materials: Sequence[tuple[float, float]]) -> bool:
    """Whether every density, and the stiffest modulus of what has one, could be real."""
    heavy = [(young, density) for young, density in materials if density > 0]
    for _, density in heavy:
        if not DENSITY[0] <= density * units.density <= DENSITY[1]:
            return False
    stiffest = max(young for young, _ in heavy or materials) * units.pressure
    return YOUNG[0] <= stiffest <= (YOUNG[1] if heavy else 1e3 * YOUNG[1])


def check_fit(
    name: str, units: UnitSystem | None, materials: Sequence[tuple[float, float]], weight: float
) -> UnitSystem:
    """The units with this weight, checked; raises StructureError that names those that would fit.

    units None: the user did not say.
    """
    units = units and replace(units, weight=weight)
    would = fitting(materials, weight)
    listed = ", ".join(
        f"E = {young:g} with density {density:g}" for young, density in materials[:4]
    )
    if would:
        hint = "they would be real in " + " or ".join(f'"{u}"' for u in would)
    else:
        hint = (
            "they are real in none of the usual units: " + "; ".join(f'"{u}"' for u in USUAL)
            + ". If densities are weights (steel 0.283 lb/in3) the deck needs PARAM,WTMASS,0.00259;"
            " if kg/mm3, PARAM,WTMASS,0.001"
        )  # fmt: skip
    if units is None:
        raise StructureError(
            f"{name} does not say its units, and they are not guessed; say them with --units. "
            f"Its materials have {listed}: {hint}"
        )
    if not fits(units, materials):
        shown = ", ".join(
            f"E = {young * units.pressure:.3g} Pa with density {density * units.density:.3g} kg/m3"
            for young, density in materials[:4]
        )
        raise StructureError(
            f"{name} is not in the units '{units.name}': its materials ({listed}) would be {shown};"
            f" {hint}"
        )
    return units


def scaled(units: UnitSystem, stiffness: Any, mass: Any) -> tuple[Any, Any]:
    """K and M, six degrees of freedom a node, in SI; sparse ones."""
    count = stiffness.shape[0] // 6
    own = np.tile(np.r_[np.ones(3), np.full(3, units.length)], count)
    both = [a.multiply(own[:, None]).multiply(own[None, :]).tocsc() for a in (stiffness, mass)]
    return units.force / units.length * both[0], units.mass * both[1]
