"""The truck of joints beside Table 4-5: what it gives, what no joint can, and the loops of both."""

from __future__ import annotations

import numpy as np
import pytest

from tracktrain.studies.truck_joints import truck_joints

pytestmark = pytest.mark.slow  # the FMU of the truck of joints is built first


@pytest.fixture(scope="module")
def outcome():
    return truck_joints()


def test_all_of_table_4_5_but_two_stiffnesses_in_roll_comes_out_of_joints(outcome):
    table = outcome.tables["analog"].reset_index()
    off = table[np.abs(table["joints over table"] - 1) > 1e-9]
    assert list(off["parameter"]) == ["K0 [lb.in/rad]", "Kf [lb.in/rad]"]
    assert set(off["element"]) == {"bolster roll"}
    assert list(off["joints over table"]) == pytest.approx([1.0498, 15.21], rel=1e-3)


def test_one_coil_group_cannot_have_both_friction_stiffnesses(outcome):
    ratio = outcome.tables["one_joint_two_rows"]["second over first"]
    assert ratio["f of a coil group [lb]"] == pytest.approx(1.0)
    assert ratio["Kf of a coil group [lb/in]"] == pytest.approx(1 / 15.21, rel=1e-3)


@pytest.mark.parametrize("shape", ["centre_plate_yaw", "bolster_vertical", "warp"])
def test_where_the_numbers_agree_the_loops_do(outcome, shape):
    loops = {
        truck: [outcome.dataset[f"{shape}.{what}"].sel(truck=truck) for what in ("strain", "force")]
        for truck in ("analog", "joints")
    }
    area = {
        truck: float(np.trapezoid(np.append(f, f[0]), np.append(e, e[0])))
        for truck, (e, f) in loops.items()
    }
    assert area["joints"] == pytest.approx(area["analog"], rel=0.05)  # adapters yield
