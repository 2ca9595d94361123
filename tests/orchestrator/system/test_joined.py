"""Systems nested under a name, and joined into one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from orchestrator import Component, Connection, CouplingError, PowerBond, System

PAIR = System(
    {"a": Component(Path("a.fmu"), {"mass": 2.0}), "b": Component(Path("b.fmu"))},
    (Connection("a.force", "b.force"), Connection("b.v", "a.v")),
    (PowerBond("a.force", "b.v"),),
)


def test_every_name_of_a_nested_system_has_the_prefix():
    nested = PAIR.prefixed("car")
    assert nested.components == {"car:a": PAIR.components["a"], "car:b": PAIR.components["b"]}
    assert nested.connections == (
        Connection("car:a.force", "car:b.force"),
        Connection("car:b.v", "car:a.v"),
    )
    assert nested.bonds == (PowerBond("car:a.force", "car:b.v"),)


def test_joined_systems_keep_what_they_have_and_get_connections_between_them():
    coupler = Connection("front:b.v", "rear:a.v_other")
    train = PAIR.prefixed("front").joined(PAIR.prefixed("rear"), [coupler])
    assert [*train.components] == ["front:a", "front:b", "rear:a", "rear:b"]
    assert len(train.connections) == 5 and train.connections[-1] == coupler
    assert train.bonds is not None and len(train.bonds) == 2


def test_bonds_are_found_by_unit_where_one_of_two_does_not_say_them():
    assert PAIR.joined(replace(PAIR.prefixed("rear"), bonds=None)).bonds is None


def test_two_systems_with_an_instance_of_the_same_name_are_not_joined():
    with pytest.raises(CouplingError, match="both systems have an instance 'a'"):
        PAIR.joined(PAIR)
