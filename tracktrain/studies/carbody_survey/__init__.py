"""A modal survey of the carbody on air springs: shakers, transfer functions, decay."""

from .rig import AirSprings
from .study import carbody_survey, command

__all__ = ["AirSprings", "carbody_survey", "command"]
