"""What differs in what was run: parameters, settings, FMUs, versions; and what is to be noted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from fmus.catalogue import fmu_path
from fmus.names import NAMES
from orchestrator import Provenance, describe

from ..car.hopper import layout_of
from ..car.layout import Shown

SETTINGS = ("master", "step", "start", "every", "fmu_tolerance", "stopped")
"""Attributes of a dataset that say how it was run."""

KINDS = ("parameter", "setting", "FMU", "version")
INDEX = ["kind", "name", "of"]

NONE = "-"
SHORT = 12
"""Digits of a hash that are shown."""


def differences(runs: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """What was not run alike: a row each, indexed by kind, name and instances, a column a run.

    kind: parameter [SI], setting, FMU, version. of: the instances of which it is true alike. `-`
    where a run does not have it.
    """
    said = {name: _said(data) for name, data in runs.items()}
    folded: dict[tuple[str, ...], list[str]] = {}
    for key in dict.fromkeys(key for values in said.values() for key in values):
        values = [found.get(key) for found in said.values()]
        if len(set(map(repr, values))) > 1:
            kind, name, instance = key
            folded.setdefault((kind, name, *map(_text, values)), []).append(instance)
    rows = [
        (kind, name, ", ".join(filter(None, instances)), *texts)
        for (kind, name, *texts), instances in folded.items()
    ]
    rows.sort(key=lambda row: KINDS.index(row[0]))
    return pd.DataFrame(rows, columns=[*INDEX, *runs]).set_index(INDEX)


def remarks(
    runs: Mapping[str, xr.Dataset],
    shown: Sequence[Shown],
    begin: float | None,
    end: float | None,
) -> list[str]:
    """What to know before the numbers are read."""
    spans = {name: (float(d["time"][0]), float(d["time"][-1])) for name, d in runs.items()}
    found = []
    if len({tuple(np.round(span, 9)) for span in spans.values()}) > 1:
        each = ", ".join(f"{name} {low:g} to {high:g} s" for name, (low, high) in spans.items())
        found.append(f"the spans differ: {each}; take the same of each with --from and --to")
    elif begin is not None or end is not None:
        low, high = next(iter(spans.values()))
        found.append(f"numbers and pictures are of the time from {low:g} to {high:g} s")
    for quantity in shown:
        without = [name for name, data in runs.items() if quantity.variable not in data]
        if without:
            found.append(f"{quantity.variable} is not in {', '.join(without)}")
    if _same_bits(list(runs.values()), shown):
        said = "the runs have the same values to the last bit in all signals compared"
        rows = differences(runs).index
        changed = [f"{of} {name}".strip() for kind, name, of in rows if kind == "parameter"]
        found.append(f"{said}: {'; '.join(changed)} had no say" if changed else said)
    for name, data in runs.items():
        lines = str(data.attrs.get("answer", "")).splitlines()
        told = (x for x in lines if x.startswith("Coupling:"))  # with what to type
        if verdict := next(told, str(data.attrs.get("verdict", ""))):
            found.append(f"{name}: {verdict}")
        found += [
            f"{name}: {x}" for x in lines if x.startswith("Range:") and " good." not in x[:13]
        ]
    return found


def _said(dataset: xr.Dataset) -> dict[tuple[str, str, str], Any]:
    """What a dataset says of its run, by kind, name and instance."""
    given = Provenance.of(dataset)
    blocks = layout_of(dataset).blocks
    said: dict[tuple[str, str, str], Any] = {}
    for full, value in given.parameters.items():
        instance, _, name = full.partition(".")
        unit, word = _as_its_block_has_it(blocks.get(instance, ""), name, value)
        shown = f"{name} [{unit}]" if unit not in ("", "1") else name
        said["parameter", shown, instance] = word
    for name in SETTINGS:
        if name in dataset.attrs:
            said["setting", name, ""] = dataset.attrs[name]
    time = dataset["time"].values
    if len(time):
        said["setting", "end [s]", ""] = float(f"{time[-1]:.12g}")
    for instance, fmu in given.fmus.items():
        file = f"{fmu.get('file', '')} {fmu.get('sha256', '')[:SHORT]}"
        said["FMU", "file and hash", instance] = file.strip()
    for package, version in given.versions.items():
        said["version", package, ""] = version
    return said


def _as_its_block_has_it(block: str, name: str, value: Any) -> tuple[str, Any]:
    """The unit of a value, and the word for a number that stands for one."""
    variable = describe(fmu_path(block)).variables.get(name) if block in NAMES else None
    if variable is None:
        return "", value
    words = {float(number): word for word, number in variable.items.items()}
    return variable.unit or "", words.get(value, value)


def _text(value: Any) -> str:
    if value is None:
        return NONE
    if isinstance(value, float) or hasattr(value, "dtype"):
        return f"{float(value):.6g}"
    return str(value)


def _same_bits(runs: Sequence[xr.Dataset], shown: Sequence[Shown]) -> bool:
    first, *others = runs
    names = [quantity.variable for quantity in shown]
    return all(
        name in run and name in first and np.array_equal(first[name].values, run[name].values)
        for run in others
        for name in names
    )
