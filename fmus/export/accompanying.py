"""What comes with a block in any FMU of it: documentation, terminals, reference results."""

from __future__ import annotations

from pathlib import Path

from ..describe.variables import Values
from .documentation import documentation
from .product import Product
from .xml.references import references
from .xml.terminals import terminals_and_icons

HERE = Path(__file__).parent


def accompanying_files(product: Product, start: Values, description: str) -> dict[str, bytes]:
    """The files by their place in the archive.

    start: parameter values [SI]. description: text of modelDescription.xml.
    """
    block, parameters = product.block, product.parameters
    texts = {
        "documentation/index.html": documentation(
            block, parameters, start, description=description
        ),
        "documentation/licenses/license.txt": licence(),
        "terminalsAndIcons/terminalsAndIcons.xml": terminals_and_icons(block),
    }
    copies = {}
    own = HERE.parent / block.folder
    for suffix in (".png", ".svg"):  # docs/draw.py makes the first of the second
        copies[f"documentation/diagram{suffix}"] = own / f"diagram{suffix}"
        copies[f"terminalsAndIcons/icon{suffix}"] = own / f"icon{suffix}"
        for terminal in block.terminals:
            icon = terminal.joint.name + suffix
            copies[f"terminalsAndIcons/{icon}"] = HERE / "icons" / icon
    return {
        **{place: text.encode() for place, text in texts.items()},
        **{place: file.read_bytes() for place, file in copies.items()},
        **references(product.reference),
        **product.further,
    }


def licence() -> str:
    """Text of the licence of all that is ours in an FMU."""
    return (HERE / "license.txt").read_text()
