"""Hundreds of wrong files: each is read, or refused in one line, soon and in little memory."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import fmpy
import pytest
from click.testing import CliRunner, Result

from orchestrator import OrchestratorError, read_ssp
from support.hostile import SOURCES, archives, descriptions, larger_than_it_says, texts, zipped
from support.native_slaves import DAMPER, TANGENT, build_damper, build_mass, description
from support.ssp_archives import DAMPER as DAMPER_FMU
from support.ssp_archives import MASS as MASS_FMU
from support.ssp_archives import (
    bindings,
    component,
    connection,
    connections,
    connectors,
    elements,
    inline,
    linear,
    ssd,
    ssm,
    ssv,
    system,
)
from support.typed_slaves import fmi2_description, fmi3_description
from tracktrain.cli.main import main

pytestmark = pytest.mark.skipif(os.name != "posix", reason="bounds memory as Linux and macOS do")

MEMORY, SECONDS = 3 * 2**30, 30.0
"""What a file may cost: address space [bytes] on top of the test's own, time of the processor."""

XML = "modelDescription.xml"
OWN = TANGENT.replace('"force"', '"v"', 1).replace(
    '"v" partial="force_per_v"', '"force" partial="v"'
)
TEXTS = {
    "FMI 2.0": description(DAMPER, extra=OWN),
    "all types of FMI 2.0": fmi2_description(),
    "FMI 3.0": fmi3_description(),
}


def fmu(text: bytes) -> bytes:
    folders = (fmpy.platform, fmpy.platform_tuple)
    binaries = {f"binaries/{f}/slave{fmpy.sharedLibraryExtension}": b"x" for f in folders}
    return zipped({XML: text, **binaries})


def _fmus() -> Iterator[tuple[str, bytes]]:
    for version, text in TEXTS.items():
        for name, data in (*descriptions(text), *texts(text)):
            yield f"{version}: {name}", fmu(data)
    yield from archives(XML, TEXTS["FMI 2.0"])
    yield "larger than it says", larger_than_it_says(fmu(TEXTS["FMI 2.0"].encode()))


FMUS = dict(_fmus())


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """Neither a file that is read without end nor one that swells passes."""

    def late(*_: object) -> None:
        pytest.fail(f"it took more than {SECONDS:g} s")

    of_process = resource.getrlimit(resource.RLIMIT_AS)
    statm = Path("/proc/self/statm")
    used = int(statm.read_text().split()[0]) * resource.getpagesize() if statm.exists() else 0
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, of_process[1]))
    before = signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    yield
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, before)
    resource.setrlimit(resource.RLIMIT_AS, of_process)


def is_shown_in_words(result: Result) -> bool:
    """Whether what a command says is in order: read, or refused in one line."""
    text = result.output
    assert result.exit_code in (0, 2), text[:500]
    assert "Traceback" not in text and "fault of tracktrain" not in text
    assert all(character.isprintable() or character == "\n" for character in text)
    assert len(text) < 20_000
    if result.exit_code:
        assert text.startswith("Error: ") and text.count("\n") == 1 and len(text) < 5000
    return True


def test_there_are_as_many_as_were_promised():
    assert len(FMUS) >= 700


@pytest.mark.parametrize("name", FMUS)
def test_wrong_fmu_is_read_or_refused_in_one_line(tmp_path, name):
    path = tmp_path / "a.fmu"
    path.write_bytes(FMUS[name])
    assert is_shown_in_words(CliRunner().invoke(main, ["fmu", "info", str(path)]))


SET = ssv({"c": 'Real value="3" unit="N.s/m"'})
TYPE = 'type="application/x-fmu-sharedlibrary" implementation="CoSimulation"'


@cache
def whole_ssd() -> str:
    """A description that has something of everything."""
    entry = ssm(
        '<ssm:MappingEntry source="k" target="c"><ssc:LinearTransformation factor="2"/>'
        "</ssm:MappingEntry>"
    )
    bound = bindings(
        inline(ssv({"k": 'Real value="2" unit="N.s/m"'}), entry),
        '<ssd:ParameterBinding source="p.ssv" type="application/x-ssp-parameter-set" prefix=""/>',
    )
    ends = connectors(v="input", force="output")
    inner = system(
        "s",
        connectors(speed="input Real unit='m/s'", pull="output")
        + elements(component("d", DAMPER_FMU, ends + bound, TYPE))
        + connections(connection(".speed", "d.v"), connection("d.force", ".pull")),
    )
    bus = (
        '<ssd:SignalDictionaries><ssd:SignalDictionary name="bus">'
        '<ssb:SignalDictionary version="1.0"><ssb:DictionaryEntry name="v">'
        '<ssc:Real unit="m/s"/></ssb:DictionaryEntry></ssb:SignalDictionary>'
        "</ssd:SignalDictionary></ssd:SignalDictionaries>"
    )
    stop = (
        '<ssd:SignalDictionaryReference name="r" dictionary="bus">'
        f"{connectors(v='inout')}</ssd:SignalDictionaryReference>"
    )
    back = connection("s.pull", "m.force", linear(), 'suppressUnitConversion="false"')
    links = connections(connection("m.v", "r.v"), connection("r.v", "s.speed"), back)
    experiment = (
        '<ssd:DefaultExperiment startTime="0" stopTime="1"><ssd:Annotations>'
        '<ssc:Annotation type="org.openmodelica"><oms:FixedStepMaster xmlns:oms="oms" '
        'stepSize="0.1"/></ssc:Annotation></ssd:Annotations></ssd:DefaultExperiment>'
    )
    return ssd(bus + elements(inner, component("m", MASS_FMU), stop) + links, experiment)


def _ssps() -> Iterator[tuple[str, dict[str, bytes]]]:
    text = whole_ssd()
    for name, data in (*descriptions(text, 2), *texts(text.replace("root", "Slave"))):
        yield f"ssd: {name}", {"SystemStructure.ssd": data, "p.ssv": SET.encode()}
    for name, data in (*descriptions(SET), *texts(SET)):
        yield f"ssv: {name}", {"SystemStructure.ssd": text.encode(), "p.ssv": data}
    for name, uri in SOURCES.items():
        of_set = '<ssd:ParameterBinding source="{}" sourceBase="{}"/>'
        for what, inside in (
            ("component", component("d", uri)),
            ("set", component("d", DAMPER_FMU, bindings(of_set.format(uri, "SSD")))),
            (
                "set in an FMU",
                component("d", DAMPER_FMU, bindings(of_set.format(uri, "component"))),
            ),
        ):
            yield f"{what}: {name}", {"SystemStructure.ssd": ssd(elements(inside)).encode()}


SSPS = dict(_ssps())


@pytest.fixture(scope="module")
def fmus(tmp_path_factory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("fmus")
    return {
        DAMPER_FMU: build_damper(folder).read_bytes(),
        MASS_FMU: build_mass(folder).read_bytes(),
    }


@pytest.mark.parametrize("name", SSPS)
def test_wrong_ssp_is_read_or_refused_in_one_line(tmp_path, fmus, name):
    path = tmp_path / "a.ssp"
    path.write_bytes(zipped({**SSPS[name], **fmus}))
    try:
        read_ssp(path)
    except OrchestratorError as error:
        assert str(error).isprintable() and len(str(error)) < 5000


def test_the_ssp_that_is_made_wrong_is_sound(tmp_path, fmus):
    path = tmp_path / "a.ssp"
    members = {"SystemStructure.ssd": whole_ssd().encode(), "p.ssv": SET.encode(), **fmus}
    path.write_bytes(zipped(members))
    assert len(read_ssp(path).connections) == 2
    assert len(SSPS) >= 255


@pytest.mark.parametrize("kind", ["pipe", "device"])
@pytest.mark.parametrize(
    ("command", "name", "what"),
    [
        (("fmu", "info"), "a.fmu", "FMU"),
        (("fmu", "test"), "a.fmu", "FMU"),
        (("fmu", "check", "--as", "truck"), "a.fmu", "FMU"),
        (("run",), "a.ssp", "system"),
        (("run",), "a.ssd", "system"),
        (("run", "--swap", "truck_front=b.fmu", "--map"), "a.toml", "port map"),
        (("run", "--swap", "truck_front=b.fmu", "--map"), "a.ssm", "parameter map"),
    ],
)
def test_what_never_ends_is_not_opened(tmp_path, monkeypatch, command, name, what, kind):
    monkeypatch.chdir(tmp_path)
    if kind == "pipe":
        os.mkfifo(name)
    else:
        Path(name).symlink_to("/dev/zero")
    (tmp_path / "b.fmu").write_bytes(fmu(TEXTS["FMI 2.0"].encode()))
    given = f"truck_front={name}" if command[-1] == "--map" else name
    done = CliRunner().invoke(main, [*command, given])
    assert (done.exit_code, done.output) == (
        2,
        f"Error: '{name}' is no {what}: it is a pipe or a device\n",
    )
