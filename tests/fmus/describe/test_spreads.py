"""How far the numbers may be off: every estimate says so, and distributions are what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmus import BLOCKS, ParameterError
from fmus.describe.parameters import PARAMETER_SETS, load, parameter_set
from fmus.describe.spread import Spread

ENTRIES = [
    pytest.param(entry, id=f"{name}-{table}-{parameter}")
    for name in PARAMETER_SETS
    for table, group in parameter_set(name).entries.items()
    for parameter, entry in group.items()
]


def has_range(entry):
    return entry.low is not None or entry.deviation is not None or bool(entry.follows)


def test_every_number_says_how_far_it_may_be_off_or_why_not():
    for entry in (p.values[0] for p in ENTRIES):
        assert has_range(entry) != entry.spread.startswith("none: "), entry
        assert len(entry.spread) > 5, entry


def test_every_estimate_that_is_there_at_all_has_a_range():
    for entry in (p.values[0] for p in ENTRIES):
        absent = entry.value == 0.0 or math.isinf(entry.value)
        if entry.basis != "assumed" and not absent and entry.spread != "none: an option":
            assert has_range(entry) or entry.basis == "derived" or "definition" in entry.spread


@pytest.mark.parametrize("name", PARAMETER_SETS)
@pytest.mark.parametrize("block", BLOCKS)
def test_ranges_hold_the_value_and_stay_inside_what_the_block_takes(name, block):
    built = BLOCKS[block]()
    numbers, blocks = parameter_set(name), filter(None, (block, built.stands_for))
    values, tables = numbers.values(built), tuple(blocks)
    for p in built.parameters:
        entry = numbers.entry(p.name, *tables)
        spread = entry and entry.spread_in(p.unit)
        if spread:
            low, high = spread.quantile([0.0, 1.0])
            assert spread.value == pytest.approx(values[p.name], rel=1e-12)
            assert low <= spread.value <= high and spread.standard_deviation > 0.0, p.name
            assert p.minimum is None or low >= p.minimum, p.name
            assert p.maximum is None or high <= p.maximum, p.name


def test_the_quantiles_of_a_range_have_the_triangular_distributions_moments():
    spread = Spread(2.0, 1.0, 5.0, None, "made up")
    sample = spread.quantile((np.arange(20_000) + 0.5) / 20_000)
    assert sample.mean() == pytest.approx(spread.mean, rel=1e-6)
    assert sample.std() == pytest.approx(spread.standard_deviation, rel=1e-3)
    assert spread.quantile(0.25) == 2.0  # (value - low) / (high - low)


def test_the_quantiles_of_a_deviation_are_normal():
    spread = Spread(3.0, None, None, 0.5, "made up")
    assert spread.quantile([0.5, 0.95]) == pytest.approx([3.0, 3.0 + 0.5 * 1.6448536], rel=1e-7)


BROKEN = {
    "low = 1, spread = 'x'": "give low and high, or deviation, or follows",
    "low = 1, high = 3, deviation = 0.1, spread = 'x'": "has low, high, deviation, spread; give",
    "low = 2.5, high = 3, spread = 'x'": "the value 2 is not from low = 2.5 to high = 3",
    "low = 1, high = 3": "has low, high without a reason; add it as spread",
    "deviation = 0.9, spread = 'x'": "a deviation of 0.9 is not above 0 and up to a quarter",
    "deviation = 'wide', spread = 'x'": "deviation is 'wide'; give a number",
    "follows = 'ghost', spread = 'x'": "mu follows 'ghost', which no table has",
}


@pytest.mark.parametrize("fields", BROKEN)
def test_a_contradictory_range_is_refused(tmp_path, fields):
    entry = (
        'value = 2, unit = "1", symbol = "c", basis = "estimate", source = "a", description = "b"'
    )
    (tmp_path / "car.toml").write_text(f"[wheelrail]\nmu = {{ {entry}, {fields} }}\n")
    with pytest.raises(ParameterError, match=BROKEN[fields].replace("(", r"\(")):
        load(tmp_path / "car.toml")


def test_a_set_that_changes_a_value_does_not_keep_the_range_of_the_old_one(tmp_path):
    (tmp_path / "car.toml").write_text(
        'extends = "loaded"\n[wheelrail]\n'
        'conicity = { value = 0.3, unit = "1", basis = "measured", source = "a lathe" }\n'
    )
    conicity = load(tmp_path / "car.toml").entry("conicity")
    assert conicity.low is None and conicity.spread == ""
