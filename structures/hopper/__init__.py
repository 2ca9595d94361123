"""A hopper car of finite elements, from a file of its dimensions."""

from .car import hopper_half
from .numbers import Numbers, numbers

__all__ = ["Numbers", "hopper_half", "numbers"]
