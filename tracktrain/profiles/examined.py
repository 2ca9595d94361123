"""What a wheel on a rail does: contact when centred, conicity, jumps, flange, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fmus.profiles.conicity import RadiusDifference
from fmus.profiles.geometry import ContactGeometry, Track, Wheelset, contact_geometry
from fmus.profiles.tables import flange_begins

BEYOND = 4e-3
"""How far the wheelset is followed up the rail [m]."""
STEP = 1e-4
"""From shift to shift [m]."""
AMPLITUDES = np.arange(0.5e-3, 10.01e-3, 0.25e-3)
"""Of the wave [m]."""
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
    def clearance(self) -> float:
        """Shift at which the left flange touches [m]."""
        return flange_begins(self.wheelset, self.track)[0]

    @cached_property
    def geometry(self) -> ContactGeometry:
        """Contacts from beyond one flange's contact to beyond the other's."""
        count = int(np.ceil((self.clearance + BEYOND) / STEP))
        shifts = STEP * np.arange(-count, count + 1)
        return contact_geometry(self.wheelset, self.track, shifts, self.yaw)

    @cached_property
    def conicity(self) -> Mapping[str, np.ndarray]:
        """Equivalent conicity [1] over `AMPLITUDES`, by method; NaN beyond the shifts."""
        difference = RadiusDifference(self.geometry.shift, self.geometry.radius_difference)
        return {
            name: np.array([method(difference, amplitude) for amplitude in AMPLITUDES])
            for name, method in METHODS.items()
        }

    def conicity_at(self, amplitude: float) -> float:
        """By integration, at an amplitude [m]."""
        difference = RadiusDifference(self.geometry.shift, self.geometry.radius_difference)
        return difference.by_integration(amplitude)

    @property
    def flange_angle(self) -> float:
        """Steepest contact angle [rad]."""
        return float(np.nanmax(np.abs(self.geometry.left.angle)))

    def lines(self) -> list[str]:
        """The findings, a line each, left side."""
        centred = contact_geometry(self.wheelset, self.track, [0.0], self.yaw).left[0]
        curved = f"curvatures of wheel {centred.wheel_curvature:.3g} and rail "
        found = [
            f"centred: contact {centred.on_wheel * 1e3:+.3f} mm from the tape circle, "
            f"{centred.on_rail * 1e3:+.3f} mm from the rail's middle, at "
            f"{np.degrees(centred.angle):.3f} deg; {curved}{centred.rail_curvature:.3g} 1/m",
            f"equivalent conicity at {NORM * 1e3:g} mm (EN 15302, by integration): "
            f"{self.conicity_at(NORM):.4f}",
            f"flange: touches at a shift of {self.clearance * 1e3:.3f} mm; steepest contact "
            f"{np.degrees(self.flange_angle):.2f} deg",
        ]
        jumps = [jump for jump in self.geometry.jumps if jump.side == "left"]
        for jump in jumps:
            found.append(
                f"the contact jumps at a shift of {jump.shift * 1e3:+.3f} mm, from "
                f"{jump.before.on_wheel * 1e3:+.2f} to {jump.after.on_wheel * 1e3:+.2f} mm on the "
                f"wheel ({np.degrees(jump.before.angle):.2f} to "
                f"{np.degrees(jump.after.angle):.2f} deg): both points carry there"
            )
        return found or ["the contact does not jump"]

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
        return {
            "wheel": self.wheelset.left.name,
            "rail": self.track.left.name,
            "said": [*self.wheelset.left.said, *self.track.left.said],
            "clearance": self.clearance,
            "flange_angle": self.flange_angle,
            "conicity_at_3_mm": self.conicity_at(NORM),
            "jumps": jumps,
            "amplitude": AMPLITUDES,
            "conicity": self.conicity,
            "contacts": over,
        }
