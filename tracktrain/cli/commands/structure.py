"""The command `tracktrain structure`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from orchestrator import whole_file

from ...errors import TracktrainError
from ...options.fields import adding
from ...options.out import file_option
from ...options.types import Quantity
from ...terminal import plain_console, print_whole, printable, writable_file

if TYPE_CHECKING:
    from fmus.carbody.modal_data import ModalData
    from structures.assembled import Structure

FILE = click.Path(path_type=Path, dir_okay=False)
LADINGS = ("none", "loose", "carrying")
COUNT = 10
OPTIONS = (
    click.option(
        "--units",
        metavar='"LENGTH, FORCE, TIME"',
        help='Units of a Nastran deck or of matrices, such as "in, lbf, s". Mass follows.',
    ),
    click.option("--front", type=int, metavar="NODE", help="Node of the front centre plate."),
    click.option("--rear", type=int, metavar="NODE", help="Node of the rear centre plate."),
    click.option(
        "--point",
        "points",
        multiple=True,
        metavar="NAME=NODE",
        help="A node that becomes an output of the carbody's FMU. Repeatable.",
    ),
    click.option("--punch", type=FILE, metavar="FILE.pch", help="Modes of the deck by Nastran."),
    click.option("--mass", type=FILE, metavar="M.mtx", help="Mass matrix beside a stiffness."),
    click.option(
        "--nodes", type=FILE, metavar="NODES.csv", help="Table: node, x [m], y [m], z [m]."
    ),
    click.option(
        "--lading",
        type=click.Choice(LADINGS),
        default="none",
        show_default=True,
        help="Of the hopper car: none, lumps without stiffness, or a lading that carries.",
    ),
    click.option(
        "--refinement",
        type=click.IntRange(1, 8),
        default=1,
        show_default=True,
        help="Elements of the hopper car for each of the usual ones, along a side.",
    ),
    click.option(
        "--modes",
        "count",
        type=click.IntRange(1, 400),
        metavar="N",
        help=f"Number of elastic modes.  [default: {COUNT}]",
    ),
    click.option(
        "--below",
        type=Quantity("frequency", "Hz", ("Hz", "1/s"), "30 Hz"),
        metavar="FREQUENCY",
        help="All modes below this frequency, in place of a number of them.",
    ),
    click.option(
        "--damping",
        type=click.FloatRange(0.0, 0.99),
        default=0.015,
        show_default=True,
        help="Damping ratio of every mode (1 is critical).",
    ),
)


@click.command(
    epilog="""\b
Examples:
  tracktrain structure --write my_hopper.toml
  tracktrain structure my_hopper.toml -o my_modes.toml
  tracktrain structure my_hopper.toml --lading loose --below "40 Hz"
  tracktrain structure car.bdf --units "in, lbf, s" --front 1203 --rear 2203
  tracktrain structure car.bdf --units "mm, N, s" --front 1 --rear 9 --punch car.pch
  tracktrain structure K.mtx --mass M.mtx --nodes nodes.csv --units "m, N, s"
  tracktrain carbody my_modes.toml -o my_carbody.fmu"""
)
@click.argument("model", required=False, type=FILE)
@file_option(
    "Modal data to write; the picture goes beside it.  [default: MODEL_modes.toml]",
    metavar="MODES.toml",
)
@click.option(
    "--write", type=FILE, metavar="FILE.toml", help="Write our hopper car's dimensions, to edit."
)
@adding(OPTIONS)
def command(model: Path | None, out: Path | None, write: Path | None, **options: Any) -> None:
    """Make the modes of a carbody from its structure: check it, solve it, write modal data.

    MODEL is a file of the hopper car's dimensions (.toml, see --write), Nastran bulk data (.bdf,
    .dat, .nas), or matrices: an .npz, or K.mtx with --mass and --nodes. X points forward, Y left, Z
    up; what is written is in SI. `tracktrain carbody` makes the FMU of it.
    """
    if write is not None:
        _write_hopper(write)
    if model is None:
        if write is None:
            raise TracktrainError("give a MODEL, or --write FILE.toml for the one that ships")
        return
    _solve(model, out or Path(f"{model.stem}_modes.toml"), options)


def _write_hopper(path: Path) -> None:
    from importlib.resources import files

    if path.exists():
        raise TracktrainError(f"'{path}' is there already; give another name")
    shipped = files("structures.hopper").joinpath("hopper.toml")
    with whole_file(path) as new:
        new.write_text(shipped.read_text(encoding="utf-8"), encoding="utf-8")
    click.echo(f"{path}: change it, then 'tracktrain structure {path}'")


def _solve(model: Path, out: Path, options: dict[str, Any]) -> None:
    from dataclasses import replace

    from fmus.carbody.modal_files import write_modal_data
    from structures.modal import modal_data
    from structures.model_files import Asked, lowest_modes, read_structure

    if options["count"] and options["below"]:
        raise TracktrainError("give --modes or --below, not both")
    if out.suffix.lower() != ".toml":
        raise TracktrainError(f"modal data are written as TOML; '{out}' has another ending")
    writable_file(out)
    names = ("units", "punch", "mass", "nodes", "lading", "refinement")
    asked = Asked(**{name: options[name] for name in names}, places=_places(options))
    found = read_structure(model, asked)
    modes = found.modes
    if modes is None:
        modes = lowest_modes(found.structure, options["count"] or COUNT, options["below"])
    elif options["below"] or options["count"]:
        raise TracktrainError("--punch gives its own modes; leave --modes and --below out")
    data = modal_data(
        found.structure, modes, found.source, options["damping"], [found.source, *found.notes]
    )
    if found.modes is not None:
        data = replace(data, residual_flexibility=None)  # only of the model's own modes is it known
    with whole_file(out) as new:
        write_modal_data(data, new)
    _say(found.structure, data)
    _picture(found.structure, out.with_suffix(".png"))
    click.echo(f"{out}: 'tracktrain carbody {out}' makes the FMU")


def _places(options: dict[str, Any]) -> dict[str, int]:
    places = {end: options[end] for end in ("front", "rear") if options[end] is not None}
    for text in options["points"]:
        name, equals, node = text.partition("=")
        if not equals or not node.strip().isdigit() or name.strip() in (*places, ""):
            raise TracktrainError(
                f"'{text}' is no named point; write it as floor=1203, once a name"
            )
        places[name.strip()] = int(node)
    return places


def _say(structure: Structure, data: ModalData) -> None:
    """Size, mass properties, frequencies."""
    import pandas as pd

    from structures.rigid import mass_properties

    own = mass_properties(structure)
    across = structure.positions[structure.places["front"], 1]
    aside = round(own.centre[1] - across, 6) + 0.0
    click.echo(
        f"{structure.name}: {len(structure.numbers)} nodes, {structure.degrees} degrees of freedom"
    )
    click.echo(
        f"  mass {own.mass:.6g} kg; centre of gravity {data.gravity_centre_height:.4g} m above the "
        f"centre plates, {aside:.3g} m to their left; centre plates "
        f"{2 * data.half_truck_spacing:.5g} m apart"
    )
    body = data.body
    click.echo(
        f"  inertias {body.roll_inertia:.5g} (roll), {body.pitch_inertia:.5g} (pitch), "
        f"{body.yaw_inertia:.5g} kg.m2 (yaw)"
    )
    for line in data.provenance:
        click.echo(f"  {line}")
    rows = {
        "frequency [Hz]": data.frequencies,
        "damping [1]": [mode.damping for mode in data.modes],
    }
    names = pd.Index([mode.name for mode in data.modes], name="mode")
    print_whole(plain_console(), printable(pd.DataFrame(rows, index=names), "elastic modes"))


def _picture(structure: Structure, path: Path) -> None:
    from ...studies.structure.pictures import model_figure

    if not structure.faces:
        click.echo("matrices have no elements to draw: no picture")
        return
    with whole_file(path) as new:
        model_figure(structure).savefig(new, dpi=150)
    click.echo(f"{path}: the model")
