"""A truck with one of its wheelsets on irregular track, and runs that are interrupted."""

from __future__ import annotations

from fmus.catalogue import fmu_path
from orchestrator import Component, Connection, System

SECONDS = 4.0
STEP = 1e-3
ENDS = ("y", "yaw", "vy", "wz")


def wheelset_on_truck() -> System:
    """A truck with one of its wheelsets on irregular track: states, tangents and a table."""
    components = {
        "track": Component(fmu_path("track")),
        "wheelset": Component(fmu_path("wheelrail")),
        "truck": Component(fmu_path("truck"), {"initial.yaw": 1e-3}),
    }
    pairs = [
        *((f"truck.axle[1].{end}", f"wheelset.{end}") for end in ENDS),
        *((f"wheelset.{force}", f"truck.axle[1].{force}") for force in ("force_y", "moment_z")),
        *((f"truck.axle[1].load_{s}", f"wheelset.load_{s}") for s in ("left", "right")),
        *((f"track.axle[1].rail_y_{s}", f"wheelset.rail_y_{s}") for s in ("left", "right")),
        ("track.speed_out", "wheelset.speed"),
    ]
    system = System(components, tuple(Connection(*pair) for pair in pairs))
    return system.with_value("track.speed", 20.0).with_value("track.spectrum", "fra4")


def interrupted_at(seconds: float):
    """Progress of a run that its user interrupts at a time [s]."""

    def progress(t, wall):
        if t > seconds:
            raise KeyboardInterrupt

    return progress
