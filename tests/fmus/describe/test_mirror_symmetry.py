"""Every block in a mirror: left and right change places, and so does all that it does."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus import BLOCKS

FLIPPED = ("y", "roll", "yaw", "vy", "wx", "wz", "force_y", "moment_x", "moment_z", "ay", "creep_y")
FLIPPED += ("wx_dot", "wz_dot", "y_rel", "yaw_rel", "rail_y_left", "rail_y_right")
FLIPPED += ("path_yaw", "path_curvature")
SIZE = {"m": 5e-3, "rad": 2e-3, "m/s": 0.1, "rad/s": 0.05, "N": 2e4, "N.m": 1e4, "m/s2": 1.0}
SIZE |= {"1/m": 1e-3, "rad/s2": 0.05}
LATERAL_STATES = {
    "carbody": {1, 3, 4, 6, 7},  # the modes that flip: all but vertical, pitch, vertical bending
    "truck": {1, 2, 3, 4, 5},
}
LATERAL_ELEMENTS = {1, 2, 3, 5, 6}


def mirrored_name(name):
    swap = {"left": "right", "right": "left"}
    return ".".join(
        "_".join(swap.get(word, word) for word in part.split("_")) for part in name.split(".")
    )


def sign(block, name):
    for prefixes, lateral in (
        (("q[", "qd["), LATERAL_STATES.get(block, ())),
        (("spring[", "friction["), LATERAL_ELEMENTS),
    ):
        if name.startswith(prefixes):
            return -1 if int(name[name.index("[") + 1 : -1]) in lateral else 1
    return -1 if name.split(".")[-1] in FLIPPED else 1


@pytest.mark.parametrize("block", ["carbody", "truck", "wheelrail"])
def test_the_mirrored_block_does_the_mirrored_thing(twin_of, rng, block):
    ports = BLOCKS[block].inputs
    one, other = twin_of(block), twin_of(block)
    for _ in range(30):
        for port in ports:
            if "_per_" in port.name:
                continue
            value = SIZE[port.unit] * rng.normal() + (20.0 if port.name == "speed" else 0.0)
            value = abs(value) if port.name.startswith("load_") else value
            one.set(port.name, value)
            other.set(mirrored_name(port.name), sign(block, port.name) * value)
        one.step(1e-3)
        other.step(1e-3)
    out = {v.name: one.get(v.name) for v in BLOCKS[block].outputs}
    scale = np.median([abs(value) for value in out.values() if value]) * 1e-6
    assert scale > 0
    for name, value in out.items():
        mirrored = other.get(mirrored_name(name))
        assert sign(block, name) * mirrored == pytest.approx(
            value, rel=tolerances.MIRROR, abs=tolerances.MIRROR * scale
        ), name
