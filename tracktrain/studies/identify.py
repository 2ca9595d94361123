"""The analog parameters of a truck element from a measured loop, report section 4.2.4."""

from __future__ import annotations

import re
from io import BytesIO
from pathlib import Path

import click
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.truck.identify import Identification
from fmus.truck.identify import identify as fit
from orchestrator import choices, content_of

from ..errors import TracktrainError
from ..plots import INK, MUTED, RED, STYLE
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome

HEADING = re.compile(r"\s*(?P<name>.*?)\s*\[(?P<unit>[^\]]+)\]\s*")
SYMBOLS = {
    "stiffness": "K0",
    "stop_stiffness": "K1",
    "friction_stiffness": "Kf",
    "friction_limit": "f",
    "free_play": "Delta",
}


@taking()
def identify(file: Path, strain: str | None = None, force: str | None = None) -> Outcome:
    """Fit K0, K1, Kf, f and Delta to a loop of force over deflection.

    FILE is a CSV table, sampled in time along at least one full cycle, with a column for the
    deflection and one for the force; units stand in the headings, as in "strain [in]" and
    "force [lbf]". The result tells each parameter with its 95 % confidence interval, and what the
    loop cannot tell. The noise is taken to be in the force. Raises TracktrainError for a file or
    column that cannot be used.
    """
    table = _read(file)
    names = list(table.columns)
    columns = [_column(names, wanted, n) for n, wanted in enumerate((strain, force))]
    units = [_unit(name) for name in columns]
    deflection, load = (table[name].to_numpy(float) for name in columns)
    try:
        found = fit(deflection, load)
    except ValueError as error:
        raise TracktrainError(f"'{file}': {error}") from None
    model = ("sample", found.model, {"units": units[1]})
    dataset = xr.Dataset(
        {
            "strain": ("sample", deflection, {"units": units[0]}),
            "force": ("sample", load, {"units": units[1]}),
            "model": model,
        },
        attrs={"file": file.name, "noise": found.noise, "offset": found.offset},
    )
    return Outcome(
        title=f"Analog parameters of the loop in {file.name}",
        dataset=dataset,
        tables={"parameters": _table(found, units)},
        pictures={"loop": _figure(deflection, load, found, units)},
        notes=[f"noise of the force: {found.noise:.3g} {units[1]} (rms)", *found.remarks],
    )


command = study_command(
    "identify",
    click.argument("file", type=click.Path(path_type=Path), metavar="FILE"),
    click.option("--strain", metavar="COLUMN", help="Column of the deflection.  [default: first]"),
    click.option("--force", metavar="COLUMN", help="Column of the force.  [default: second]"),
    epilog="""\b
Examples:
  tracktrain study truck-hysteresis
  tracktrain study identify tracktrain-truck-hysteresis/loop_warp.csv""",
)(identify)


def _read(file: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(BytesIO(content_of(file)), skipinitialspace=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise TracktrainError(f"'{file}' cannot be read: {reason}") from None
    except (ValueError, pd.errors.ParserError) as error:
        raise TracktrainError(f"'{file}' is no CSV table: {error}") from None
    numbers = table.select_dtypes("number")
    if numbers.shape[1] < 2:
        raise TracktrainError(
            f"'{file}' needs a column of deflections and one of forces; of its columns "
            f"{', '.join(map(str, table))} {numbers.shape[1]} hold numbers"
        )
    return numbers


def _column(names: list[str], wanted: str | None, place: int) -> str:
    """The column that is called so, with or without its unit; without a wish the n-th."""
    if wanted is None:
        return names[place]
    for name in names:
        heading = HEADING.fullmatch(name)
        if wanted in (name, heading["name"] if heading else name):
            return name
    raise TracktrainError(f"there is no column '{wanted}'; {choices(wanted, names)}")


def _unit(name: str) -> str:
    heading = HEADING.fullmatch(name)
    return heading["unit"] if heading else "1"


def _table(found: Identification, units: list[str]) -> pd.DataFrame:
    deflection, load = units
    rows = []
    for name, estimate in found.estimates.items():
        unit = {"friction_limit": load, "free_play": deflection}.get(name, f"{load}/{deflection}")
        rows.append(
            {
                "parameter": name,
                "symbol": SYMBOLS[name],
                "unit": unit,
                "value": estimate.value,
                "from": estimate.low,
                "to": estimate.high,
                "told": "yes" if estimate.told else "no",
            }
        )
    return pd.DataFrame(rows).set_index("parameter")


@mpl.rc_context(STYLE)
def _figure(
    strain: np.ndarray, force: np.ndarray, found: Identification, units: list[str]
) -> Figure:
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    loop, rest = figure.subplots(1, 2, width_ratios=(3, 2))
    loop.plot(strain, force, ".", color=MUTED, markersize=2, label="measured")
    loop.plot(strain, found.model, color=RED, linewidth=1.4, label="identified")
    loop.set(xlabel=f"deflection [{units[0]}]", ylabel=f"force [{units[1]}]")
    loop.legend(frameon=False)
    loop.set_title("Loop and what was fitted to it")
    rest.plot(strain, force - found.model, ".", color=INK, markersize=2)
    rest.set(xlabel=f"deflection [{units[0]}]", ylabel=f"[{units[1]}]")
    rest.set_title("What is left")
    return figure
