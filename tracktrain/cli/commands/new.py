"""The command `tracktrain new`: it starts a model of one's own."""

from __future__ import annotations

import importlib.util
import keyword
import shutil
from importlib.resources import files
from pathlib import Path

import click

from fmus.names import CAR
from orchestrator import UnwrittenError, whole_file

from ...car.hopper import HOPPER
from ...errors import TracktrainError
from ...options.out import out_option
from ...options.types import Name
from ...terminal import writable

PLACEHOLDER = "my_model"


@click.command(
    epilog="""\b
Examples:
  tracktrain new wheelrail my_creep
  tracktrain new truck my_truck --out models"""
)
@click.argument("block", type=Name("block", CAR))
@click.argument("name")
@out_option("Folder to make the project's folder in.  [default: here]", "")
def command(block: str, name: str, out: Path) -> None:
    """Start a model of your own in the place of a BLOCK: a folder NAME with plain Python.

    It runs as it is. Its README tells how it becomes an FMU and how the car runs with it.
    """
    project = write_project(block, name, writable(out))
    for path in sorted(project.iterdir()):
        click.echo(path)
    click.echo(
        f"\nnext: tracktrain fmu pack {project}, then "
        f"tracktrain run --swap {_instance(block)}={name}.fmu --step 0.5ms"
    )


def write_project(block: str, name: str, out: Path) -> Path:
    """Write the folder of a new model and return it; raises TracktrainError for a bad name."""
    _check_name(name)
    project = out / name
    if project.exists():
        raise TracktrainError(f"'{project}' exists already; choose another name or another --out")
    templates = files("tracktrain") / "templates"
    texts = {
        "README.md": templates / "README.md",
        f"{name}.py": templates / block / f"{PLACEHOLDER}.py",
        f"test_{name}.py": templates / block / f"test_{PLACEHOLDER}.py",
    }
    replacements = {
        PLACEHOLDER: name,
        "MyModel": "".join(part[:1].upper() + part[1:] for part in name.split("_")),
        "BLOCK": block,
        "INSTANCE": _instance(block),
    }
    try:
        for file, template in texts.items():
            text = template.read_text(encoding="utf-8")
            for old, new_text in replacements.items():
                text = text.replace(old, new_text)
            with whole_file(project / file) as new:
                new.write_text(text, encoding="utf-8")
    except UnwrittenError:
        shutil.rmtree(project, ignore_errors=True)  # half a project is none
        raise
    return project


def _check_name(name: str) -> None:
    example = "write a name such as my_creep: small letters, digits and underscores"
    if not name.isidentifier() or not name.isascii() or keyword.iskeyword(name):
        raise TracktrainError(f"'{name}' is no name of a Python module; {example}")
    if name != name.lower() or not name[0].isalpha() or name.startswith("test_"):
        raise TracktrainError(f"a model cannot be called '{name}'; {example}")
    if importlib.util.find_spec(name) is not None:
        raise TracktrainError(
            f"there is a Python module '{name}' already, which would hide the model; {example}"
        )


def _instance(block: str) -> str:
    """The first instance of the car that is such a block."""
    return HOPPER.instances(block)[0]
