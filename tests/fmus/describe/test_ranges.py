"""What blocks state that their laws hold for, from file to FMU."""

from __future__ import annotations

import pytest

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.ranges import range_of, read_range
from fmus.errors import ParameterError
from fmus.export.xml.description import annotated
from fmus.model import Limit, Model, Output
from fmus.truck.ports import OUTPUTS
from fmus.truck_joints.block import TruckJoints
from orchestrator import Port, PortMap, describe


@pytest.mark.parametrize("name", BLOCKS)
def test_every_block_says_what_its_laws_hold_for_and_why(name):
    limits = range_of(BLOCKS[name]())
    assert limits is not None
    for limit in limits:
        assert limit.source and limit.remedy and limit.beyond
        assert limit.least is not None or limit.largest is not None


@pytest.mark.parametrize(
    ("name", "fmi"), [("truck", "2.0"), ("truck", "3.0"), ("carbody", "2.0"), ("wheelrail", "3.0")]
)
def test_an_importer_reads_the_limits_of_the_file_in_the_fmu(name, fmi):
    read, stated = describe(fmu_path(name, fmi)).limits, range_of(BLOCKS[name]())
    assert [limit.outputs for limit in read] == [limit.outputs for limit in stated]
    for ours, theirs in zip(stated, read, strict=True):
        assert theirs.largest == (float("inf") if ours.largest is None else ours.largest)
        assert theirs.least == (float("-inf") if ours.least is None else ours.least)
        assert (theirs.void, theirs.remedy) == (ours.void, ours.remedy)


class Spring(Model):
    """A spring that was measured up to 5 kN."""

    name = "spring"
    description = "A spring"
    outputs = (Output("force_y", "N", "Force"),)
    limits = (Limit("force", ("force_y",), "N", largest=5e3, beyond="forces never measured"),)


def test_a_model_of_ones_own_states_its_limits():
    (element,) = annotated(Spring())
    (limit,) = element
    assert (limit.get("outputs"), limit.get("max"), limit.get("min")) == ("force_y", "5000.0", None)
    Spring.limits = None
    assert annotated(Spring()) == []


def test_a_block_that_stands_for_another_holds_for_the_same():
    assert range_of(TruckJoints()) == range_of(BLOCKS["truck"]())


def test_a_port_map_takes_the_limits_along_in_its_own_names_and_units():
    ports = {"steering": Port("axle[1].yaw", factor=-2.0, offset=1.0)}
    seen = PortMap(ports).applied(describe(fmu_path("truck")))
    own = next(limit for limit in range_of(BLOCKS["truck"]()) if limit.name == "yaw")
    (steering,) = [limit for limit in seen.limits if "steering" in limit.outputs]
    assert (steering.least, steering.largest) == pytest.approx(
        (1.0 - 2.0 * own.largest, 1.0 + 2.0 * own.largest)
    )
    assert not any("axle[1].yaw" in limit.outputs for limit in seen.limits)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("lift_left", "lift_up"), "lift_up, which is no output of the block; it has axle"),
        (("unit = 'm'", "unit = 's'"), "give it in a unit of m"),
        (("basis = 'derived'", "basis = 'hearsay'"), "the basis 'hearsay' is not known"),
        (("source = 'statics'", ""), "lacks source"),
    ],
)
def test_a_limit_that_cannot_be_is_refused_by_name(tmp_path, change, said):
    text = (
        "[lift]\noutputs = ['lift_left']\nlargest = { value = 0, unit = 'm' }\n"
        "basis = 'derived'\nsource = 'statics'\nbeyond = 'lifted'\nremedy = 'none'\n"
    )
    path = tmp_path / "range.toml"
    path.write_text(text.replace(*change))
    with pytest.raises(ParameterError, match=said):
        read_range(path, OUTPUTS)
