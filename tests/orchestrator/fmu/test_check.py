"""What is wrong in a model description is said in one line: what, and where."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator import FmuError, describe
from support.native_slaves import DAMPER, archive, description
from support.typed_slaves import fmi3_description

TWO, THREE = description(DAMPER), fmi3_description()


def refusal(folder: Path, text: str) -> str:
    path = archive(folder / "a.fmu", text, None)
    with pytest.raises(FmuError) as caught:
        describe(path)
    said = str(caught.value)
    assert said.startswith(f"'{path}' ")
    return said.removeprefix(f"'{path}' ").removeprefix("has a wrong modelDescription.xml: ")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'dependencies="1"',
            'dependencies="9"',
            "a dependency of <Unknown index=\"2\"> is '9', which is no variable; 1 to 5 are",
        ),
        (
            'index="2"',
            'index="0"',
            "the index of an <Unknown> is '0', which is no variable; 1 to 5 are",
        ),
        ('name="force"', 'name="v"', "two variables are called 'v'"),
        (
            'valueReference="1"',
            'valueReference="4294967296"',
            "the variable 'force' has valueReference=\"4294967296\", which is no whole number from "
            "0 to 4294967295",
        ),
        (
            'valueReference="1"',
            'valueReference="one"',
            "the variable 'force' has valueReference=\"one\", which is no whole number from 0 to "
            "4294967295",
        ),
        (
            '<Real unit="m/s" start="0"/>',
            '<Real unit="m/s" start="little"/>',
            "the variable 'v' has start=\"little\", which is no number",
        ),
        (
            '<Real unit="N"/>',
            '<Real unit="N" max="much"/>',
            "the variable 'force' has max=\"much\", which is no number",
        ),
        ('factor="80000"', 'factor="heavy"', '<BaseUnit> has factor="heavy", which is no number'),
        ('<Real unit="N"/>', "", "the variable 'force' has no type"),
        (
            '<Boolean start="false"/>',
            '<Boolean start="no"/>',
            "the variable 'locked' has start=\"no\", which is no truth value",
        ),
        ('<Real unit="N"/>', '<Real derivative="7"/>', "the derivative of the variable 'force'"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, said):
    assert old in TWO
    assert refusal(tmp_path, TWO.replace(old, new, 1)).startswith(said)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            '<Output valueReference="2"',
            '<Output valueReference="99"',
            "the valueReference of an <Output> is '99', which is no variable; the variables' value "
            "references are",
        ),
        ('<Alias name="place"/>', '<Alias name="rate"/>', "two variables are called 'rate'"),
        (
            '<Dimension valueReference="45"/>',
            '<Dimension valueReference="1000"/>',
            "the size of the variable 'x' is '1000', which is no variable",
        ),
        (
            '<Dimension start="3"/>',
            '<Dimension start="three"/>',
            "a dimension of the variable 'v' has start=\"three\", which is no size",
        ),
        ('start="0.25 0.5 0.75"', 'start="0.25 a"', "the variable 'v' has start=\"a\", which is"),
    ],
)
def test_what_is_wrong_in_version_3_is_named(tmp_path, old, new, said):
    assert old in THREE
    assert refusal(tmp_path, THREE.replace(old, new, 1)).startswith(said)


def test_names_without_end_and_escape_sequences_are_not_echoed(tmp_path):
    long = TWO.replace('name="force"', f'name="{"n" * 1_000_000}"', 1)
    assert refusal(tmp_path, long) == (
        f"has a modelDescription.xml with a name of 1000000 characters, '{'n' * 40}...'; at most "
        "4096 are read"
    )
    coloured = TWO.replace('dependencies="1"', 'dependencies="\x9b31m"', 1)
    assert "is '\\x9b31m', which is no variable" in refusal(tmp_path, coloured)
