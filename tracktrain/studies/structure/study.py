"""The report's way from structure to car: model to modes, modes to survey, survey to FMU."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import cast

import click
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.carbody.default_data import default_data
from fmus.carbody.modal_data import ModalData
from fmus.carbody.modal_files import as_text
from fmus.carbody.residual import with_residual_modes
from fmus.export.carbody import carbody_fmu
from structures.assembled import Structure
from structures.scaling import scaled
from structures.survey import Survey
from structures.survey_files import read_survey

from ...car.hopper import parameters_of
from ...report.modes_page import Drawing, modes_page
from ...terminal import Progress, unseen
from ..carbody_survey import carbody_survey
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from .analysis import (
    Analysis,
    analysed,
    beam_table,
    check_table,
    convergence_table,
    model_table,
    reduction_table,
)
from .cars import DURATION, SPEED, TRACK, compared_cars, shape_table
from .correlated import Correlated, compared, correlated, factor_table, scaled_table
from .pictures import assurance_figure, frequency_figure, model_figure, modes_figure, parts_of
from .printed import names

CARS = ("empty", "loaded")
PARTS = {"analysis": 0.1, "survey": 0.4, "cars": 0.5}
"""Shares of the time that the parts of the study take."""


@taking()
def structure(
    model: Path | None = None,
    survey: Path | None = None,
    loaded_survey: Path | None = None,
    refinement: int = 1,
    convergence: bool = False,
    progress: Progress = unseen,
) -> Outcome:
    """The hopper car's carbody from finite elements to the car that runs with it.

    The report's section 4.1: a half model, mirrored; reduction, lading, rigid-body checks, modes;
    beside the modal survey (Tables 4-2 to 4-4); the empty car scaled to it, the loaded car's
    frequencies replaced. Then a virtual survey on air springs, a carbody FMU of each car, and what
    it changes in hunting and response. `survey` and `loaded_survey` are measured modes (.csv, or a
    Universal file) in place of the report's; `model` is a file of the hopper car's dimensions.
    """
    measured = [read_survey(path) if path else None for path in (survey, loaded_survey)]
    part = _parts(progress)
    found = analysed(model, refinement, part("analysis"))
    empty, loaded, stiff, used = _correlated(found, measured)
    virtual = carbody_survey("empty", carbody=used["empty"], progress=part("survey"))
    both = {car: compared_cars(car, _carbodies(car, used[car]), part("cars")) for car in CARS}
    tables = {
        "model": model_table(found),
        "beam": beam_table(found),
        "rigid_body_checks": check_table(found),
        "reduction": reduction_table(found),
        "table_4_2": compared(empty),
        "scale_factor": factor_table(empty),
        "table_4_3": scaled_table(empty),
        "table_4_4": compared(loaded),
        "coal_that_carries": compared(stiff),
        "virtual_survey": virtual.tables["modes"],
        "shapes": pd.concat({car: shape_table(car, used[car]) for car in CARS}, names=["car"]),
        "cars": pd.concat(both, names=["car"]),
    }
    if convergence:
        tables["convergence"] = convergence_table(model)
    shown = {"empty": empty, "loaded": loaded}
    pictures = {
        "model": model_figure(found.structures["empty"]),
        "modes": modes_figure(found.structures["empty"], empty.data, names()),
        "assurance": assurance_figure(shown),
        "frequencies": frequency_figure(shown),
        "transfer_functions": cast(Figure, virtual.pictures["figure_4_8"]),
    }
    notes = [*_notes(empty, measured), *virtual.notes[:1]]
    title = "Carbody by finite elements, correlated with its survey"
    page = modes_page(
        title, drawing(found.structures["empty"], empty.data),
        [(m.name, f"{m.frequency:.2f} Hz") for m in empty.data.modes], tables, pictures, notes,
    )  # fmt: skip
    return Outcome(
        title,
        _dataset(found),
        tables,
        pictures,
        {"structure.html": page.encode(), **_files(used)},
        notes,
    )


command = study_command(
    "structure",
    click.option(
        "--model",
        type=click.Path(path_type=Path, exists=True, dir_okay=False),
        metavar="FILE",
        help="Dimensions, plates and sections of the hopper car as TOML.  [default: the one that "
        "ships, structures/hopper/hopper.toml]",
    ),
    *(
        click.option(
            option,
            type=click.Path(path_type=Path, exists=True, dir_okay=False),
            metavar="FILE",
            help=f"Measured modes of the {car} car: .csv, or a Universal file (.uff, .unv).  "
            "[default: the report's]",
        )
        for option, car in (("--survey", "empty"), ("--loaded-survey", "loaded"))
    ),
    click.option(
        "--refinement",
        type=click.IntRange(1, 4),
        default=1,
        show_default=True,
        help="Into how many elements each side of a patch is cut.",
    ),
    click.option(
        "--convergence", is_flag=True, help="Refine the mesh, too: order and limit of frequencies."
    ),
    epilog="""\b
Examples:
  tracktrain study structure
  tracktrain study structure --convergence
  tracktrain study structure --model thicker.toml --survey survey.uff --out mine
  tracktrain run --car empty --carbody tracktrain-structure/carbody_empty.toml --step "0.5 ms\"""",
)(structure)


def _parts(progress: Progress) -> Callable[[str], Progress]:
    """Progress of each part of the study, one after the other."""
    begin = dict(zip(PARTS, np.cumsum([0.0, *PARTS.values()]), strict=False))
    done: dict[str, int] = {}

    def part(name: str) -> Progress:
        turn = done[name] = done.get(name, -1) + 1
        each = PARTS[name] / (len(CARS) if name == "cars" else 1)
        return lambda share: progress(begin[name] + each * (turn + share))

    return part


def _correlated(
    found: Analysis, measured: list[Survey | None]
) -> tuple[Correlated, Correlated, Correlated, Mapping[str, ModalData]]:
    """The empty car; the loaded one with the scaled stiffness, and with coal that carries; and the
    data that the cars run with: the empty car's scaled, the loaded one's with test frequencies."""
    empty = correlated("empty", found.data["empty"], measured[0])
    factor = empty.factors.squared_mean  # what Table 4-3 was made with, erratum 10
    loaded, stiff = (
        correlated("loaded", scaled(found.data[name], factor), measured[1])
        for name in ("loaded", "stiff")
    )
    used = {
        "empty": _kept(empty, scaled(empty.data, factor)),
        "loaded": _kept(loaded, loaded.with_test_frequencies()),
    }
    return empty, loaded, stiff, used


def _kept(found: Correlated, data: ModalData) -> ModalData:
    """The modes that the survey has, by their numbers; the others are left to the residual."""
    wanted = {pair.analysis.name for pair in found.alike}
    places = [i for i, mode in enumerate(data.modes) if mode.name in wanted]
    return replace(data.truncated(places), name=f"hopper_{found.car}")


def _carbodies(car: str, data: ModalData) -> dict[str, ModalData | None]:
    """The default carbody, one of its shapes with the body and frequencies of the data, the data:
    from the first to the second is what body and frequencies do, from there what shapes do."""
    body = data.body
    own = {
        "body_mass": body.mass, "roll_inertia": body.roll_inertia,
        "pitch_inertia": body.pitch_inertia, "yaw_inertia": body.yaw_inertia,
        "gravity_centre_height": data.gravity_centre_height,
        **{f"{mode.name.replace(' ', '_')}_frequency": mode.frequency for mode in data.modes},
    }  # fmt: skip
    beam = default_data({**parameters_of(car)["carbody"], **own}, name=f"beam_{car}")
    return {"default": None, "its shapes, model's body": beam, "model": data}


def drawing(of: Structure, data: ModalData) -> Drawing:
    """A structure's faces and beams by part, and the modes that move them."""
    parts = parts_of(of)
    faces = [
        (*nodes, *nodes[-1:] * (4 - len(nodes)), parts.index(part))
        for part, nodes in of.faces
        if len(nodes) > 2
    ]
    lines = [(*nodes, parts.index(part)) for part, nodes in of.faces if len(nodes) == 2]
    return Drawing(
        of.positions,
        data.shapes[:, :, :3],
        parts,
        np.array(faces, int).reshape(-1, 5),
        np.array(lines, int).reshape(-1, 3),
    )


def _files(used: Mapping[str, ModalData]) -> dict[str, bytes]:
    """Modal data and FMU of each car."""
    files = {}
    for car, data in used.items():
        whole = with_residual_modes(data)
        files[f"carbody_{car}.toml"] = as_text(data).encode()
        files[f"carbody_{car}.fmu"] = carbody_fmu(whole).read_bytes()
    return files


def _dataset(found: Analysis) -> xr.Dataset:
    """Frequencies of all modes that were computed, and where the nodes are."""
    data = {
        f"{name}.frequency": (f"{name}.mode", each.frequencies, {"units": "Hz"})
        for name, each in found.modes.items()
    }
    nodes = ("node", "axis"), found.structures["empty"].positions, {"units": "m"}
    return xr.Dataset({**data, "position": nodes})


def _notes(empty: Correlated, measured: list[Survey | None]) -> list[str]:
    factors = empty.factors
    notes = [
        f"the stiffness is scaled by {factors.squared_mean:.4f}, the square of the mean ratio of "
        "test to analysis, as Table 4-3 was; the formula that the report prints gives "
        f"{factors.mean_square:.4f} (erratum 10)",
        "the loaded car has the scaled stiffness and a lading without any, then the test's "
        "frequencies with the shapes kept, as the report did; coal_that_carries has a lading of an "
        "assumed modulus instead",
        f"cars: critical speed with friction stuck; response at {SPEED:.4g} m/s over "
        f"{DURATION:g} s of {TRACK}; its shapes, model's body: the default's beam and torsion "
        "factor with mass, inertia and frequencies of the model",
        "reduction: the full model's frequencies are the lowest that the elements allow; a reduced "
        "one is never below",
    ]
    if None in measured:
        notes.append(
            "the report prints no shapes of its survey: a twisted and two bent beams stand for "
            "them, which know nothing of the walls' own swaying"
        )
    return notes
