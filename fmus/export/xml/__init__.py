"""The XML files of an FMU."""

from __future__ import annotations

from xml.etree import ElementTree
from xml.etree.ElementTree import Element


def document(root: Element) -> str:
    """The element as the text of an XML file, indented."""
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"
