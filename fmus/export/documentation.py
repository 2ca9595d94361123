"""The FMU's own documentation: ports, parameters with their sources, and the block's README."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path

from markdown_it import MarkdownIt

from ..block import Block, Parameter, Variable
from ..model import Model
from ..parameters import ParameterSet

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; margin: 1rem 0 } pre { overflow-x: auto; background: #f4f4f4 }
td, th { border-bottom: 1px solid #ccc; padding: .2rem .6rem; text-align: left;
         vertical-align: top }
"""


def documentation(
    block: Block | Model,
    parameters: ParameterSet | None,
    start: Mapping[str, float],
    readme: Path | None = None,
) -> str:
    """HTML page of the block: ports, parameters [SI] with basis and source, equations.

    The equations are in the README of the block's own folder, or in another one that is given.
    """
    page = [
        "<!DOCTYPE html>",
        f'<html lang="en"><head><meta charset="utf-8"><title>{escape(block.name)}</title>',
        f"<style>{STYLE}</style></head><body>",
        f"<h1>{escape(block.name)}</h1><p>{escape(block.description)}</p>",
        "<h2>Inputs</h2>",
        _table(
            ("name", "unit", "meaning", "unconnected"),
            [(v.name, v.unit, v.description, f"{v.start:g}") for v in block.inputs],
        ),
        "<h2>Outputs</h2>",
        _table(("name", "unit", "meaning"), [_row(v) for v in block.outputs]),
        *_local_variables(block),
        "<h2>Parameters</h2>",
        _table(
            ("name", "symbol", "start", "unit", "meaning", "basis", "source"),
            [_parameter_row(v, parameters, start) for v in block.parameters],
        ),
    ]
    readme = readme or Path(__file__).parent.parent / block.name / "README.md"
    if readme.exists():
        page.append(MarkdownIt("commonmark").enable("table").render(readme.read_text()))
    page.append("</body></html>")
    return "\n".join(page) + "\n"


def _local_variables(block: Block | Model) -> list[str]:
    if not block.locals:
        return []
    table = _table(("name", "unit", "meaning"), [_row(v) for v in block.locals])
    return ["<h2>Local variables</h2>", table]


def _row(variable: Variable) -> tuple[str, str, str]:
    return variable.name, variable.unit, variable.description


def _parameter_row(
    parameter: Parameter, parameters: ParameterSet | None, start: Mapping[str, float]
) -> tuple[str, ...]:
    value = start[parameter.name]
    shown = f"{value:.6g}"
    if parameter.choices:
        shown = f"{parameter.choices[int(value) - 1]} (of {', '.join(parameter.choices)})"
    entry = parameters.entry(parameter.name) if parameters else None
    basis, source = (entry.basis, entry.source) if entry else ("option", "default of the block")
    return (
        parameter.name,
        parameter.symbol,
        shown,
        parameter.unit,
        parameter.description,
        basis,
        source,
    )


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = ["<table><tr>" + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table>"])
