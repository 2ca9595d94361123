"""Few modes with a residual flexibility, against all modes of a free beam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.carbody.modal_data import ModalData
from fmus.carbody.modes import modes_of
from fmus.carbody.residual import with_residual_modes
from fmus.errors import ParameterError
from support.modal import beam_data, random_data, twin_of

ALL, KEPT = 40, 2
"""Modes that stand for the whole beam, and those that are kept: 2.4 and 6.6 Hz of 13, 21, ..."""


@pytest.fixture(scope="module")
def beam() -> ModalData:
    return beam_data(ALL, damping=0.02)


@pytest.fixture(scope="module")
def few(beam) -> ModalData:
    return beam.truncated(range(KEPT))


def receptance(data: ModalData, frequency: float) -> complex:
    """Elastic motion of the front plate for a unit of vertical force there, [m/N]."""
    form, s = modes_of(data), 2 * np.pi * frequency
    row, w = form.shapes["front"][1, 5:], form.w[5:]
    return complex(np.sum(row**2 / (w**2 - s**2 + 2j * form.zeta[5:] * w * s)))


@pytest.mark.parametrize(
    ("frequency", "without", "with_it"), [(0.5, 0.03, 1e-4), (5.0, 0.15, 0.01), (8.0, 0.5, 0.1)]
)
def test_a_residual_makes_up_for_the_modes_that_are_left_out(
    beam, few, frequency, without, with_it
):
    """Below the first mode left out (13 Hz); truncated modes alone are too stiff."""
    full = receptance(beam, frequency)
    bare = receptance(replace(few, residual_flexibility=None), frequency)
    corrected = receptance(with_residual_modes(few), frequency)
    assert abs(bare / full - 1) > without
    assert abs(corrected / full - 1) < with_it


def test_residual_modes_give_way_statically_as_the_modes_they_stand_for(beam, few):
    loads = np.random.default_rng(2).normal(size=8)
    found = [
        (loads @ rows.T / (2 * np.pi * data.frequencies) ** 2) @ rows
        for data in (beam, with_residual_modes(few, 300.0))
        for rows in [data.plate_rows()]
    ]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9, atol=1e-9 * np.abs(found[0]).max())


def test_the_block_with_a_residual_follows_the_whole_beam_in_time(beam, few):
    """A load that comes within 0.5 s: the plates' motion, elastic part above all."""

    def motion(data: ModalData) -> np.ndarray:
        twin, found = twin_of(data), []
        for k in range(100):
            load = 1e4 * (1 - np.cos(2 * np.pi * k / 100))
            twin.set("front.force_z", load)
            twin.set("rear.force_z", -load)
            twin.step(0.005)
            found.append([twin.get("front.z") - twin.get("rear.z"), twin.get("cg.pitch")])
        bent, turned = np.array(found).T
        return bent + 10.0 * turned

    whole = motion(beam)
    errors = [
        np.sqrt(np.mean((motion(data) - whole) ** 2) / np.mean(whole**2))
        for data in (replace(few, residual_flexibility=None), with_residual_modes(few))
    ]
    assert errors[1] < 0.1 * errors[0]


def test_a_residual_opens_no_way_from_forces_to_displacements_at_once(few):
    """Its modes have mass: only accelerations answer at once, so that no algebraic loop closes."""
    twin = twin_of(with_residual_modes(few))
    before = [twin.get(f"front.{name}") for name in ("z", "vz", "az")]
    twin.set("front.force_z", 1e5)
    after = [twin.get(f"front.{name}") for name in ("z", "vz", "az")]
    assert after[:2] == before[:2] and after[2] != before[2]


def test_what_is_left_out_twice_is_left_out_once(rng):
    data = random_data(rng, count=6)
    once, twice = data.truncated([0, 1]), data.truncated([0, 1, 2, 3]).truncated([0, 1])
    np.testing.assert_allclose(twice.residual_flexibility, once.residual_flexibility, rtol=1e-12)


def test_data_without_a_residual_stay_as_they_are(rng):
    data = random_data(rng)
    assert with_residual_modes(data) is data


def test_residual_modes_among_the_others_are_refused(few):
    with pytest.raises(ParameterError, match=r"would be among the others, which reach 6\.62"):
        with_residual_modes(few, 5.0)
