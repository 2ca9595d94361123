"""Reference results of the truck of joints: the same equations in much shorter micro steps."""

from __future__ import annotations

from ..truck.experiment import in_finer_steps
from .block import TruckJoints

EXPERIMENT = in_finer_steps(TruckJoints)
