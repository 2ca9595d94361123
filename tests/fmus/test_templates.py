"""What `tracktrain new` writes computes what the blocks compute, where it claims to."""

from __future__ import annotations

from math import pi, sin

import numpy as np
import pytest

import tolerances
from fmus import BLOCKS
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin
from support.templates import STARTS, template

STEP = 1e-3
SIZE = {"m": 2e-3, "rad": 1e-3, "m/s": 0.1, "rad/s": 0.02, "N": 2e4, "N.m": 1e4}
SIZE |= {"1/m": 1e-3, "m/s2": 0.5, "rad/s2": 0.02}


class Pair:
    """A template's model and the block's twin, with the same parameters and random inputs."""

    def __init__(self, block: str, **changes: float) -> None:
        self.block, self.model = BLOCKS[block](), template(block)
        values = parameter_set("loaded").values(self.block) | changes
        self.twin = Twin(self.block, values)
        self.p = {v.name: values.get(v.name, v.default) for v in self.model.parameters}
        self.u = self.model.start_values()[1]
        self.rng = np.random.default_rng(4)
        self.twin.initialize()
        self.model.start(self.p, self.u)

    def stir(self) -> None:
        """Other inputs, both the same."""
        for port in self.model.inputs:
            self.u[port.name] = port.start + SIZE[port.unit] * self.rng.uniform(-1, 1)
            self.twin.set(port.name, self.u[port.name])

    def step(self, k: int) -> None:
        self.model.step(self.p, self.u, k * STEP, STEP)
        self.twin.step(STEP)

    def worst(self, names: list[str], runs: int, stepping: bool = True) -> float:
        """Largest difference over `runs` inputs, in the largest value of that port."""
        rows = []
        for k in range(runs):
            self.stir()
            if stepping:
                self.step(k)
            ours = self.model.output(self.p, self.u)
            rows.append([(ours[name], self.twin.get(name)) for name in names])
        ours, theirs = np.moveaxis(np.array(rows), 2, 0)
        scale = np.abs(theirs).max(0)
        assert (scale > 0.0).all()
        return float((np.abs(ours - theirs) / scale).max())


def common(pair: Pair) -> list[str]:
    names = {v.name for v in pair.block.outputs}
    return [v.name for v in pair.model.outputs if v.name in names]


@pytest.mark.parametrize("name", STARTS)
def test_a_template_has_the_ports_of_its_block(name):
    """All inputs that have to be connected, and no output or unit that the block does not have."""
    block, model = BLOCKS[name](), template(name)
    known = {v.name: (v.unit, v.start, v.optional) for v in block.inputs}
    inputs = {v.name: (v.unit, v.start, v.optional) for v in model.inputs}
    assert {name for name, v in known.items() if not v[2]} <= set(inputs)
    assert inputs.items() <= known.items()


@pytest.mark.parametrize(("name", "ports"), [("wheelrail", "path_"), ("carbody", "frame.")])
def test_a_template_runs_on_a_line_with_curves(name, ports):
    needed, own = (
        {v.name for v in held.inputs if v.name.startswith(ports)}
        for held in (BLOCKS[name](), template(name))
    )
    assert needed and own == needed


@pytest.mark.parametrize("name", STARTS)
def test_a_template_gives_what_its_block_gives(name):
    block, model = BLOCKS[name](), template(name)
    outputs = {v.name: (v.unit, v.derivative_of) for v in block.outputs}
    assert {v.name: (v.unit, v.derivative_of) for v in model.outputs}.items() <= outputs.items()


def test_the_wheelset_is_the_block_with_linear_creep_and_no_flange():
    pair = Pair("wheelrail", creep_law=1.0, flange_stiffness=0.0)
    assert len(common(pair)) == len(pair.model.outputs)
    assert pair.worst(common(pair), 50, stepping=False) < tolerances.ROUNDING


def test_the_carbody_moves_as_the_rigid_modes_of_the_block():
    pair = Pair("carbody")
    rigid = [n for n in common(pair) if n.startswith(("cg.", "q"))]
    assert len(rigid) == 7 + 10
    assert pair.worst(rigid, 50) < tolerances.ROUNDING


def test_the_truck_is_the_block_with_the_same_micro_step():
    # nothing lifts or rocks: the template has no contacts that open
    pair = Pair("truck", micro_step=1e-4, centre_plate_contact=2.0, axle_load=1e7)
    assert len(common(pair)) == len(pair.model.outputs)
    moving = [n for n in common(pair) if n != "spring[2]"]  # a spring of no stiffness
    assert pair.worst(moving, 50) < tolerances.SAME_SCHEME


def test_the_track_passes_at_the_same_speed():
    pair = Pair("track")
    assert pair.worst(["distance", "speed_out"], 20) < tolerances.ROUNDING


def test_the_track_is_a_sinusoid_under_each_axle():
    model = template("track")
    p, u = model.start_values()
    model.start(p, u)
    model.step(p, {"speed": 60.0}, 0.0, 1.0)
    y = model.output(p, u)
    truck, axle = 2 * p["half_truck_spacing"], 2 * p["half_wheelbase"]
    for k, behind in enumerate((0.0, axle, truck, truck + axle), start=1):
        expected = p["amplitude"] * sin(2 * pi * (60.0 - behind) / p["wavelength"])
        assert y[f"axle[{k}].rail_y_left"] == pytest.approx(expected)
        assert y[f"axle[{k}].rail_y_right"] == pytest.approx(expected)
