"""Builds the documentation as a site that needs no network: `python docs/site/build.py`.

The pages are the Markdown files of the repository, brought together with links that lead from one
to the other, and a reference made from docstrings and `--help`. Needs the extra `docs`.
"""

from __future__ import annotations

import argparse
import posixpath
import re
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path

import click
from sphinx.cmd.build import build_main

from tracktrain.cli.group import Listed
from tracktrain.cli.main import main as main_command

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
CONTENTS = tomllib.loads((HERE / "contents.toml").read_text(encoding="utf-8"))
LINK = re.compile(r"\]\(([^)\s#:]+)(#[^)]*)?\)")
"""A link within the repository: no scheme has a place in its path."""

FIRST = "README.md"
WIDTH = 96
"""Characters of a line of help."""


def main() -> None:
    """Build the site."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=_Formatter)
    parser.add_argument("--out", type=Path, default=ROOT / "site", help="folder of the site")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder)
        for place, text in pages().items():
            (source / place).parent.mkdir(parents=True, exist_ok=True)
            (source / place).write_text(text, encoding="utf-8")
        for place, path in attached().items():
            (source / place).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, source / place)
        shutil.copy(HERE / "conf.py", source)
        shutil.copytree(HERE / "static", source / "static")
        failed = build_main(["-q", "-W", "--keep-going", "-b", "html", folder, str(out)])
    if failed:
        sys.exit("the site has errors: see above")
    print(f"The site is {out / 'index.html'}")


def pages() -> Mapping[str, str]:
    """The text of each page by its place, the contents behind the first one."""
    texts = _texts()
    found = {_place(path): _linked(path, text) for path, text in texts.items()}
    for path in _led_to(texts):
        found[_place(path)] = _shown(path)
    found["reference/commands.md"] = "\n".join(
        ["# Command line\n", *_helps(main_command, ["tracktrain"])]
    )
    for package in ("orchestrator", *CONTENTS["offered"]):
        found[f"reference/{package}.md"] = _reference(package)
    found["reference/gallery.md"] = _gallery(texts)
    found["index.md"] += _chapters()
    decisions = _place("docs/maintainers/decisions/README.md")
    found[decisions] += _tree("", sorted(p for p in found if re.search(r"decisions/\d", p)), "/")
    return found


def attached() -> Mapping[str, Path]:
    """Pictures by their place."""
    pictures = [*(ROOT / "docs").rglob("*.png"), *(ROOT / "docs").rglob("*.svg")]
    return {_place(p.relative_to(ROOT).as_posix()): p for p in pictures}


class _Formatter(argparse.RawDescriptionHelpFormatter, argparse.ArgumentDefaultsHelpFormatter):
    """Help with its paragraphs and the usual values."""


def _texts() -> dict[str, str]:
    """The Markdown files of the repository that are pages."""
    listed = [p for chapter in CONTENTS["chapters"].values() for p in chapter if p.endswith(".md")]
    decisions = (ROOT / "docs/maintainers/decisions").glob("*.md")
    paths = [FIRST, *listed, *(p.relative_to(ROOT).as_posix() for p in decisions)]
    return {path: (ROOT / path).read_text(encoding="utf-8") for path in paths}


def _place(path: str) -> str:
    """Where a file of the repository is among the pages."""
    if path == FIRST:
        return "index.md"
    block = re.fullmatch(r"fmus/(\w+)/README\.md", path)
    if block:
        return f"blocks/{block[1]}.md"
    place = path.removeprefix("docs/")
    return place if place.endswith((".md", ".png", ".svg")) else f"files/{place}.md"


def _target(source: str, link: str) -> str:
    """What a link of a text leads to, as a path in the repository."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(source), link))


def _linked(source: str, text: str) -> str:
    """A text whose links lead to pages; raises SystemExit for one that leads nowhere."""
    here = posixpath.dirname(_place(source))

    def led(found: re.Match[str]) -> str:
        target = _target(source, found[1])
        if not (ROOT / target).is_file():
            sys.exit(f"{source} leads to '{found[1]}', which is no file")
        return f"]({posixpath.relpath(_place(target), here or '.')}{found[2] or ''})"

    return LINK.sub(led, text)


def _led_to(texts: Mapping[str, str]) -> list[str]:
    """Files that are no pages of their own, and that a page leads to."""
    found = {_target(s, m[1]) for s, text in texts.items() for m in LINK.finditer(text)}
    return sorted(p for p in found - texts.keys() if not p.endswith((".png", ".svg")))


def _shown(path: str) -> str:
    """A page with a file of the repository."""
    text = (ROOT / path).read_text(encoding="utf-8")
    marks = "---\norphan: true\n---\n\n"
    if path.endswith(".md"):
        return marks + text
    return f"{marks}# {path}\n\n````{path.rpartition('.')[2]}\n{text}````\n"


def _reference(package: str) -> str:
    """A page with the docstrings of what a package offers."""
    offered = CONTENTS["offered"].get(package)
    if offered is None:
        stub = (ROOT / package / "__init__.pyi").read_text(encoding="utf-8")
        names = sorted(re.findall(r'^    "(\w+)",$', stub, re.MULTILINE), key=str.lower)
        entries = [
            f".. autoclass:: {package}.{n}"
            if n[0].isupper()
            else f".. autofunction:: {package}.{n}"
            for n in names
        ]
    else:
        entries = [
            f".. automodule:: {name}"
            if (ROOT / name.replace(".", "/")).is_dir()
            or (ROOT / f"{name.replace('.', '/')}.py").is_file()
            else f".. autofunction:: {name}"
            for name in offered
        ]
    listed = "\n\n".join(entries)
    return f"# {package}\n\n```{{eval-rst}}\n{listed}\n```\n"


def _helps(command: click.Command, names: list[str]) -> Iterator[str]:
    """What `--help` says of a command, and of those below it; names: what is typed."""
    parent = None
    for name in names[:-1]:
        parent = click.Context(command, parent, info_name=name)
    context = click.Context(command, parent, info_name=names[-1], terminal_width=WIDTH)
    heading = f"{'#' * (len(names) + 1)} {' '.join(names)}"
    yield f"{heading}\n\n```text\n{command.get_help(context)}\n```\n"
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            if isinstance(below, Listed):
                below = import_module(below.module).command
            if below is not None:
                yield from _helps(below, [*names, name])


def _gallery(texts: Mapping[str, str]) -> str:
    """A page with every picture, its caption, and the page that tells about it."""
    shown: dict[str, tuple[str, str, str]] = {}
    for source, text in texts.items():
        title = text.partition("\n")[0].lstrip("# ")
        for caption, link in re.findall(r"!\[([^\]]*)\]\(([^)]+)\)", text):
            shown.setdefault(_target(source, link), (" ".join(caption.split()), source, title))
    parts = [
        f"## {caption}\n\n[![{caption}](../{_place(picture)})](../{_place(source)})\n\n"
        f"From [{title}](../{_place(source)})."
        for picture, (caption, source, title) in shown.items()
    ]
    made = "Each is made by a script of the repository, most by `python docs/make_pictures.py`."
    return "\n\n".join(["# Gallery", made, *parts]) + "\n"


def _chapters() -> str:
    """The contents of the site."""
    return "".join(
        _tree(title, [_place(p) if p.endswith(".md") else f"reference/{p}.md" for p in chapter])
        for title, chapter in CONTENTS["chapters"].items()
    )


def _tree(title: str, places: list[str], absolute: str = "") -> str:
    caption = f":caption: {title}\n" if title else ""
    listed = "\n".join(f"{absolute}{p.removesuffix('.md')}" for p in places)
    return f"\n```{{toctree}}\n:hidden:\n:maxdepth: 1\n{caption}\n{listed}\n```\n"


if __name__ == "__main__":
    main()
