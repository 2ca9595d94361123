"""What is in an FMU file, as importers and checkers see it."""

from __future__ import annotations

import posixpath
import re
import zipfile

import pytest
from fmpy import read_model_description

from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.units import base_exponents
from fmus.export.code import generated_functions
from support.archive_checks import findings
from support.functions import FUNCTIONS


def test_checkers_find_nothing(block_name, fmi):
    assert findings(fmu_path(block_name, fmi)) == []


def test_every_function_of_the_standard_is_exported(instantiate, block_name, fmi):
    library = instantiate(block_name).slave.dll
    missing = [name for name in FUNCTIONS[fmi] if not hasattr(library, name)]
    assert missing == []


def test_archive_holds_documentation_licence_and_sources(block_name, fmi):
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        names = set(archive.namelist())
        assert all(info.compress_type == zipfile.ZIP_DEFLATED for info in archive.infolist())
        page = archive.read("documentation/index.html").decode()
    assert {"documentation/licenses/license.txt", "sources/core.c"} <= names
    versions = {name for name in names if name.startswith("sources/fmi")}
    assert versions and all(name.startswith(f"sources/fmi{fmi[0]}") for name in versions)
    description = read_model_description(str(fmu_path(block_name, fmi)))
    own = ("time", "event_indicator")  # FMI's, not the block's
    names = {re.sub(r"^der\((.*)\)$", r"\1", v.name) for v in description.modelVariables}
    assert not [name for name in names - {*own} if name not in page]


def test_the_page_leads_only_to_what_is_there(block_name, fmi):
    """Pictures, licence, reference results, its own headings, and no file beside a README."""
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        names = set(archive.namelist())
        page = archive.read("documentation/index.html").decode()
    targets = re.findall(r'(?:href|src)="([^"]+)"', page)
    assert {"diagram.png", "licenses/license.txt", "fmi-ls-ref.txt"} <= set(targets)
    for target in targets:
        if target.startswith("#"):
            assert f'id="{target[1:]}"' in page, target
        elif not target.startswith("http"):
            assert posixpath.normpath(f"documentation/{target}") in names, target
    assert re.findall(r"<code>(\.\./[^<]*|range\.toml)</code>", page) == []


def test_every_variable_has_a_description_and_every_real_a_unit(block_name, fmi):
    for variable in read_model_description(str(fmu_path(block_name, fmi))).modelVariables:
        assert variable.description
        if variable.type in ("Real", "Float64") and not variable.dimensions:
            assert variable.unit


def test_every_input_and_parameter_has_a_start_value(block_name, fmi):
    for variable in read_model_description(str(fmu_path(block_name, fmi))).modelVariables:
        settable = variable.causality in ("input", "parameter")
        assert (variable.start is not None) == settable, variable.name


def test_unit_exponents_follow_from_the_units_name():
    assert base_exponents("N.m/rad") == {"kg": 1, "m": 2, "rad": -1, "s": -2}
    assert base_exponents("m/s2") == {"m": 1, "s": -2}
    assert base_exponents("1") == {}


def test_a_unit_that_is_not_si_is_refused():
    with pytest.raises(ValueError, match="'lbf' is not SI"):
        base_exponents("lbf")


def test_generated_functions_are_small_enough_to_read(block_name):
    """A micro step that suddenly grows tenfold has lost its sparsity or its shared terms."""
    block = BLOCKS[block_name]()
    functions, size = generated_functions(block), max(1, len(block.memory) / 6)  # in elements
    beyond = functions.pop("step_beyond", None)  # with the roots of every contact in each stage
    assert beyond is None or beyond.n_instructions() < 10_000 * size
    assert all(f.n_instructions() < 6000 * size for f in functions.values())
