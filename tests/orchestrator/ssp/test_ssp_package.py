"""Files of a package: which are read, which lie outside, and how much may be unpacked."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest

from orchestrator import Connection, OrchestratorError
from orchestrator.fmu import archive as archives
from orchestrator.ssp import read_ssp
from support.ssp_archives import (
    DAMPER,
    MASS,
    component,
    connection,
    connections,
    connectors,
    elements,
    ssd,
    system,
    write,
)

SSD = "SystemStructure.ssd"


def refusal(path: Path, variant: str | None = None) -> str:
    with pytest.raises(OrchestratorError) as caught:
        read_ssp(path, variant)
    return str(caught.value)


def test_variant_that_was_not_asked_for_may_be_wrong(tmp_path, fmus):
    sound = ssd(elements(component("mass", MASS)), name="sound")
    path = write(tmp_path / "x.ssp", {SSD: sound, "a.ssd": "<ssd", "b.ssd": sound, **fmus})
    assert [*read_ssp(path).components] == ["mass"]
    assert [*read_ssp(path, "b").components] == ["mass"]
    assert [*read_ssp(path, "sound").components] == ["mass"]
    assert "a.ssd' that cannot be read" in refusal(path, "a")
    said = refusal(path, "other")
    assert said.startswith(f"'{path}' has no variant 'other'; choose one of: {SSD}, a.ssd, b.ssd")
    assert "a.ssd' that cannot be read" in said


def test_empty_element_of_a_connection_is_the_system_itself(tmp_path, fmus):
    """As OMSimulator writes it."""
    own = '<ssd:Connection startElement="" startConnector="speed" endElement="d" endConnector="v"/>'
    inner = system(
        "s",
        connectors(speed="input") + elements(component("d", DAMPER)) + connections(own),
    )
    text = ssd(elements(inner, component("m", MASS)) + connections(connection("m.v", "s.speed")))
    path = write(tmp_path / "x.ssp", {SSD: text, **fmus})
    assert read_ssp(path).connections == (Connection("m.v", "s:d.v"),)


def test_description_outside_of_an_archive_names_files_above_it(tmp_path, fmus):
    (tmp_path / "a.fmu").write_bytes(fmus[MASS].read_bytes())
    folder = tmp_path / "systems"
    folder.mkdir()
    inner = folder / "inner.ssd"
    inner.write_text(ssd(elements(component("mass", "../a.fmu"))))
    outer = folder / "outer.ssd"
    outer.write_text(ssd(elements(component("inner", "inner.ssd"), component("m", "../a.fmu"))))
    assert {*read_ssp(outer).components} == {"inner:mass", "m"}


def test_description_in_an_archive_stays_in_it(tmp_path, fmus):
    """One in a folder of the archive reaches its other files, and nothing else."""
    (tmp_path / "a.fmu").write_bytes(fmus[MASS].read_bytes())
    outer = ssd(elements(component("inner", "deep/inner.ssd")))
    for source, sound in ((f"../{MASS}", True), ("../../a.fmu", False)):
        inner = ssd(elements(component("mass", source)))
        path = write(tmp_path / "x.ssp", {SSD: outer, "deep/inner.ssd": inner, **fmus})
        if sound:
            assert [*read_ssp(path).components] == ["inner:mass"]
        else:
            assert "lies outside of the package" in refusal(path)


def packed(members: dict[str, bytes]) -> bytes:
    with io.BytesIO() as stream:
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
            for name, content in members.items():
                file.writestr(name, content)
        return stream.getvalue()


def test_archives_in_archives_unpack_to_no_more_than_one_may(tmp_path, monkeypatch):
    monkeypatch.setattr(archives, "UNSUSPICIOUS", 2**20)
    bombs = {
        f"{n}.ssp": packed({SSD: ssd("").encode(), "zeros": bytes(9 * 10**5)}) for n in range(30)
    }
    text = ssd(elements(*(component(f"c{n}", f"{n}.ssp") for n in range(30))))
    path = tmp_path / "x.ssp"
    path.write_bytes(packed({SSD: text.encode(), **bombs}))
    said = refusal(path)
    assert said.startswith(f"'{path}' and the archives in it, '") and "would unpack to" in said
    assert said.endswith("unpack what you trust by hand, and run its .ssd")


def test_archive_that_is_referred_to_often_is_unpacked_once(tmp_path, fmus, monkeypatch):
    monkeypatch.setattr(archives, "UNSUSPICIOUS", 2**20)
    small = ssd(elements(component("m", MASS))).encode()
    inner = {SSD: small, "zeros": bytes(5 * 10**5), MASS: fmus[MASS].read_bytes()}
    text = ssd(elements(*(component(f"c{n}", "inner.ssp") for n in range(20))))
    path = tmp_path / "x.ssp"
    path.write_bytes(packed({SSD: text.encode(), "inner.ssp": packed(inner)}))
    assert len(read_ssp(path).components) == 20
