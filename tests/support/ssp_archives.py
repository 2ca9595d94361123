"""Archives of the SSP standard from pieces of text, in the manner of other tools."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

from lxml import etree

DAMPER, MASS = "resources/damper.fmu", "resources/mass.fmu"
"""Members that most archives have."""

SPACES = " ".join(
    f'xmlns:{prefix}="http://ssp-standard.org/SSP1/SystemStructure{name}"'
    for prefix, name in (
        ("ssd", "Description"),
        ("ssc", "Common"),
        ("ssv", "ParameterValues"),
        ("ssm", "ParameterMapping"),
        ("ssb", "SignalDictionary"),
    )
)
UNITS = """<{0}:Units>
<ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1"/></ssc:Unit>
<ssc:Unit name="km/h"><ssc:BaseUnit m="1" s="-1" factor="0.2777777777777778"/></ssc:Unit>
<ssc:Unit name="N"><ssc:BaseUnit kg="1" m="1" s="-2"/></ssc:Unit>
<ssc:Unit name="kN"><ssc:BaseUnit kg="1" m="1" s="-2" factor="1000"/></ssc:Unit>
<ssc:Unit name="N.s/m"><ssc:BaseUnit kg="1" s="-1"/></ssc:Unit>
<ssc:Unit name="ton"><ssc:BaseUnit kg="1" factor="1000"/></ssc:Unit>
<ssc:Unit name="degC"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>
</{0}:Units>"""


def ssd(system: str, after: str = "", version: str = "1.0", name: str = "test") -> str:
    """A description of what is in its root system."""
    return (
        f'<ssd:SystemStructureDescription version="{version}" name="{name}" {SPACES}>'
        f'<ssd:System name="root">{system}</ssd:System>{UNITS.format("ssd")}{after}'
        "</ssd:SystemStructureDescription>"
    )


def ssv(parameters: Mapping[str, str], version: str = "1.0") -> str:
    """A parameter set: elements such as `Real value="1" unit="N"` by name."""
    inside = "".join(
        f'<ssv:Parameter name="{name}"><ssv:{value}/></ssv:Parameter>'
        for name, value in parameters.items()
    )
    return (
        f'<ssv:ParameterSet version="{version}" name="set" {SPACES}>'
        f"<ssv:Parameters>{inside}</ssv:Parameters>{UNITS.format('ssv')}</ssv:ParameterSet>"
    )


def ssm(*entries: str) -> str:
    """A parameter map of entries."""
    return f'<ssm:ParameterMapping version="1.0" {SPACES}>{"".join(entries)}</ssm:ParameterMapping>'


def inline(values: str, mapping: str = "", attributes: str = "") -> str:
    """A binding that holds its parameter set and its map."""
    mapped = f"<ssd:ParameterMapping>{mapping}</ssd:ParameterMapping>" if mapping else ""
    return (
        f"<ssd:ParameterBinding {attributes}><ssd:ParameterValues>{values}</ssd:ParameterValues>"
        f"{mapped}</ssd:ParameterBinding>"
    )


def bindings(*each: str) -> str:
    return f"<ssd:ParameterBindings>{''.join(each)}</ssd:ParameterBindings>"


def connectors(**kinds: str) -> str:
    """Connectors by name, as "input" or "input Real unit='N'"."""
    found = []
    for name, text in kinds.items():
        kind, _, typed = text.partition(" ")
        inside = f"<ssc:{typed}/>" if typed else ""
        found.append(f'<ssd:Connector name="{name}" kind="{kind}">{inside}</ssd:Connector>')
    return f"<ssd:Connectors>{''.join(found)}</ssd:Connectors>"


def component(name: str, source: str, inside: str = "", attributes: str = "") -> str:
    return f'<ssd:Component name="{name}" source="{source}" {attributes}>{inside}</ssd:Component>'


def system(name: str, inside: str) -> str:
    return f'<ssd:System name="{name}">{inside}</ssd:System>'


def elements(*each: str) -> str:
    return f"<ssd:Elements>{''.join(each)}</ssd:Elements>"


def connection(start: str, end: str, inside: str = "", attributes: str = "") -> str:
    """From "element.connector", or from ".connector" of the system itself, to another."""
    ends = ""
    for which, place in (("start", start), ("end", end)):
        element, _, connector = place.partition(".")
        ends += f' {which}Element="{element}"' if element else ""
        ends += f' {which}Connector="{connector}"'
    return f"<ssd:Connection {ends} {attributes}>{inside}</ssd:Connection>"


def connections(*each: str) -> str:
    return f"<ssd:Connections>{''.join(each)}</ssd:Connections>"


def linear(factor: float = 1.0, offset: float = 0.0) -> str:
    return f'<ssc:LinearTransformation factor="{factor!r}" offset="{offset!r}"/>'


def write(path: Path, members: Mapping[str, str | bytes | Path]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            data = content.read_bytes() if isinstance(content, Path) else content
            archive.writestr(name, data)
    return path


def schemas(version: str) -> Path:
    """The published schemas, as packages bring them along."""
    if version == "1.0":
        import fmpy.ssp

        return Path(fmpy.ssp.__file__).parent / "schema"
    import pyssp_standard

    return Path(pyssp_standard.__file__).parent / "resources/ssp2"


def problems(content: bytes, kind: str, version: str) -> list[str]:
    """What the schema of a kind of file (Description, ParameterValues) finds wrong."""
    schema = etree.XMLSchema(etree.parse(str(schemas(version) / f"SystemStructure{kind}.xsd")))
    schema.validate(etree.fromstring(content))
    return [str(error) for error in schema.error_log]
