"""The FMU's own documentation: ports, parameters with their sources, and the block's README."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from xml.etree import ElementTree

from markdown_it import MarkdownIt

from ..describe.block import Block
from ..describe.parameters import Entry, ParameterSet
from ..describe.ranges import range_of
from ..describe.variables import Parameter, Values, Variable
from ..model import Model

STYLE = """
:root { --ink: #26323d; --faint: #5d6b78; --line: #d5dde4; --tint: #f3f6f9; --accent: #1f5fa8 }
* { box-sizing: border-box }
body { font: 16px/1.55 system-ui, sans-serif; color: var(--ink); background: #fff;
       max-width: 62rem; margin: 0 auto; padding: 1.5rem 1rem 4rem; overflow-wrap: break-word }
header { display: flex; gap: 1rem; align-items: center }
header img { width: 5rem; flex: none }
h1 { margin: 0; font-size: 1.9rem; line-height: 1.2 } header p { margin: .2rem 0 0 }
h2 { margin: 2.6rem 0 .6rem; font-size: 1.3rem; border-bottom: 2px solid var(--line) }
a { color: var(--accent) }
nav { margin: 1rem 0; display: flex; flex-wrap: wrap; gap: .2rem 1rem }
figure { margin: 1rem 0 } figure img { width: 100%; height: auto }
.wide { overflow-x: auto } pre { overflow-x: auto; background: var(--tint); padding: .8rem 1rem;
  border-left: 3px solid var(--line); font-size: .86rem; line-height: 1.5 }
code { font-size: .9em } table { border-collapse: collapse; margin: .6rem 0; font-size: .92rem }
td, th { border-bottom: 1px solid var(--line); padding: .25rem .9rem .25rem 0; text-align: left;
         vertical-align: top } th { color: var(--faint); font-weight: 600 }
td:first-child { font-family: ui-monospace, monospace; font-size: .86rem; white-space: nowrap }
td:last-child { min-width: 9rem }
@media (max-width: 40rem) { body { font-size: 15px } pre { font-size: .74rem; padding: .6rem }
  header img { width: 3.5rem } h1 { font-size: 1.5rem } }
"""

USE = """
In FMPy, from the command line and from Python:

```
fmpy info {name}.fmu
fmpy simulate {name}.fmu --output-interval 0.001 --stop-time 1
```

```
from fmpy import simulate_fmu
result = simulate_fmu("{name}.fmu", stop_time=1.0, output_interval=1e-3)
```

{needs} All values are SI; an
input that is not connected keeps its start value.
"""

NATIVE_NEEDS = """Any importer of FMI can use it: it needs nothing of the machine but its C library,
and its sources can be compiled where no library is given (`sources/buildDescription.xml`)."""

PYTHON_NEEDS = """Any importer of FMI 2.0 can use it where Python is: `externalDependencies.txt`
says which, and with what packages. Its sources are in the archive's folder `resources`, to be read
and changed."""

CAPABILITIES = {
    "modelIdentifier": "name of the library",
    "canHandleVariableCommunicationStepSize": "steps of any size",
    "canInterpolateInputs": "inputs may vary linearly over a step",
    "recommendedIntermediateInputSmoothness": "smoothness of inputs within a step",
    "canGetAndSetFMUstate": "state saved and restored",
    "canGetAndSetFMUState": "state saved and restored",
    "canSerializeFMUstate": "state stored as bytes",
    "canSerializeFMUState": "state stored as bytes",
    "providesDirectionalDerivative": "exact directional derivatives",
    "providesDirectionalDerivatives": "exact directional derivatives",
    "providesAdjointDerivatives": "exact adjoint derivatives",
    "canBeInstantiatedOnlyOncePerProcess": "one instance per process only",
    "needsExecutionTool": "needs its tool on the machine",
}
"""Words for the attributes of an interface, in the order in which they are told."""


def documentation(
    block: Block | Model,
    parameters: ParameterSet | None,
    start: Values,
    readme: Path | None = None,
    description: str | None = None,
) -> str:
    """HTML page of the block: equations, ports, parameters [SI] with basis and source, use.

    The equations are in the README of the block's own folder, or in another one that is given.
    description: text of modelDescription.xml, for what the FMU can do.
    """
    readme = readme or Path(__file__).parent.parent / _folder(block) / "README.md"
    terminals = block.terminals if isinstance(block, Block) else ()
    sections = {
        "": _readme(readme),
        "Inputs": _table(
            ("name", "unit", "meaning", "unconnected"),
            [(v.name, v.unit, v.description, f"{v.start:g}") for v in block.inputs],
        ),
        "Outputs": _table(("name", "unit", "meaning"), [_row(v) for v in block.outputs]),
        "Local variables": _table(("name", "unit", "meaning"), [_row(v) for v in block.locals]),
        "Constants": _table(("name", "unit", "meaning"), [_row(v) for v in block.constants]),
        "Arrays of FMI 3.0": _arrays(block) if isinstance(block, Block) else "",
        "Parameters": _table(
            (
                "name",
                "symbol",
                "start",
                "unit",
                "meaning",
                "range",
                "basis",
                "source",
                "reason of the range",
            ),
            [_parameter_row(v, parameters, start) for v in block.parameters],
        ),
        "Terminals": _terminals(block) if isinstance(block, Block) else "",
        "Range": _range(block),
        "Coupling": _coupling(block),
        "What it can do": _capabilities(description) if description else "",
        "Use": _use(block, description or ""),
    }
    told = {title: text for title, text in sections.items() if text}
    links = [f'<a href="#{_anchor(title)}">{title}</a>' for title in told if title]
    drawn = ""
    if terminals:  # a block of the car, which comes with licence, drawings and reference results
        links.append('<a href="licenses/license.txt">Licence</a>')
        links.append('<a href="fmi-ls-ref.txt">Reference results</a>')
        drawn = '<figure><img src="diagram.png" alt="Ports and axes of the block"></figure>'
    body = "".join(
        (f'<h2 id="{_anchor(title)}">{title}</h2>' if title else "") + f"{text}\n"
        for title, text in told.items()
    )
    icon = '<img src="../terminalsAndIcons/icon.png" alt="">' if terminals else ""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{escape(block.name)}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>{STYLE}</style></head><body>
<header>{icon}<div><h1>{escape(block.name)}</h1><p>{escape(block.description)}</p></div></header>
<nav>{" ".join(links)}</nav>
{drawn}
{body}</body></html>
"""


# Files that a README points to and an FMU does not hold, and where the page has what they say.
_POINTERS = {
    r"`range\.toml`": "[Range](#range)",
    r"`\.\./parameters/\*\.toml`": "[Parameters](#parameters)",
    r"`\.\./(\w+)(/README\.md)?`": r"the documentation of `\1`",
}


def _folder(block: Block | Model) -> str:
    return block.folder if isinstance(block, Block) else block.name


def _arrays(block: Block) -> str:
    rows = [(a.name, " x ".join(map(str, a.shape)), a.description) for a in block.all_arrays]
    return _table(("name", "size", "meaning"), rows)


def _anchor(title: str) -> str:
    return title.lower().replace(" ", "-")


def _markdown(text: str) -> str:
    html = MarkdownIt("commonmark").enable("table").render(text)
    return html.replace("<table>", '<div class="wide"><table>').replace(
        "</table>", "</table></div>"
    )


def _readme(path: Path) -> str:
    """The README without its title, which the page has already."""
    if not path.exists():
        return ""
    title, _, rest = path.read_text().partition("\n")
    for pointer, place in _POINTERS.items():
        rest = re.sub(pointer, place, rest)
    return _markdown(rest if title.startswith("# ") else title + "\n" + rest)


def _terminals(block: Block) -> str:
    if not block.terminals:
        return ""
    variables = [*block.inputs, *block.outputs]
    rows = []
    for terminal in block.terminals:
        members = ", ".join(member.name for member in terminal.members(variables))
        joint = terminal.joint
        rows.append((terminal.name, terminal.description, joint.kind, joint.rule, members))
    return (
        "<p>Terminals of the same kind belong together: a tool connects their members by name "
        "(terminalsAndIcons.xml).</p>"
    ) + _table(("name", "meets", "kind", "rule", "members"), rows)


def _range(block: Block | Model) -> str:
    """What the laws hold for."""
    limits = range_of(block) if isinstance(block, Block) else block.limits
    if limits is None:
        return ""
    if not limits:
        return "<p>What the block computes holds for all that it can be told.</p>"
    rows = []
    for limit in limits:
        ends = {"≥": limit.least, "≤": limit.largest}
        held = ", ".join(f"{sign} {end:.4g}" for sign, end in ends.items() if end is not None)
        held += f"; outside {limit.allowed:.0%} of the time at most" if limit.allowed else ""
        told = (limit.beyond, limit.remedy, limit.basis, limit.source)
        rows.append((", ".join(limit.outputs), held, limit.unit, *told))
    return (
        "<p>The block's laws hold while these outputs are within their limits; the annotation "
        "<code>Range</code> of the model description lists them.</p>"
    ) + _table(("outputs", "hold for", "unit", "beyond", "what helps", "basis", "source"), rows)


def _coupling(block: Block | Model) -> str:
    """What a master can use beyond values: rates and partial derivatives."""
    parts = []
    if any(output.derivative_of for output in block.outputs):
        parts.append(
            "<p>Outputs that are rates say so in the attribute <code>derivative</code>; a master "
            "can lead the inputs of other FMUs by them.</p>"
        )
    if block.tangents:
        parts.append(
            "<p>Optional inputs take the partial derivatives of an input with respect to the "
            "block's own outputs. Within a step the input then follows the block's own motion. "
            "They are 0 when unconnected; the annotation <code>Coupling</code> of the model "
            "description lists them.</p>"
        )
        rows = [(t.partial, t.input, t.output) for t in block.tangents]
        parts.append(_table(("input", "is the derivative of", "with respect to"), rows))
    return "".join(parts)


def _use(block: Block | Model, description: str) -> str:
    name, needs = block.name, NATIVE_NEEDS
    slave = ElementTree.fromstring(description).find("CoSimulation") if description else None
    if slave is not None and slave.get("needsExecutionTool") == "true":
        name, needs = slave.get("modelIdentifier", name), PYTHON_NEEDS
    return _markdown(USE.format(name=name, needs=needs))


def _capabilities(description: str) -> str:
    root = ElementTree.fromstring(description)
    rows = []
    for tag in ("ModelExchange", "CoSimulation", "ScheduledExecution"):
        for name, words in CAPABILITIES.items():
            said = root.find(tag)
            if said is not None and name in said.attrib:
                value = {"true": "yes", "false": "no"}.get(said.attrib[name], said.attrib[name])
                rows.append((tag, words, value))
    return f"<p>FMI {root.get('fmiVersion')}.</p>" + _table(("interface", "", ""), rows)


def _row(variable: Variable) -> tuple[str, str, str]:
    return variable.name, variable.unit, variable.description


def _parameter_row(
    parameter: Parameter, parameters: ParameterSet | None, start: Values
) -> tuple[str, ...]:
    value = start[parameter.name]
    shown = f"{value:.6g}"
    if parameter.choices:
        shown = f"{parameter.choices[int(value) - 1]} (of {', '.join(parameter.choices)})"
    entry = parameters.entry(parameter.name) if parameters else None
    basis, source = (entry.basis, entry.source) if entry else ("option", "default of the block")
    spread, reason = _spread(entry, parameter.unit) if entry else ("", "")
    return (
        parameter.name,
        parameter.symbol,
        shown,
        parameter.unit,
        parameter.description,
        spread,
        basis,
        source,
        reason,
    )


def _spread(entry: Entry, unit: str) -> tuple[str, str]:
    """How far a number may be off, in its FMI unit, and why."""
    if entry.follows:
        return f"in proportion to {entry.follows}", entry.spread
    found = entry.spread_in(unit)
    return str(found or ""), entry.spread


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    if not rows:
        return ""
    lines = [
        '<div class="wide"><table><tr>' + "".join(f"<th>{escape(h)}</th>" for h in head) + "</tr>"
    ]
    lines += ["<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows]
    return "\n".join([*lines, "</table></div>"])
