"""The hopper car from its dimensions to modes, empty and loaded, as the report does."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.linalg import eigh

from fmus.carbody.modal_data import ModalData
from structures.assembled import Structure
from structures.beam_estimate import bending_frequency, second_moment
from structures.elements import assembled, parts_of
from structures.free_modes import FreeModes, free_modes
from structures.half import mirrored
from structures.hopper import Numbers, hopper_half, numbers
from structures.hopper.coal import lumps, springs
from structures.lading import laden
from structures.modal import modal_data
from structures.model import Model
from structures.reduction import Reduced, again, by_modes, mass_on, proposed, reduced
from structures.rigid import check_free, grounding, mass_properties, properties_of_parts

from ...car.hopper import parameters_of
from ...terminal import Progress, unseen
from .printed import names, printed

MODES = 24
"""Modes that are kept of the full model; those beyond are in the residual flexibility."""

FIRST, RETAINED = 270, 98
"""Degrees of freedom after the first and the second stage of the reduction, as the report has."""

REFINEMENTS = (1, 2, 4)
"""Meshes by which convergence is judged, each twice as fine as the one before."""

CROWDED = 60
"""Modes among which those of a fine mesh are found: its plates have many of their own."""

SHOWN = 30.0
"""Highest frequency [Hz] at which the reduction is judged."""


@dataclass(frozen=True, eq=False)
class Analysis:
    """What the model gives. structures, data: by `empty`, `loaded`, and `stiff`, the loaded car
    with a lading that carries. first, small: the empty car reduced in one and in two stages."""

    of: Numbers
    half: Model
    structures: Mapping[str, Structure]
    modes: Mapping[str, FreeModes]
    data: Mapping[str, ModalData]
    first: Reduced
    small: Reduced


def analysed(
    model: Path | None = None, refinement: int = 1, progress: Progress = unseen
) -> Analysis:
    """Model, half and mirror, lading, modes, reduction. Raises StructureError.

    model: a file of the hopper car's dimensions.
    """
    of = numbers(model)
    half = hopper_half(of, refinement)
    empty = mirrored(assembled(half))
    check_free(empty)
    coal = lumps(of, empty)
    structures = {
        "empty": empty,
        "loaded": laden(empty, coal, name=f"{of.name}, loaded"),
        "stiff": laden(
            empty, coal, springs(of, coal), name=f"{of.name}, loaded, coal that carries"
        ),
    }
    modes, data = {}, {}
    for number, (name, structure) in enumerate(structures.items(), start=1):
        modes[name] = free_modes(structure, MODES)
        said = [
            f"finite elements: {structure.name}, {structure.degrees} degrees of freedom, from "
            f"{model.name if model else 'the hopper car that ships'}"
        ]
        data[name] = modal_data(structure, modes[name], "finite elements", provenance=said)
        progress(number / 4)
    all_modes = free_modes(empty, RETAINED - 6)
    first = reduced(empty, proposed(empty, FIRST))
    small = again(first, by_modes(empty, all_modes, RETAINED, first.retained))
    progress(1.0)
    return Analysis(of, half, structures, modes, data, first, small)


def model_table(found: Analysis) -> pd.DataFrame:
    """Size of the model beside the report's."""
    kinds = Counter(element.kind for element in found.half.elements)
    rows = [
        ("joints of the half", "252", len(found.half.numbers)),
        ("elements of the half", "355", len(found.half.elements)),
        ("of them quadrilateral plates", "-", kinds["quad"]),
        ("of them beams, uniform and tapered", "-", kinds["beam"]),
        ("degrees of freedom of the whole", "about 3000", found.structures["empty"].degrees),
        ("after the first reduction", "270", found.first.degrees),
        ("after the second", "98", found.small.degrees),
    ]
    return pd.DataFrame(rows, columns=["what", "report", "ours"]).set_index("what")


def check_table(found: Analysis) -> pd.DataFrame:
    """Mass properties by (4-17) beside a sum over the parts and the car's parameters, and what
    rigid motions meet (4-19)."""
    weight, centre = properties_of_parts(parts_of(found.half))
    lading = sum(lump.mass for lump in lumps(found.of, found.structures["empty"]))
    columns: dict[str, list[float]] = {}
    for name in ("empty", "loaded"):
        structure, values = found.structures[name], parameters_of(name)["carbody"]
        own = mass_properties(structure)
        columns[f"{name}, model"] = [
            own.mass / 1e3, own.centre[2], *np.diag(own.inertia) / 1e3, grounding(structure).worst,
        ]  # fmt: skip
        height = centre[2] if name == "empty" else np.nan
        mass = 2 * weight + (lading if name == "loaded" else 0.0)
        columns[f"{name}, sum of parts"] = [mass / 1e3, height, *[np.nan] * 4]
        columns[f"{name}, parameters"] = [
            values["body_mass"] / 1e3, values["gravity_centre_height"],
            *(values[f"{axis}_inertia"] / 1e3 for axis in ("roll", "pitch", "yaw")), np.nan,
        ]  # fmt: skip
    rows = [
        "mass [t]", "centre above the plates [m]", "roll inertia [t.m2]", "pitch inertia [t.m2]",
        "yaw inertia [t.m2]", "force of a rigid motion over stiffness",
    ]  # fmt: skip
    return pd.DataFrame(columns, index=pd.Index(rows, name="what"))


def reduction_table(found: Analysis) -> pd.DataFrame:
    """Frequencies of the reduced model over those of the full one, mode by mode: with the
    consistent mass (4-9), and with mass formed on the coarse set, the report's cheaper way."""
    cheaper = again(
        found.first, found.small.retained, mass_on(found.structures["empty"], found.first.retained)
    )
    columns = [
        np.sqrt(eigh(small.stiffness, small.mass, eigvals_only=True)[6:]) / (2 * np.pi)
        for small in (found.small, cheaper)
    ]
    rows = [
        {
            "mode": mode.name,
            "full [Hz]": mode.frequency,
            "reduced [Hz]": consistent,
            "off [%]": 100 * (consistent / mode.frequency - 1),
            "mass formed directly [Hz]": formed,
            "mass formed: off [%]": 100 * (formed / mode.frequency - 1),
        }
        for mode, consistent, formed in zip(found.data["empty"].modes, *columns, strict=False)
        if mode.frequency < SHOWN or not mode.name.startswith("mode")
    ]
    return pd.DataFrame(rows).set_index("mode")


def beam_table(found: Analysis) -> pd.DataFrame:
    """First vertical bending of the car as a uniform beam (4-1), beside model and test."""
    half, empty = found.half, found.data["empty"]
    at = (found.of.floor[0][1:] + found.of.floor[0][:-1]) / 2
    inertia = float(np.mean([second_moment(half, x) for x in at]))
    length = 2 * found.of.dimensions["end_x"]
    young, mass = found.of.material.young, empty.body.mass / length
    own = next((m.frequency for m in empty.modes if m.name == names()[2]), np.nan)
    rows = [
        ("uniform beam (4-1)", 71.0, bending_frequency(young, inertia, mass, length)),
        ("finite elements", printed("analysis", "empty").values[2], own),
        ("test", printed("test", "empty").values[2], np.nan),
    ]
    return pd.DataFrame(rows, columns=["by", "report [Hz]", "ours [Hz]"]).set_index("by")


def convergence_table(model: Path | None) -> pd.DataFrame:
    """Frequencies of the empty car as its mesh is refined, with order and limit.

    From f = limit + c h^order at element sizes h, h/2, h/4 (Richardson).
    """
    of, columns = numbers(model), {}
    for refinement in REFINEMENTS:
        car = mirrored(assembled(hopper_half(of, refinement)))
        data = modal_data(car, free_modes(car, CROWDED), "")
        columns[refinement] = {m.name: m.frequency for m in data.modes}
    rows = []
    for name in names():
        coarse, middle, fine = (columns[r].get(name, np.nan) for r in REFINEMENTS)
        ratio = (coarse - middle) / (middle - fine)
        rows.append(
            {
                "mode": name,
                **{f"{r} x as fine [Hz]": columns[r].get(name, np.nan) for r in REFINEMENTS},
                "order": np.log2(ratio) if ratio > 1 else np.nan,
                "limit [Hz]": fine - (middle - fine) / (ratio - 1) if ratio > 1 else np.nan,
            }
        )
    return pd.DataFrame(rows).set_index("mode")
