"""`tracktrain fmu info`: what any FMU says of itself, and files that are no FMU."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import fmpy
import pytest
from click.testing import CliRunner

from fmus.catalogue import fmu_path
from support.variants import variant
from tracktrain.cli.main import main

FMI_1 = """<fmiModelDescription fmiVersion="1.0" modelName="old" modelIdentifier="old" guid="g"
 numberOfContinuousStates="1" numberOfEventIndicators="0" generationTool="Old Tool 4">
<UnitDefinitions/>
<ModelVariables>
<ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
<ScalarVariable name="v" valueReference="2" causality="input"><Real unit="km/h"/></ScalarVariable>
<ScalarVariable name="y" valueReference="3" causality="output"><Real unit="m"/>
<DirectDependency><Name>u</Name></DirectDependency></ScalarVariable>
<ScalarVariable name="z" valueReference="4" causality="output"><Real unit="m"/></ScalarVariable>
<ScalarVariable name="mass" valueReference="5" variability="parameter">
<Real unit="kg" start="1.5"/></ScalarVariable>
</ModelVariables>
</fmiModelDescription>"""

STANDALONE = """<Implementation><CoSimulation_StandAlone><Capabilities
 canHandleVariableCommunicationStepSize="true" canInterpolateInputs="true"
 canBeInstantiatedOnlyOncePerProcess="true"/></CoSimulation_StandAlone></Implementation>"""

FMI_3 = """<fmiModelDescription fmiVersion="3.0" modelName="new" instantiationToken="t"
 author="A. Author" copyright="(c) nobody" license="CC0" version="7"
 generationDateAndTime="2024-02-29T12:00:00Z">
<ModelExchange modelIdentifier="new"/>
<CoSimulation modelIdentifier="new" providesDirectionalDerivatives="true"
 canGetAndSetFMUState="true" needsExecutionTool="true"/>
<UnitDefinitions>
<Unit name="span"><BaseUnit m="1" factor="0.2286"/></Unit><Unit name="quux"/>
</UnitDefinitions>
<ModelVariables>
<Float64 name="y" valueReference="1" causality="input" start="0 0 0" unit="span">
<Dimension start="3"/></Float64>
<Float64 name="force[m]" valueReference="2" causality="output" unit="N" description="[red] force"/>
<UInt8 name="mode" valueReference="3" causality="parameter" start="1"/>
<Float64 name="gauge" valueReference="4" causality="parameter" start="1.4350000000000001"
 unit="quux" min="1" max="2"/>
</ModelVariables>
<ModelStructure><Output valueReference="2" dependencies="1"/></ModelStructure>
</fmiModelDescription>"""


def archive(path: Path, description: str | None, *members: str) -> Path:
    with zipfile.ZipFile(path, "w") as file:
        for member in members:
            file.writestr(member, "")
        if description is not None:
            file.writestr("modelDescription.xml", description)
    return path


def info(path: Path, *options: str) -> str:
    result = CliRunner().invoke(main, ["fmu", "info", str(path), *options])
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def rows(printed: str) -> list[str]:
    """Lines with their columns one space apart."""
    return [" ".join(line.split()) for line in printed.splitlines()]


def refused(path: Path) -> str:
    result = CliRunner().invoke(main, ["fmu", "info", str(path)])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    return result.stderr.removeprefix("Error: ").strip()


def data(path: Path) -> dict[str, Any]:
    return json.loads(info(path, "--json"))


def test_our_truck_is_introduced_with_all_that_it_offers() -> None:
    said = rows(info(fmu_path("truck")))
    assert said[0] == "truck.fmu: FMI 2.0, co-simulation and model exchange"
    assert "made by tracktrain 0.1.0" in said
    assert "licence MIT" in said
    platforms = next(line for line in said if line.startswith("platforms "))
    assert platforms.endswith(", source code (runs on this machine)")
    assert "co-simulation offers directional derivatives, input derivatives, variable" in said
    assert "model exchange offers directional derivatives, saved state, serialised state" in said
    assert not any("without" in line for line in said)
    assert "experiment start 0, stop 8.0, step 0.001, tolerance 1e-08" in said
    assert "inputs (40)" in said
    assert "outputs (51)" in said
    assert any(line.startswith("axle[1].vy m/s axle[1].y no input Lateral") for line in said)


@pytest.mark.parametrize("block", ["carbody", "truck", "wheelrail", "track"])
def test_every_block_fits_into_eighty_columns(block: str) -> None:
    printed = info(fmu_path(block), "--parameters")
    assert max(len(line) for line in printed.splitlines()) <= 80
    assert "…" not in printed


def test_parameters_are_counted_and_listed_on_request() -> None:
    assert "parameters 13" in rows(info(fmu_path("track")))
    assert not any("report_rms" in line for line in rows(info(fmu_path("track"))))
    said = rows(info(fmu_path("track"), "--parameters"))
    assert "parameters (13)" in said
    assert "wavelength_min m 3 0.5 to 2000 Shortest wave of" in said
    assert any(line.startswith("spectrum (Enumeration) report report, fra1,") for line in said)


def test_model_exchange_of_fmi_1_is_read(tmp_path: Path) -> None:
    said = rows(info(archive(tmp_path / "old.fmu", FMI_1), "--parameters"))
    assert said[0] == "old.fmu: FMI 1.0, model exchange"
    assert "made by Old Tool 4" in said
    assert "author not said" in said
    assert f"platforms none ({fmpy.platform} is needed)" in said
    assert "units kg, km/h (0.2777777778 in SI), m" in said
    assert "u 0" in said
    assert "v km/h" in said
    assert "y m 1 of 2 inputs" in said
    assert "z m not said" in said
    assert "mass kg 1.5" in said


def test_co_simulation_of_fmi_1_is_read(tmp_path: Path) -> None:
    text = FMI_1.replace("</ModelVariables>", "</ModelVariables>" + STANDALONE)
    path = archive(tmp_path / "old.fmu", text, "binaries/amiga32/old.lib")
    said = rows(info(path))
    assert said[0] == "old.fmu: FMI 1.0, co-simulation"
    assert f"platforms amiga32 (none for this machine, {fmpy.platform})" in said
    assert "co-simulation offers input derivatives, variable step" in said
    assert "without directional derivatives, saved state, serialised state" in said
    assert "demands one instance in a process" in said


def test_fmi_3_is_read_with_arrays_and_units_of_its_own(tmp_path: Path) -> None:
    said = rows(info(archive(tmp_path / "new.fmu", FMI_3), "--parameters"))
    assert said[0] == "new.fmu: FMI 3.0, co-simulation and model exchange"
    assert "model new 7" in said
    assert "made by 2024-02-29T12:00:00Z" in said
    assert "author A. Author" in said
    assert "copyright (c) nobody" in said
    assert "licence CC0" in said
    assert "co-simulation offers directional derivatives, saved state" in said
    assert "demands the tool that made it" in said
    assert "units N, quux (not known), span (0.2286 in SI)" in said
    assert "y (Float64[3]) span 0 0 0" in said
    assert "force[m] N all inputs [red] force" in said
    assert "mode (UInt8) 1" in said
    assert "gauge quux 1.435 1 to 2" in said


def test_fmu_without_ports_says_so(tmp_path: Path) -> None:
    text = FMI_3.partition("<ModelVariables>")[0] + "<ModelVariables/></fmiModelDescription>"
    said = rows(info(archive(tmp_path / "empty.fmu", text), "--parameters"))
    assert said[-5:] == ["no inputs", "", "no outputs", "", "no parameters"]


def test_json_says_what_the_file_says() -> None:
    path = fmu_path("wheelrail")
    said = data(path)
    assert said["file"] == str(path)
    assert said["fmi_version"] == "2.0"
    assert said["runs_here"] is True
    assert said["has_source"] is True
    assert said["provenance"]["generationTool"] == "tracktrain 0.1.0"
    assert said["interfaces"]["co-simulation"]["canInterpolateInputs"] == "true"
    assert said["default_experiment"] == {"start": "0", "stop": "8.0", "step": "0.001"}
    assert len(said["sha256"]) == 64
    force = next(v for v in said["variables"] if v["name"] == "force_y")
    assert (force["causality"], force["unit"], force["type"]) == ("output", "N", "Real")
    assert {"y", "vy", "speed"} <= set(force["dependencies"])
    assert said["units"]["N"]["dimension"] == {"[mass]": 1, "[length]": 1, "[time]": -2}


def test_json_has_null_for_what_the_file_does_not_say(tmp_path: Path) -> None:
    said = data(archive(tmp_path / "new.fmu", FMI_3.replace(' dependencies="1"', "")))
    assert said["units"]["quux"] is None
    assert said["units"]["span"]["factor"] == 0.2286
    assert said["provenance"]["generationTool"] is None
    y, force = said["variables"][:2]
    assert y["shape"] == [3]
    assert "dependencies" not in y
    assert force["dependencies"] is None


def test_file_that_is_no_fmu_is_refused_in_one_line(tmp_path: Path) -> None:
    missing, text = tmp_path / "missing.fmu", tmp_path / "text.fmu"
    text.write_text("an FMU")
    assert refused(missing) == f"the FMU '{missing}' cannot be read: no such file or directory"
    assert refused(tmp_path) == f"'{tmp_path}' is no FMU: it is a folder"
    assert refused(text) == f"'{text}' is no FMU: it is not a zip archive"
    empty = archive(tmp_path / "empty.fmu", None, "readme.txt")
    assert refused(empty) == f"'{empty}' is no FMU: it has no modelDescription.xml"


@pytest.mark.parametrize(
    ("description", "message"),
    [
        ("<fmiModelDescription", "has a modelDescription.xml that cannot be read: unclosed token"),
        (
            "<html/>",
            "has a wrong modelDescription.xml: it begins with 'html', not with "
            "'fmiModelDescription'",
        ),
        (
            '<fmiModelDescription fmiVersion="4.0"/>',
            "is an FMU of FMI 4.0; FMI 1.0, 2.0 and 3.0 can be read",
        ),
        ("<fmiModelDescription/>", "is an FMU of FMI ?; FMI 1.0, 2.0 and 3.0 can be read"),
        (
            FMI_1.replace(' numberOfContinuousStates="1"', ""),
            "has a wrong modelDescription.xml: ERROR (line 2, column 0): Element "
            "'fmiModelDescription': The attribute 'numberOfContinuousStates' is required but "
            "missing.",
        ),
    ],
)
def test_description_that_cannot_be_read_is_refused(
    tmp_path: Path, description: str, message: str
) -> None:
    path = archive(tmp_path / "a.fmu", description)
    assert refused(path).startswith(f"'{path}' {message}")


def test_torn_archive_is_refused(tmp_path: Path) -> None:
    path = variant(tmp_path, "track")
    content = bytearray(path.read_bytes())
    start = content.index(b"<fmiModelDescription")
    content[start : start + 40] = bytes(40)
    path.write_bytes(content)
    assert refused(path).startswith(f"'{path}' has a modelDescription.xml that cannot be read: Bad")


@pytest.mark.parametrize("command", [("fmu",), ("fmu", "info"), ("fmu", "check")])
def test_help_of_the_fmu_commands_shows_an_example(command: tuple[str, ...]) -> None:
    result = CliRunner().invoke(main, [*command, "--help"])
    assert result.exit_code == 0
    assert "  tracktrain fmu" in result.stdout.partition("Examples:")[2]


TERMINALS = """<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
<Terminal name="plug" matchingRule="sequence"><TerminalMemberVariable variableName="y"
 variableKind="signal"/><Terminal name="inner" matchingRule="bus" terminalKind="org.any.kind">
<TerminalMemberVariable variableName="y" memberName="height" variableKind="inflow"/></Terminal>
</Terminal></Terminals></fmiTerminalsAndIcons>"""

MANIFEST = """<fmiLayeredStandardManifest xmlns:ls="http://fmi-standard.org/fmi-ls-manifest"
 ls:fmi-ls-name="org.any.standard" ls:fmi-ls-version="2.1" ls:fmi-ls-description="d"/>"""


def with_extras(path: Path, terminals: str) -> Path:
    archive(path, FMI_3)
    with zipfile.ZipFile(path, "a") as file:
        file.writestr("terminalsAndIcons/terminalsAndIcons.xml", terminals)
        file.writestr("extra/org.any.standard/fmi-ls-manifest.xml", MANIFEST)
        file.writestr("extra/org.any.standard/other.xml", "<no/>")
    return path


def test_states_terminals_and_reference_results_of_ours_are_told() -> None:
    said = rows(info(fmu_path("truck")))
    assert "states 12, event indicators 16" in said
    assert "follows org.fmi-standard.fmi-ls-ref 1.0.0-alpha.1" in said
    assert "result: results.csv" in said
    assert "terminals (6)" in said
    assert any(line.startswith("rails[1] org.tracktrain.rails bus axle[1].rail_z") for line in said)


def test_terminals_and_layered_standards_of_others_are_told(tmp_path: Path) -> None:
    path = with_extras(tmp_path / "new.fmu", TERMINALS)
    said = rows(info(path))
    assert "follows org.any.standard 2.1" in said
    assert "plug sequence y" in said
    assert "plug.inner org.any.kind bus height = y" in said
    told = data(path)
    assert told["terminals"][1]["members"] == [
        {"name": "height", "variable": "y", "kind": "inflow"}
    ]
    assert told["layered_standards"] == [
        {"name": "org.any.standard", "version": "2.1", "related": []}
    ]
    assert told["problems"] == []


def test_a_terminals_file_that_is_broken_hides_nothing_else(tmp_path: Path) -> None:
    said = info(with_extras(tmp_path / "new.fmu", "<fmiTerminalsAndIcons>"))
    assert "terminalsAndIcons.xml that cannot be read" in " ".join(said.split())
    assert "org.any.standard 2.1" in said


def test_states_and_event_indicators_are_counted_in_every_version(tmp_path: Path) -> None:
    old = data(archive(tmp_path / "old.fmu", FMI_1))
    assert (old["states"], old["event_indicators"]) == (1, 0)
    listed = '<ContinuousStateDerivative valueReference="2"/><EventIndicator valueReference="2"/>'
    text = FMI_3.replace("</ModelStructure>", f"{listed}</ModelStructure>")
    new = data(archive(tmp_path / "new.fmu", text))
    assert (new["states"], new["event_indicators"]) == (1, 1)
    arrays = data(fmu_path("truck", "3.0"))
    assert (arrays["states"], arrays["event_indicators"]) == (12, 16)
