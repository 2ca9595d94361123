"""Tables on a terminal: texts are folded where it is narrow, and no digit is cut."""

from __future__ import annotations

import io

import pandas as pd
import pytest
from rich.console import Console

from tracktrain.terminal import print_whole, printable

NAME = "truck_front.bolster_lateral.stiffness"
NUMBERS = (5.363e-05, -1.234e-06, 5.5e05, 3.333e-09)


@pytest.mark.parametrize("width", [20, 40, 60, 80, 200])
def test_no_digit_and_no_letter_is_cut(width: int) -> None:
    columns = {f"growth of the quantity {n} [1/s]": [number] for n, number in enumerate(NUMBERS)}
    table = pd.DataFrame(
        {"parameter [lbf/in]": [NAME], "said": ["some words of a note"], **columns}
    )
    stream = io.StringIO()
    print_whole(Console(file=stream, width=width), printable(table, "title"))
    said = stream.getvalue()
    for number in NUMBERS:
        assert f"{number:.4g}" in said
    assert "\u2026" not in said
    folded = [line.split(" ")[1] if line.startswith(" ") else "" for line in said.splitlines()]
    assert NAME in "".join(folded) or NAME in said
