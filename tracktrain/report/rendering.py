"""Pages out of their templates, styles and scripts, which stand in the folder `page`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader
from markupsafe import Markup, escape


def rendered(template: str, scripts: Sequence[str], **values: Any) -> str:
    """The text of a page. scripts: files, in the order in which they need each other."""
    return (
        _templates()
        .get_template(template)
        .render(styles=page_text("page.css"), script="\n".join(map(page_text, scripts)), **values)
    )


@cache
def _templates() -> Environment:
    loader = PackageLoader(__package__, "page")
    found = Environment(loader=loader, autoescape=True, trim_blocks=True)
    found.filters["marked"] = _marked
    return found


def _marked(text: str) -> Markup:
    """Text whose `commands` and names are set as code."""
    return Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def page_text(name: str) -> str:
    return (files(__package__) / "page" / name).read_text(encoding="utf-8")
