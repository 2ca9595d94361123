"""Archives from strangers: whatever is meant to harm is refused, with the file and member named."""

from __future__ import annotations

import stat
import struct
import zipfile
from pathlib import Path

import fmpy
import pytest

from orchestrator import Component, OrchestratorError, System, simulate
from orchestrator.fmu import archive
from orchestrator.fmu.archive import open_archive
from support.native_slaves import DAMPER, description, library

XML = "modelDescription.xml"


def hostile(folder: Path, *members: tuple[str | zipfile.ZipInfo, bytes], text: str = "") -> Path:
    path = folder / "hostile.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as fmu:
        fmu.writestr(XML, text or description(DAMPER))
        for name, content in members:
            fmu.writestr(name, content)
    return path


def refusal(path: Path) -> str:
    with pytest.raises(OrchestratorError) as caught:
        simulate(System({"a": Component(path)}), duration=0.1, step=0.1)
    return str(caught.value)


def special(name: str, mode: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.create_system, info.external_attr = 3, mode << 16
    return info


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("resources/../../evil", "which lies outside of the archive"),
        ("../evil", "which lies outside of the archive"),
        ("resources\\..\\..\\evil", "which lies outside of the archive"),
        ("/etc/evil", "which is an absolute path"),
        ("C:/evil", "which is an absolute path"),
        ("resources/a\nb", "whose name has characters that cannot be printed"),
    ],
)
def test_name_that_reaches_out_of_the_archive(tmp_path, name, problem):
    path = hostile(tmp_path, (name, b""))
    shown = name.replace("\n", " ")
    assert refusal(path) == f"'{path}' holds '{shown}', {problem}"


@pytest.mark.parametrize(
    ("mode", "problem"),
    [
        (stat.S_IFLNK | 0o777, "which is a link"),
        (stat.S_IFIFO | 0o666, "which is neither a file nor a folder"),
    ],
)
def test_link_or_pipe(tmp_path, mode, problem):
    path = hostile(tmp_path, (special("resources/passwd", mode), b"/etc/passwd"))
    assert refusal(path) == f"'{path}' holds 'resources/passwd', {problem}"


def test_member_that_is_there_twice(tmp_path):
    with pytest.warns(UserWarning, match="Duplicate"):
        path = hostile(tmp_path, ("resources/a", b"one"), ("resources/a", b"two"))
    assert refusal(path) == f"'{path}' holds 'resources/a', which is there twice"


def test_folder_that_is_there_twice_and_a_file_that_is_the_same_twice(tmp_path):
    folder = special("resources/deep/", stat.S_IFDIR | 0o755)
    with pytest.warns(UserWarning, match="Duplicate"):
        path = hostile(
            tmp_path, (folder, b""), (folder, b""), ("resources/a", b"1"), ("resources/a", b"1")
        )
    with open_archive(path) as opened:
        opened.extract(opened.members, tmp_path / "unpacked")
        assert opened.read("resources/a") == b"1"
    assert (tmp_path / "unpacked/resources/deep").is_dir()


def test_backslashes_part_folders(tmp_path):
    """As some tools write archives; the FMU runs."""
    binary = library(tmp_path)
    path = hostile(
        tmp_path,
        (f"binaries\\{fmpy.platform}\\{binary.name}", binary.read_bytes()),
        ("resources\\deep\\a", b"1"),
    )
    run = simulate(System({"a": Component(path)}), duration=0.1, step=0.1, compiled=False)
    assert run.completed
    with open_archive(path) as opened:
        opened.extract(["resources/deep/a"], tmp_path / "unpacked")
    assert (tmp_path / "unpacked" / "resources" / "deep" / "a").read_bytes() == b"1"


def test_library_of_another_name_is_named(tmp_path):
    other = f"binaries/{fmpy.platform}/other{fmpy.sharedLibraryExtension}"
    path = hostile(tmp_path, (other, b"x"))
    suffix = fmpy.sharedLibraryExtension
    assert refusal(path) == (
        f"'{path}' has no slave{suffix} in binaries/{fmpy.platform}, which is what its model "
        f"identifier 'slave' calls for; there is other{suffix}"
    )


def test_encrypted_member(tmp_path):
    path = hostile(tmp_path, ("resources/a", b"one"))
    data = bytearray(path.read_bytes())
    entry = data.rindex(b"PK\x01\x02")
    data[entry + 8] |= 1
    path.write_bytes(data)
    assert refusal(path) == f"'{path}' holds 'resources/a', which is encrypted"


def test_bomb(tmp_path):
    path = hostile(tmp_path, ("resources/zeros", bytes(80 * 2**20)))
    said = refusal(path)
    assert said.startswith(f"'{path}' of 8")
    assert said.endswith(
        "would unpack to 80 MB ('resources/zeros' alone to 80 MB); at most 64 MB are accepted"
    )


def test_bomb_whose_members_share_their_bytes(tmp_path):
    """Many names of one compressed member: small as a file, and of an unsuspicious ratio each."""
    path = tmp_path / "overlap.fmu"
    with zipfile.ZipFile(path, "w") as fmu:
        fmu.writestr(XML, description(DAMPER))
        fmu.writestr("resources/kernel", bytes(range(256)) * 400)
        for n in range(100):
            info = zipfile.ZipInfo(f"resources/{n}")
            kernel = fmu.getinfo("resources/kernel")
            for field in ("CRC", "compress_size", "file_size", "header_offset"):
                setattr(info, field, getattr(kernel, field))
            fmu.filelist.append(info)
            fmu.NameToInfo[info.filename] = info
        fmu._didModify = True
    assert refusal(path) == f"'{path}' holds members that overlap: it is no archive but a trap"


def test_member_that_is_larger_than_it_says(tmp_path):
    path = hostile(tmp_path, text=description(DAMPER) + " " * 100_000)
    data = bytearray(path.read_bytes())
    struct.pack_into("<I", data, data.rindex(b"PK\x01\x02") + 24, 1000)
    path.write_bytes(data)
    assert refusal(path).startswith(f"'{path}' has a {XML} that cannot be read: ")


def test_too_many_members(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MEMBERS", 3)
    path = hostile(tmp_path, *((f"resources/{n}", b"") for n in range(3)))
    assert refusal(path) == f"'{path}' holds 4 members; at most 3 are accepted"


ENTITIES = "".join(f'<!ENTITY b{n} "{f"&b{n - 1};" * 10}">' for n in range(1, 10))


@pytest.mark.parametrize(
    "doctype",
    [
        f'<!DOCTYPE a [<!ENTITY b0 "ha">{ENTITIES}]>',
        '<!DOCTYPE a [<!ENTITY secret SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE a SYSTEM "http://localhost/a.dtd">',
    ],
    ids=["billion laughs", "file", "network"],
)
def test_entities(tmp_path, doctype):
    path = hostile(tmp_path, text=doctype + description(DAMPER))
    assert refusal(path) == (
        f"'{path}' has a {XML} that declares a document type, which may hold entities; "
        "remove <!DOCTYPE ...>"
    )


def test_absurd_xml(tmp_path, monkeypatch):
    path = hostile(tmp_path, text="<a>" * 200 + "</a>" * 200)
    assert refusal(path) == f"'{path}' has a {XML} that nests its elements deeper than 100"
    monkeypatch.setattr(archive, "XML_SIZE", 1024)
    assert refusal(path) == f"'{path}' has a {XML} of 1 kB; at most 1 kB are read"


def test_nothing_of_a_refused_archive_is_unpacked(tmp_path):
    path = hostile(tmp_path, ("resources/../../evil", b"evil"))
    with pytest.raises(OrchestratorError), open_archive(path) as opened:
        opened.extract(opened.members, tmp_path / "a" / "b")
    assert not list(tmp_path.rglob("evil"))
