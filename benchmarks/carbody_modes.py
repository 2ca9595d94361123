"""What a step of the carbody costs with any number of elastic modes, and what a mode adds.

python benchmarks/carbody_modes.py [ROUNDS]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from fmu_step import rounds_of

from fmus.carbody.modal_data import Body, ModalData, Mode, Point
from fmus.export.carbody import build_carbody

COUNTS = (3, 8, 16, 32, 64)
STEP = 1e-3
"""[s]"""

RESULT = Path(__file__).parent / "results" / "carbody_modes.md"


def carbody(count: int) -> ModalData:
    """Some shapes at the centre plates: a step costs the same whatever they are."""
    rng = np.random.default_rng(count)
    modes = tuple(
        Mode(str(i), float(f), 0.02, "assumed", "a benchmark")
        for i, f in enumerate(np.linspace(3.0, 80.0, count), start=1)
    )
    plates = (Point("front", 5.0, 0.0, -1.4), Point("rear", -5.0, 0.0, -1.4))
    shapes = rng.normal(size=(count, 2, 6)) / 200
    body = Body(90e3, 1e5, 1e6, 1e6, "assumed", "a benchmark")
    return ModalData("benchmark", body, modes, plates, shapes)


def main(repeats: int) -> None:
    rows = []
    for count in COUNTS:
        with tempfile.TemporaryDirectory() as folder:
            two, three = (
                build_carbody(carbody(count), Path(folder) / f"b{fmi[0]}.fmu", fmi)
                for fmi in ("2.0", "3.0")
            )
            rounds = np.concatenate([rounds_of(two, three, STEP)[1] for _ in range(repeats)])
        # Of the columns that host.c prints: FMI 2.0 alone, and with inputs set and outputs read.
        rows.append(rounds[:, [1, 3]].min(axis=0))
        print(f"{count:3} modes: {rows[-1][0]:6.0f} ns, with exchange {rows[-1][1]:6.0f} ns")
    alone, exchanged = np.polyfit(COUNTS, np.array(rows), 1)[0]
    lines = [
        "| elastic modes | doStep [ns] | with inputs set and outputs read [ns] |",
        "|---|---|---|",
    ]
    lines += [f"| {n} | {a:.0f} | {b:.0f} |" for n, (a, b) in zip(COUNTS, rows, strict=True)]
    said = (
        f"A mode adds {alone:.1f} ns to doStep, and {exchanged:.1f} ns with all inputs set and the "
        "plates' motions, velocities and accelerations read in each step (slopes of straight lines "
        "through the smallest times)."
    )
    print(said)
    RESULT.write_text(
        "The carbody of modal data without further points, a step of 1 ms, FMI 2.0.\n\n"
        + "\n".join(lines)
        + f"\n\n{said}\n"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
