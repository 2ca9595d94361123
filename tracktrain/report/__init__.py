"""A run as one page: a single HTML file that needs nothing else, and no network.

write_report(run.dataset, Path("results"))
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from orchestrator import Provenance, Responses, Run, whole_file

from ..answer import parts
from ..assessment import judged
from ..assessment.order import grouped, left_out, summed_up
from ..car import curving, slip
from ..errors import TracktrainError
from ..events import nadal_rule
from ..results import PAGE, Bond, responses_of
from ..statistics import STATISTICS
from . import content, motion, series, system
from .packing import packed
from .rendering import rendered

SCRIPTS = ("common.js", "data.js", "scene.js", "player.js", "chart.js", "plots.js", "page.js")
"""In the order in which they need each other."""


def write_report(
    run: Responses | Run | Path | str, folder: Path | str, bonds: Sequence[Bond] | None = None
) -> Path:
    """Write report.html into a folder and return it.

    run: it, its dataset, or the folder that it wrote. bonds: as `tracktrain.results.read_bonds`
    gives it. Raises TracktrainError for a run without two rows,
    orchestrator.UnwrittenError.
    """
    path = Path(folder) / PAGE
    text = page(responses_of(run), bonds)
    with whole_file(path) as new:
        new.write_text(text, encoding="utf-8")
    return path


def page(dataset: Responses, bonds: Sequence[Bond] | None = None) -> str:
    """The text of the page."""
    if dataset.sizes.get("time", 0) < 2 or not dataset.data_vars:
        raise TracktrainError("the run has no two rows of any signal; there is nothing to report")
    index, blob, width = _data(dataset)
    table, provenance = judged(dataset), Provenance.of(dataset)
    return rendered(
        "page.html",
        SCRIPTS,
        title=content.title(dataset),
        attributes=dataset.attrs,
        command=dataset.attrs.get("command"),
        facts=content.facts(dataset, table, bonds),
        parameters=content.parameters(dataset),
        fmus=content.fmus(dataset),
        system=None if content.is_car(dataset) else system.made(dataset),
        notes=[*provenance.notes, *curving.remarks(dataset), *slip.remarks(dataset)],
        parts=parts(dataset),
        events=content.happened(dataset),
        nadal=nadal_rule(dataset),
        versions=provenance.versions,
        numbers=content.numbers(dataset),
        headings=(*STATISTICS, "dominant frequency"),
        assessment=grouped(table),
        left_out=left_out(table),
        summed_up=summed_up(table),
        few=content.FEW_EVENTS,
        bonds=bonds,
        rows=dataset.sizes["time"],
        width=width,
        index=index,
        blob=blob,
    )


def _data(dataset: Responses) -> tuple[str, str, int]:
    """What the scripts know of the run: JSON, and the arrays that it indexes; rows of a bin."""
    said, arrays, width = series.signals(dataset)
    known: dict[str, Any] = {
        "signals": said,
        "first": series.first(dataset) if content.is_car(dataset) else system.moving(dataset),
        "events": [
            {"kind": e.kind, "place": e.place, "from": e.time, "to": e.time + e.duration}
            for e in content.happened(dataset)
        ],
    }
    for name, part in (("scene", motion.scene(dataset)), ("modes", motion.modes(dataset))):
        known[name] = part[0] if part else None
        arrays |= part[1] if part else {}
    if known["scene"] is None:
        known["modes"] = None
    index, blob = packed(arrays)
    return as_json({**known, "arrays": index}), blob, width


def as_json(known: Mapping[str, Any]) -> str:
    """JSON that can stand in a script element."""
    return json.dumps(known, separators=(",", ":")).replace("<", "\\u003c")
