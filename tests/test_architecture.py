"""What the tree promises about itself."""

from __future__ import annotations

import ast
import tomllib
from fnmatch import fnmatch

import pytest

import fmus
import orchestrator
from support.source_tree import PACKAGES, ROOT, circle, of, sources

FLOORS = (
    {"errors", "naming", "notes", "options", "interrupts", "compiled", "summary", "files"},
    {"fmu"},
    {"system"},
    {"ssp", "plan"},
    {"slaves"},
    {"masters"},
    {"run", "results", "trust"},
    {"whole"},
)
"""Rooms of the orchestrator: each knows those of its own floor and of the floors below."""

DOORS = {
    "fmus/catalogue.py": "FMUs that are built already are found without what builds them",
    "orchestrator/masters/*.py": "masters are named in a help text; their loops are compiled",
    "orchestrator/results/run.py": "xarray loads when a dataset is asked for",
    "orchestrator/slaves/loading.py": "what stands before FMUs of other types is compiled",
    "fmus/carbody/modes.py": "FMUs are built without SciPy, and their known results made with it",
    "fmus/describe/units.py": "pint reads its registry of units",
    "orchestrator/fmu/units.py": "pint reads its registry of units",
    "orchestrator/system/system.py": "matplotlib loads when a picture is asked for",
    "tracktrain/__main__.py": "Ctrl-C has its meaning before anything is loaded",
    "tracktrain/assessment/__init__.py": "pandas loads for the table, which a page does without",
    "tracktrain/car/carbody.py": "to build a carbody takes CasADi and a compiler",
    "tracktrain/car/hopper.py": "names of cars stand in a help text",
    "tracktrain/cli/*": "a command loads what it needs when it runs, not when it shows its help",
    "tracktrain/correlation/files.py": "packages that read other formats are extras",
    "tracktrain/options/*": "what was typed is read without what uses it",
    "tracktrain/report/system.py": "matplotlib loads for the diagram of a system that is no car",
    "tracktrain/studies/uncertainty/design.py": "SALib is an extra",
    "tracktrain/sweep/*": "a sweep's processes and tables load when there is a sweep",
}
"""Files that may import inside a function, and why they do not at the top."""

PARAMETERS = 8
LINES = 80
FILE = 450
COMPILED = {"in_c", "in_any_order", "macro_loop", "c_function"}
"""Decorators of compiled code, which is not called by people and has no objects to take."""


@pytest.mark.parametrize(
    ("package", "stranger"),
    [
        ("orchestrator", "fmus"),
        ("orchestrator", "tracktrain"),
        ("fmus", "orchestrator"),
        ("fmus", "tracktrain"),
        ("fmus", "structures"),
        ("orchestrator", "structures"),
        ("structures", "orchestrator"),
        ("structures", "tracktrain"),
    ],
)
def test_the_parts_do_not_know_each_other(package, stranger):
    known = {i.module.split(".")[0] for source in of(package) for i in source.imports()}
    assert stranger not in known


@pytest.mark.parametrize("package", PACKAGES)
def test_no_files_import_each_other_in_a_circle(package):
    assert circle(package) == []


def test_no_room_of_the_orchestrator_imports_from_a_floor_above():
    floor = {room: n for n, rooms in enumerate(FLOORS) for room in rooms}
    assert floor.keys() | {"built"} >= {
        p.stem for p in (ROOT / "orchestrator").glob("[a-z]*") if p.suffix in ("", ".py")
    }
    upward = [
        f"{source.place}:{i.line} imports {i.module}"
        for source in of("orchestrator")
        for i in source.imports()
        if "." in source.module
        and i.module.startswith("orchestrator.")
        and floor[i.module.split(".")[1]] > floor[source.module.split(".")[1]]
    ]
    assert upward == []


def test_tracktrain_imports_the_orchestrator_by_its_public_names():
    private = [
        f"{source.place}:{i.line} imports {i.name or '*'} of {i.module}"
        for source in of("tracktrain")
        for i in source.imports()
        if i.module.split(".")[0] == "orchestrator"
        and not (i.module == "orchestrator" and i.name in {"", *orchestrator.__all__})
    ]
    assert private == []


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_stand_at_the_top_of_a_file_but_where_a_door_is_lazy(package):
    hidden = [
        f"{source.place}:{i.line} imports {i.module}"
        for source in of(package)
        for i in source.imports()
        if i.hidden and not any(fnmatch(source.place, door) for door in DOORS)
    ]
    assert hidden == []


def test_every_door_is_used():
    lazy = {s.place for s in sources().values() if any(i.hidden for i in s.imports())}
    assert [door for door in DOORS if not any(fnmatch(place, door) for place in lazy)] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_functions_fit_a_screen_and_take_few_parameters(package):
    def too_much(function: ast.FunctionDef) -> bool:
        names = {
            n.id for d in function.decorator_list for n in ast.walk(d) if isinstance(n, ast.Name)
        }
        of_function = function.args
        taken = [*of_function.posonlyargs, *of_function.args, *of_function.kwonlyargs]
        count = len([a for a in taken if a.arg not in ("self", "cls")])
        lines = (function.end_lineno or 0) - function.lineno + 1
        return not names & COMPILED and (lines > LINES or count > PARAMETERS)

    found = [
        f"{source.place}:{function.lineno} {function.name}"
        for source in of(package)
        for function in source.functions()
        if too_much(function)
    ]
    assert found == []


@pytest.mark.parametrize("package", PACKAGES)
def test_python_files_stay_short(package):
    long = {
        source.place: count
        for source in of(package)
        if (count := len(source.path.read_text().splitlines())) > FILE
    }
    assert long == {}


def test_each_blocks_folder_has_the_same_shape():
    shape = {"__init__.py", "block.py", "experiment.py", "README.md", "reference"}
    shape |= {f"{drawing}.{kind}" for drawing in ("icon", "diagram") for kind in ("svg", "png")}
    for name in fmus.BLOCKS:
        assert shape <= {path.name for path in (ROOT / "fmus" / name).iterdir()}


def test_the_licence_in_the_fmus_is_the_projects():
    assert (ROOT / "fmus/export/license.txt").read_text() == (ROOT / "LICENSE").read_text()


def test_the_version_is_one():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = (ROOT / "CITATION.cff").read_text()
    assert f"version: {project['version']}\n" in citation
    assert f"## {project['version']}" in (ROOT / "CHANGELOG.md").read_text()
