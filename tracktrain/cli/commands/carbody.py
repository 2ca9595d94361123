"""The command `tracktrain carbody`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from orchestrator import whole_file

from ...car.hopper import vehicle
from ...errors import TracktrainError
from ...options.car import car_option
from ...options.fmu import fmi_option, target_option
from ...options.out import file_option
from ...options.types import Quantity
from ...terminal import writable_file

if TYPE_CHECKING:
    from fmus.carbody.modal_data import ModalData


class Residual(Quantity):
    """A frequency [Hz], or `none`."""

    NONE = 0.0

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        return self.NONE if value == "none" else super().convert(value, param, ctx)


@click.command(
    epilog="""\b
Examples:
  tracktrain carbody my_modes.csv
  tracktrain carbody my_modes.csv --car empty -o my_carbody.fmu --fmi 3.0
  tracktrain carbody my_modes.toml --modes 4 --residual "80 Hz"
  tracktrain carbody my_modes.csv --write my_modes.toml
  tracktrain run --carbody my_modes.csv"""
)
@click.argument("modes", type=click.Path(path_type=Path, dir_okay=False))
@file_option("FMU to write.  [default: the name of MODES with .fmu]")
@fmi_option(
    "python",
    meaning="Version; python is Python sources to read and to change, of FMI 2.0.",
)
@target_option()
@car_option()
@click.option(
    "--modes",
    "count",
    type=click.IntRange(min=1),
    metavar="N",
    help="Keep the N lowest modes; what the others give way statically is kept as residual.",
)
@click.option(
    "--residual",
    type=Residual("frequency", "Hz", ("Hz", "1/s"), "80 Hz"),
    metavar="FREQUENCY|none",
    help="How the flexibility of the modes left out counts at the centre plates: as modes of this "
    "frequency, above all that matters, or not at all.  [default: 2.5 x the highest kept, at least "
    "100 Hz]",
)
@click.option(
    "--write",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE.toml",
    help="Also write the data in the full format, to add what a CSV cannot hold.",
)
def command(
    modes: Path,
    out: Path | None,
    fmi: str,
    targets: tuple[str, ...],
    car: str,
    count: int | None,
    residual: float | None,
    write: Path | None,
) -> None:
    """Make the FMU of a carbody from its modes: frequencies, damping and shapes in MODES.

    MODES is CSV, one row for each mode and point (front and rear are the centre plates), or TOML,
    the full format. What it does not say of the body is taken from the parameter set of --car.
    """
    from dataclasses import replace

    import numpy as np

    from fmus.carbody.modal_files import read_modal_data, write_modal_data
    from fmus.carbody.residual import with_residual_modes
    from fmus.describe.parameters import parameter_set
    from fmus.export.carbody import build_carbody
    from fmus.export.python import build_python_carbody

    path = writable_file(out or Path(f"{modes.stem}.fmu"))
    if write is not None:
        writable_file(write)
    data = read_modal_data(modes, parameter_set(vehicle(car).parameters))
    if count is not None:
        if count > len(data.modes):
            raise TracktrainError(
                f"'{modes}' has {len(data.modes)} modes; --modes {count} asks for more"
            )
        data = data.truncated(sorted(np.argsort(data.frequencies, kind="stable")[:count].tolist()))
    if residual == Residual.NONE:
        data = replace(data, residual_flexibility=None)
    if write is not None:
        with whole_file(write) as new:
            write_modal_data(data, new)
    data = with_residual_modes(data, residual)
    if fmi == "python":
        build_python_carbody(data, path, targets)
    else:
        build_carbody(data, path, fmi, targets)
    _say(data)
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


def _say(data: ModalData) -> None:
    """What the FMU is made of."""
    body = data.body
    click.echo(
        f"{data.name}: {body.mass:.6g} kg, inertias {body.roll_inertia:.4g} (roll), "
        f"{body.pitch_inertia:.4g} (pitch), {body.yaw_inertia:.4g} kg.m2 (yaw)"
    )
    for number, mode in enumerate(data.modes, start=1):
        click.echo(
            f"  mode[{number}]  {mode.frequency:9.4g} Hz  damping {mode.damping:.4g}  "
            f"{mode.name} ({mode.basis}: {mode.source})"
        )
    further = ", ".join(data.outputs) or "none"
    click.echo(f"  centre plates front and rear; further outputs at: {further}")
    for line in data.provenance:
        click.echo(f"  {line}")
