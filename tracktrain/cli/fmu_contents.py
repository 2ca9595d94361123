"""What an FMU's archive holds besides ports and binaries: states, terminals, related files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import prod
from xml.etree.ElementTree import Element

from orchestrator import Archive, ArchiveError, Contents, open_archive

TERMINALS = ("terminalsAndIcons/terminalsAndIcons.xml", "icons/terminalsAndIcons.xml")
"""Where the file is; the second is where drafts of FMI 3.0 had it."""

MANIFEST = "fmi-ls-manifest.xml"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
REFERENCES = "org.fmi-standard.fmi-ls-ref"


@dataclass(frozen=True)
class TerminalInfo:
    """A terminal; members are (name in the terminal, variable, kind)."""

    name: str
    kind: str
    rule: str
    members: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class LayeredStandard:
    """A layered standard that the FMU follows, and the related files (role, file) it lists."""

    name: str
    version: str
    related: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Extras:
    """Continuous states, event indicators and what lies beside the description.

    problems: what cannot be read, one sentence each.
    """

    states: int
    event_indicators: int
    terminals: tuple[TerminalInfo, ...] = ()
    standards: tuple[LayeredStandard, ...] = ()
    problems: list[str] = field(default_factory=list)


def extras(contents: Contents) -> Extras:
    """Look into an FMU of any version; what is wrong in these files is told, not raised."""
    problems: list[str] = []

    def root(archive: Archive, member: str) -> Element | None:
        try:
            return archive.xml(member)
        except ArchiveError as error:
            problems.append(str(error))
            return None

    terminals: list[TerminalInfo] = []
    standards: list[LayeredStandard] = []
    with open_archive(contents.path) as archive:
        for member in archive.members:
            first, *middle = member.split("/")
            manifest = first == "extra" and middle[1:] == [MANIFEST]
            if not manifest and member not in TERMINALS:
                continue
            found = root(archive, member)
            if found is None:
                continue
            if manifest:
                standards.append(_standard(found, middle[0]))
            for parent in found.iterfind("Terminals"):
                terminals += _terminals(parent)
    states, indicators = _sizes(contents)
    return Extras(states, indicators, tuple(terminals), tuple(standards), problems)


def _sizes(contents: Contents) -> tuple[int, int]:
    """Numbers of continuous states and event indicators, every element of an array counted."""
    root = contents.root
    elements = {v.valueReference: prod(v.shape or ()) for v in contents.model.modelVariables}

    def counted(tag: str) -> int:
        listed = root.iterfind(f"ModelStructure/{tag}")
        return sum(elements.get(_number(e.get("valueReference")), 1) for e in listed)

    states = counted("ContinuousStateDerivative")
    states = states or len(root.findall("ModelStructure/Derivatives/Unknown"))
    return (
        states or _number(root.get("numberOfContinuousStates")),
        counted("EventIndicator") or _number(root.get("numberOfEventIndicators")),
    )


def _number(text: str | None) -> int:
    return int(text) if text and text.isdecimal() else 0


def _terminals(parent: Element, outer: str = "") -> Iterator[TerminalInfo]:
    """The terminals, inner ones by the names of both."""
    for element in parent.iterfind("Terminal"):
        name = outer + element.get("name", "")
        members = tuple(
            (
                member.get("memberName", ""),
                member.get("variableName", ""),
                member.get("variableKind", ""),
            )
            for member in element.iterfind("TerminalMemberVariable")
        )
        kind, rule = element.get("terminalKind", ""), element.get("matchingRule", "")
        yield TerminalInfo(name, kind, rule, members)
        yield from _terminals(element, f"{name}.")


def _standard(root: Element, folder: str) -> LayeredStandard:
    name = root.get(f"{NAMESPACE}fmi-ls-name", folder)
    related = root.iterfind("Related") if name == REFERENCES else ()
    return LayeredStandard(
        name,
        root.get(f"{NAMESPACE}fmi-ls-version", ""),
        tuple((element.get("role", ""), element.get("source", "")) for element in related),
    )
