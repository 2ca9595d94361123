"""Pages out of their templates, styles and scripts, which stand in the folder `page`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader


def rendered(template: str, scripts: Sequence[str], **values: Any) -> str:
    """The text of a page. scripts: files, in the order in which they need each other."""
    return (
        _templates()
        .get_template(template)
        .render(styles=page_text("page.css"), script="\n".join(map(page_text, scripts)), **values)
    )


@cache
def _templates() -> Environment:
    return Environment(loader=PackageLoader(__package__, "page"), autoescape=True, trim_blocks=True)


def page_text(name: str) -> str:
    return (files(__package__) / "page" / name).read_text(encoding="utf-8")
