"""buildDescription.xml: how an importer compiles an FMU's sources.

The file is FMI 3.0's; FMI 2.0 (from 2.0.5) takes it as it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ..compiler import LANGUAGE
from . import document


def build_description(identifier: str, files: Iterable[str]) -> str:
    """XML text of buildDescription.xml. files: the folder sources, of which .c are compiled."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    sources = SubElement(configuration, "SourceFileSet", language=LANGUAGE)
    for name in sorted(name for name in files if name.endswith(".c")):
        SubElement(sources, "SourceFile", name=name)
    SubElement(configuration, "Library", name="m", external="true", description="Mathematics of C")
    return document(root)
