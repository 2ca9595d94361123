"""The FMUs in CasADi's importer, which sets states and inputs by their references."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from fmpy import extract

import tolerances
from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.parameters import DEFAULT_SET, parameter_set
from fmus.describe.twin import Twin


@pytest.mark.parametrize("block", ["carbody", "truck", "track"])
def test_casadi_evaluates_the_derivatives_and_their_jacobian(block, tmp_path):
    folder = extract(str(fmu_path(block)), str(tmp_path / block))
    model = ca.DaeBuilder(block, str(Path(folder)))
    function = model.create("f", ["x", "u"], ["ode"])
    twin = Twin(BLOCKS[block](), parameter_set(DEFAULT_SET).values(BLOCKS[block]()))
    twin.initialize()
    rng = np.random.default_rng(1980)
    x, u = (1e-3 * rng.uniform(-1, 1, n) for n in (model.nx(), model.nu()))
    twin.x[: len(x)], twin.u[:] = x, u
    expected = twin.derivatives()
    found = np.array(function(x, u)).ravel()
    assert np.allclose(found, expected, rtol=tolerances.PARITY, atol=1e-12)
    by_state, _ = function.jacobian()(x, u, found)
    seed = dict(zip(model.x(), rng.uniform(-1, 1, len(x)), strict=True))
    along = twin.directional(seed)[-len(x) :]
    product = np.array(by_state) @ np.array(list(seed.values()))
    assert np.allclose(product, along, rtol=1e-9, atol=1e-9 * np.abs(along).max())
