"""What a wheel on a rail does: contact when centred, conicity, jumps, flange, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fmus.profiles.conicity import RadiusDifference
from fmus.profiles.flange import flange_of
from fmus.profiles.geometry import (
    ContactGeometry,
    Track,
    Wheelset,
    contact_geometry,
    level_difference,
)
from fmus.profiles.tables import WITHOUT_FLANGE, flange_begins

BEYOND = 4e-3
"""How far the wheelset is followed up the rail [m]."""
STEP = 1e-4
"""From shift to shift [m]."""
AMPLITUDES = np.arange(0.5e-3, 10.01e-3, 0.25e-3)
"""Of the wave [m]."""
MANY = 6
"""Jumps on one wheel beyond which points are said to scatter."""
NORM = 3e-3
"""Amplitude [m] at which a conicity is quoted."""
METHODS = {
    "integration": RadiusDifference.by_integration,
    "harmonic": RadiusDifference.by_harmonic,
    "regression": RadiusDifference.by_regression,
}
ASPECTS = ("radius", "angle", "on_wheel", "on_rail", "ahead", "wheel_curvature", "rail_curvature")
"""Of `Points`, that are told for each shift."""


@dataclass(frozen=True, eq=False)
class Examined:
    """A wheelset on a track, over shifts to both sides. yaw: [rad], to the left."""

    wheelset: Wheelset
    track: Track
    yaw: float = 0.0

    @cached_property
    def clearances(self) -> tuple[float, float]:
        """Shifts towards the rail at which the left and the right flange touch [m].

        Those to which a wheel is followed that has no flange.
        """
        left = flange_begins(self.wheelset, self.track, self.yaw)
        right = left
        if not self.alike:
            right = flange_begins(self.wheelset.mirrored, self.track.mirrored, -self.yaw)
        found = [WITHOUT_FLANGE - BEYOND if side is None else side[0] for side in (left, right)]
        return found[0], found[1]

    @property
    def alike(self) -> bool:
        """Whether left and right are."""
        return self.wheelset.alike and self.track.alike and self.yaw == 0

    @cached_property
    def geometry(self) -> ContactGeometry:
        """Contacts from beyond one flange's contact to beyond the other's."""
        left, right = (int(np.ceil((clear + BEYOND) / STEP)) for clear in self.clearances)
        return contact_geometry(
            self.wheelset, self.track, STEP * np.arange(-right, left + 1), self.yaw
        )

    @cached_property
    def radii(self) -> RadiusDifference:
        """The difference of rolling radii over the shift."""
        return RadiusDifference(self.geometry.shift, self.geometry.radius_difference)

    @cached_property
    def conicity(self) -> Mapping[str, np.ndarray]:
        """Equivalent conicity [1] over `AMPLITUDES`, by method; NaN beyond the shifts."""
        return {
            name: np.array([method(self.radii, amplitude) for amplitude in AMPLITUDES])
            for name, method in METHODS.items()
        }

    def conicity_at(self, amplitude: float) -> float:
        """By integration, at an amplitude [m]."""
        return self.radii.by_integration(amplitude)

    def level_conicity_at(self, amplitude: float) -> float:
        """The same of a wheelset that does not roll."""
        shift = self.geometry.shift
        difference = level_difference(self.wheelset, self.track, shift, self.yaw)
        return RadiusDifference(shift, difference).by_integration(amplitude)

    @property
    def flange_angles(self) -> tuple[float, float]:
        """Steepest contact angles left and right [rad]."""
        left, right = (
            float(np.nanmax(side.angle)) for side in (self.geometry.left, self.geometry.right)
        )
        return left, right

    def lines(self) -> list[str]:
        """The findings, a line each; of both sides where they differ."""
        found = [
            f"equivalent conicity at {NORM * 1e3:g} mm (EN 15302, by integration): "
            f"{self.conicity_at(NORM):.4f}; {self.level_conicity_at(NORM):.4f} without roll, as "
            "the norm's reference results are"
        ]
        if not self.alike:
            found.append(f"rolling radii are equal at a shift of {self.radii.middle * 1e3:+.3f} mm")
        for side, name in enumerate(("left", "right")[: 1 if self.alike else 2]):
            found += self._side(name, side)
        return found

    def _side(self, side: str, number: int) -> list[str]:
        """What there is to tell of one side."""
        before = "" if self.alike else f"{side}: "
        centred = getattr(contact_geometry(self.wheelset, self.track, [0.0], self.yaw), side)[0]
        ahead = f", {centred.ahead * 1e3:+.3f} mm ahead of the axle" if self.yaw else ""
        found = [
            f"{before}centred contact {centred.on_wheel * 1e3:+.3f} mm from the tape circle, "
            f"{centred.on_rail * 1e3:+.3f} mm from the rail's middle{ahead}, at "
            f"{np.degrees(centred.angle):.3f} deg; curvatures of wheel "
            f"{_curvature(centred.wheel_curvature)} and rail "
            f"{_curvature(centred.rail_curvature)} 1/m",
        ]
        wheel = (self.wheelset.left, self.wheelset.mirrored.left)[number]
        if wheel.flanged:
            flange = flange_of(wheel)
            found.append(
                f"{before}flange {flange.height * 1e3:.2f} mm high, "
                f"{flange.thickness * 1e3:.2f} mm thick, qR {flange.gradient * 1e3:.2f} mm "
                "(EN 15313)"
            )
            found.append(
                f"{before}flange touches at a shift of {self.clearances[number] * 1e3:.3f} mm; "
                f"steepest contact {np.degrees(self.flange_angles[number]):.2f} deg"
            )
        else:
            found.append(f"{before}no flange: followed to {WITHOUT_FLANGE * 1e3:g} mm")
        jumps = [jump for jump in self.geometry.jumps if jump.side == side]
        if len(jumps) > MANY:
            return [
                *found,
                f"{before}the contact jumps {len(jumps)} times, as it does on points that scatter; "
                "smooth them, such as by --say 'smoothing=8 mm'",
            ]
        return found + [
            f"{before}contact jumps at a shift of {jump.shift * 1e3:+.3f} mm, from "
            f"{jump.before.on_wheel * 1e3:+.2f} to {jump.after.on_wheel * 1e3:+.2f} mm on the "
            f"wheel ({np.degrees(jump.before.angle):.2f} to "
            f"{np.degrees(jump.after.angle):.2f} deg): both points touch there"
            for jump in jumps
        ]

    def data(self) -> dict[str, Any]:
        """Everything, for a program: SI."""
        geometry = self.geometry
        over = {
            "shift": geometry.shift,
            "roll": geometry.roll,
            "lift": geometry.lift,
            "radius_difference": geometry.radius_difference,
            **{
                f"{side}.{name}": getattr(getattr(geometry, side), name)
                for side in ("left", "right")
                for name in ASPECTS
            },
            **{
                f"{side}.second_{name}": getattr(getattr(geometry, f"{side}_second"), name)
                for side in ("left", "right")
                for name in ("on_wheel", "angle", "gap")
            },
        }
        jumps = [
            {
                "side": jump.side,
                "shift": jump.shift,
                "on_wheel": [jump.before.on_wheel, jump.after.on_wheel],
                "angle": [jump.before.angle, jump.after.angle],
            }
            for jump in geometry.jumps
        ]
        wheels, rails = ((both.left, both.mirrored.left) for both in (self.wheelset, self.track))
        right = {
            "right_wheel": wheels[1].name,
            "right_rail": rails[1].name,
            "right_said": [*wheels[1].said, *rails[1].said],
            "right_flange": flange_of(wheels[1]) if wheels[1].flanged else None,
        }
        return {
            "wheel": wheels[0].name,
            "rail": rails[0].name,
            "said": [*wheels[0].said, *rails[0].said],
            "flange": flange_of(wheels[0]) if wheels[0].flanged else None,
            **(right if not self.alike else {}),
            "rolling_line": self.radii.middle,
            "clearance": self.clearances,
            "flange_angle": self.flange_angles,
            "conicity_at_3_mm": self.conicity_at(NORM),
            "level_conicity_at_3_mm": self.level_conicity_at(NORM),
            "jumps": jumps,
            "amplitude": AMPLITUDES,
            "conicity": self.conicity,
            "contacts": over,
        }


def _curvature(value: float) -> str:
    """Without the rounding of what is straight."""
    return f"{round(float(value), 6) + 0.0:.3g}"
