"""How Sphinx shows the pages that `build.py` has put together."""

from __future__ import annotations

import ast
import re
from importlib import metadata
from typing import Any

project = "tracktrain"
author = "the tracktrain authors"
release = metadata.version("tracktrain")
html_title = f"tracktrain {release}"
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_default_options = {"members": True, "exclude-members": "count, index"}
suppress_warnings = ["misc.highlighting_failure"]


def setup(app: Any) -> None:
    """Have docstrings, which are plain text, read as such."""
    app.connect("autodoc-process-docstring", _marked)


def _marked(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Mark what is code in a docstring, and have the rest stand as it is."""
    paragraphs = re.split(r"\n{2,}", "\n".join(lines).strip())
    lines[:] = "\n\n".join(map(_paragraph, paragraphs)).split("\n")


def _paragraph(text: str) -> str:
    if _is_code(text):
        return "::\n\n" + "\n".join(f"    {line}" for line in text.split("\n"))
    parts = re.split(r"(`[^`]+`)", text)
    return "".join(f"`{p}`" if p.startswith("`") else _plain(p) for p in parts)


def _is_code(text: str) -> bool:
    try:
        ast.parse(text)
    except SyntaxError:
        return False
    return bool(re.search(r"[=(\[]", text))


def _plain(text: str) -> str:
    return re.sub(r"([*|\\])|(?<=\w)_(?=\W|$)", r"\\\g<0>", text)
