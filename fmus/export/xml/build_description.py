"""buildDescription.xml: how an importer compiles an FMU's sources.

The file is FMI 3.0's; FMI 2.0 (from 2.0.5) takes it as it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ..compiler import LANGUAGE
from . import document


def build_description(identifier: str, units: Iterable[str], options: str = "") -> str:
    """XML text of buildDescription.xml. units: the C files to compile. options: of the compiler."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    more = {"compilerOptions": options} if options else {}
    sources = SubElement(configuration, "SourceFileSet", {"language": LANGUAGE, **more})
    for name in sorted(units):
        SubElement(sources, "SourceFile", name=name)
    SubElement(configuration, "Library", name="m", external="true", description="Mathematics of C")
    return document(root)
