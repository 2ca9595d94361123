"""Parameter maps (.ssm): what is read of them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator import Linear, OrchestratorError, Table
from orchestrator.ssp import MapEntry, read_mapping

HEAD = (
    '<ssm:ParameterMapping version="{version}" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">{body}</ssm:ParameterMapping>'
)


def mapping(folder: Path, body: str, version: str = "1.0", before: str = "") -> Path:
    path = folder / "names.ssm"
    path.write_text(before + HEAD.format(version=version, body=body))
    return path


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_entries_carry_names_and_transformations(tmp_path, version):
    path = mapping(
        tmp_path,
        """<ssm:MappingEntry source="a" target="b"/>
        <ssm:MappingEntry source="mass" target="m" suppressUnitConversion="true">
          <ssc:LinearTransformation factor="1e3" offset="-2"/></ssm:MappingEntry>
        <ssm:MappingEntry source="on" target="off"><ssc:BooleanMappingTransformation>
          <ssc:MapEntry source="true" target="false"/><ssc:MapEntry source="0" target="1"/>
        </ssc:BooleanMappingTransformation></ssm:MappingEntry>
        <ssm:MappingEntry source="n" target="k"><ssc:IntegerMappingTransformation>
          <ssc:MapEntry source="-1" target="7"/></ssc:IntegerMappingTransformation>
        </ssm:MappingEntry>
        <ssm:MappingEntry source="law" target="kind"><ssc:EnumerationMappingTransformation>
          <ssc:MapEntry source="Kalker" target="linear"/></ssc:EnumerationMappingTransformation>
        </ssm:MappingEntry>""",
        version,
    )
    assert read_mapping(path) == (
        MapEntry("a", "b"),
        MapEntry("mass", "m", Linear(1e3, -2.0), suppress_unit_conversion=True),
        MapEntry("on", "off", Table("Boolean", ((True, False), (False, True)))),
        MapEntry("n", "k", Table("Integer", ((-1, 7),))),
        MapEntry("law", "kind", Table("Enumeration", (("Kalker", "linear"),))),
    )


def test_file_without_a_namespace_is_read_by_its_names(tmp_path):
    path = tmp_path / "bare.ssm"
    path.write_text(
        '<ParameterMapping version="1.0"><MappingEntry source="a" target="b"/></ParameterMapping>'
    )
    assert read_mapping(path) == (MapEntry("a", "b"),)


LINE = '<ssc:LinearTransformation factor="{}"/>'
ENTRY = '<ssm:MappingEntry source="a" target="b">{}</ssm:MappingEntry>'


@pytest.mark.parametrize(
    ("body", "problem"),
    [
        ('<ssm:MappingEntry source="a"/>', "<MappingEntry> lacks the attribute 'target'"),
        (ENTRY.format(LINE.format("two")), 'has factor="two", which is no number'),
        (ENTRY.format(2 * LINE.format("2")), "<MappingEntry> has 2 transformations"),
        (ENTRY.format("<ssc:CubicTransformation/>"), "which SSP does not know"),
        (
            '<ssm:MappingEntry source="a" target="b" suppressUnitConversion="yes"/>',
            'suppressUnitConversion="yes", which is neither true nor false',
        ),
        (
            ENTRY.format(
                "<ssc:IntegerMappingTransformation>"
                '<ssc:MapEntry source="1.5" target="2"/></ssc:IntegerMappingTransformation>'
            ),
            "sends '1.5' to '2': both must be whole numbers",
        ),
        (
            ENTRY.format(
                "<ssc:BooleanMappingTransformation>"
                + 2 * '<ssc:MapEntry source="1" target="true"/>'
                + "</ssc:BooleanMappingTransformation>"
            ),
            "has two entries for the same source",
        ),
        ("<ssm:MappingEntry", "that cannot be read: not well-formed"),
    ],
)
def test_wrong_map_is_refused_by_file_and_element(tmp_path, body, problem):
    path = mapping(tmp_path, body)
    with pytest.raises(OrchestratorError) as caught:
        read_mapping(path)
    assert str(path) in str(caught.value)
    assert problem in str(caught.value)


def test_other_files_are_refused(tmp_path):
    with pytest.raises(OrchestratorError, match="cannot be read: no such file or directory"):
        read_mapping(tmp_path / "nowhere.ssm")
    with pytest.raises(OrchestratorError, match=r"version '3\.0' of SSP; 1\.0 and 2\.0 can"):
        read_mapping(mapping(tmp_path, "", "3.0"))
    other = tmp_path / "other.xml"
    other.write_text("<ParameterSet version='1.0'/>")
    with pytest.raises(OrchestratorError, match="begins with <ParameterSet>, not with <Parameter"):
        read_mapping(other)


def test_entities_are_not_expanded(tmp_path):
    bomb = '<!DOCTYPE b [<!ENTITY a "aaaaaaaaaa"><!ENTITY c "&a;&a;&a;&a;&a;&a;&a;">]>'
    path = mapping(tmp_path, ENTRY.format("&c;"), before=bomb)
    with pytest.raises(OrchestratorError, match="declares a document type"):
        read_mapping(path)
