"""Names as people type them."""

from __future__ import annotations

import pytest

from orchestrator import ResultsError, picked
from orchestrator.naming import meant

NAMES = ["truck.axle[1].y", "truck.axle[2].y", "truck.q[1]", "truck.qd[1]", "Left.force_y", "y"]


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("truck.q[1]", ["truck.q[1]"]),
        ("y", ["y"]),
        ("truck.axle[*].y", ["truck.axle[1].y", "truck.axle[2].y"]),
        ("truck.q?[1]", ["truck.qd[1]"]),
        ("Truck axle 2 y", ["truck.axle[2].y"]),
        ("truck.axle1.y", ["truck.axle[1].y"]),
        ("left force y", ["Left.force_y"]),
        ("force_y", ["Left.force_y"]),
        ("axle[2].y", ["truck.axle[2].y"]),
        ("rce_y", []),
        ("x.*", []),
        ("[]", []),
    ],
)
def test_a_name_is_found_by_its_words_however_they_are_spelled(asked, found):
    assert picked(asked, NAMES) == found


def test_one_name_that_means_several_is_answered_with_these():
    with pytest.raises(ResultsError, match=r"means several; .*axle\[1\].y, truck.axle\[2\].y"):
        meant("truck.axle[*].y", NAMES, "there is no output")
    with pytest.raises(ResultsError, match=r"there is no output 'truk.q\[1\]'; did you mean truck"):
        meant("truk.q[1]", NAMES, "there is no output")
