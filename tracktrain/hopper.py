"""The hopper car, where scripts of the first release import it from."""

from __future__ import annotations

from .car.hopper import hopper_car

__all__ = ["hopper_car"]
