"""XML of SSP files: read with care, asked in few words, written as the standard spells it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from ..errors import SspError
from ..fmu.archive import parse_xml

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
    "ssb": "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
}
"""Those of SSP 1.0, which SSP 2.0 kept, and the annotations of the Open Simulation Platform."""


@dataclass(frozen=True)
class Node:
    """An element, and the file that it stands in, which messages name."""

    element: ElementTree.Element
    file: str

    @property
    def tag(self) -> str:
        """Its name without the namespace."""
        return self.element.tag.rpartition("}")[2]

    def get(self, attribute: str, default: str = "") -> str:
        return self.element.get(attribute, default)

    def has(self, attribute: str) -> bool:
        return attribute in self.element.attrib

    def need(self, attribute: str) -> str:
        """An attribute that the standard requires; raises SspError without it."""
        if attribute not in self.element.attrib:
            self.fail(f"<{self.tag}> lacks the attribute '{attribute}'")
        return self.element.attrib[attribute]

    def number(self, attribute: str, default: float | None = None) -> float:
        """An attribute as a number; raises SspError for anything else."""
        text = self.need(attribute) if default is None else self.get(attribute, repr(default))
        try:
            return float(text)
        except ValueError:
            self.fail(f'<{self.tag}> has {attribute}="{text}", which is no number')

    def whole(self, attribute: str, default: int | None = None) -> int:
        """An attribute as a whole number; raises SspError for anything else."""
        number = self.number(attribute, None if default is None else float(default))
        if not number.is_integer() or abs(number) > 2**53:
            self.fail(
                f'<{self.tag}> has {attribute}="{self.get(attribute)}", which is no whole number'
            )
        return int(number)

    def flag(self, attribute: str, default: bool = False) -> bool:
        """An attribute as true or false; raises SspError for anything else."""
        text = self.get(attribute, str(default).lower()).strip()
        if text not in ("true", "false", "1", "0"):
            self.fail(f'<{self.tag}> has {attribute}="{text}", which is neither true nor false')
        return text in ("true", "1")

    def __iter__(self) -> Iterator[Node]:
        return (Node(child, self.file) for child in self.element)

    def find(self, *path: str) -> Node | None:
        """The first descendant along the path of names, whatever their namespaces."""
        return next(iter(self.all(*path)), None)

    def all(self, *path: str) -> list[Node]:
        """The descendants along the path of names, whatever their namespaces."""
        found = [self]
        for name in path:
            found = [child for node in found for child in node if child.tag == name]
        return found

    def fail(self, problem: str) -> NoReturn:
        raise SspError(f"'{self.file}': {problem}")


def parse(data: bytes, file: str, root: str) -> Node:
    """The document's root, which is to be called `root`; raises SspError or ArchiveError."""
    node = Node(parse_xml(data, f"there is a file '{file}'"), file)
    check(node, root)
    return node


def check(node: Node, root: str, inherited: str = "") -> None:
    """Raise SspError unless the element is called `root` and is of a version that is known.

    inherited: the version of the file that an element without one stands in.
    """
    if node.tag != root:
        node.fail(f"it begins with <{node.tag}>, not with <{root}>")
    version = node.get("version", inherited)
    if version.partition(".")[0] not in ("1", "2"):
        node.fail(f"<{root}> is of version '{version}' of SSP; 1.0 and 2.0 can be read")


def new_document(tag: str, version: str, name: str) -> Element:
    """The root of a document to write, such as "ssv:ParameterSet"."""
    return Element(tag, version=version, name=name, generationTool="tracktrain")


def text_of(root: Element) -> bytes:
    """The document, with the prefixes that the standard uses: some readers know no others."""
    used = {tag.partition(":")[0] for node in root.iter() if ":" in (tag := node.tag)}
    for prefix in sorted(used):
        root.set(f"xmlns:{prefix}", NAMESPACES[prefix])
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
