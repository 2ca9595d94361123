"""Self-tests of a system's FMUs, each in another process once, and then remembered by its hash."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from ..errors import UnwrittenError, plain
from ..files import whole_file
from ..plan.plan import component_description
from ..slaves.isolated.slave import cause
from ..system.encoding import encode
from ..system.profile import Profile
from ..system.system import Component
from .findings import VERSION, Finding, SelfTest
from .self_test import self_test

TIMEOUT = 60.0
"""Wall time that the test of one FMU may take [s]."""


def self_tests(components: Mapping[str, Component], *, anew: bool = False) -> dict[str, SelfTest]:
    """The self-test of each instance's FMU or model; what is remembered counts, unless `anew`.

    A table has none: whether it reaches to the end, the run itself sees. An FMU is tested with the
    values of the first instance that has it, by steps that it recommends.
    A test that found nothing wrong counts for all values, another one for these values and this
    state of the package alone: they may be what was wrong.
    Raises OrchestratorError for what cannot be described.
    """
    hashes: dict[str, str] = {}
    known: dict[str, SelfTest] = {}
    waiting: dict[str, Component] = {}
    for name, component in components.items():
        if isinstance(component.fmu, Profile):
            continue
        if component.file is None:
            hashes[name] = name
            known[name] = self_test(component)
            continue
        sha256 = hashes[name] = component_description(name, component).sha256
        if sha256 in known or sha256 in waiting:
            continue
        if not anew and (found := _remembered(sha256, component)):
            known[sha256] = found
        else:
            waiting[sha256] = component
    for sha256, found in zip(waiting, _elsewhere(list(waiting.values())), strict=True):
        known[sha256] = found
        _remember(sha256, waiting[sha256], found)
    return {name: _named(known[sha256], components[name]) for name, sha256 in hashes.items()}


def _named(found: SelfTest, component: Component) -> SelfTest:
    """A test by the name that the file has here: another copy of it may have been tested."""
    return replace(found, label=component.file.name) if component.file else found


def _elsewhere(components: Sequence[Component]) -> Iterator[SelfTest]:
    """Tests in a process of their own; one that an FMU takes down is started again after it."""
    done = 0
    while done < len(components):
        with tempfile.TemporaryDirectory() as folder:
            asked, answered = Path(folder) / "asked.json", Path(folder) / "answered.jsonl"
            asked.write_text(json.dumps(encode(list(components[done:]))))
            answered.touch()
            why = _run(asked, answered, TIMEOUT * (len(components) - done))
            for line in answered.read_text().splitlines():
                yield _decoded(json.loads(line))
                done += 1
            if done < len(components) and why:
                label = Path(str(components[done].fmu)).name
                yield SelfTest(label, (), (Finding("process", why),))
                done += 1


def _run(asked: Path, answered: Path, timeout: float) -> str:
    """Run the process; how it failed, or nothing."""
    command = [sys.executable, "-m", f"{__package__}", str(asked), str(answered)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    text = asked.with_name("said.txt")
    with (
        text.open("wb") as stream,
        subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.PIPE,  # see `end_with_parent`
            stdout=subprocess.DEVNULL,
            stderr=stream,
            start_new_session=True,
        ) as process,
    ):
        try:
            process.wait(timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            return f"its self-test did not end within {timeout:g} s"
    said = text.read_text(errors="replace").strip().splitlines()
    more = f": {plain(said[-1])}" if said else ""
    return f"its self-test crashed ({cause(process.returncode)}){more}"


@cache
def _package() -> str:
    """The hash of this package's sources."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _place(sha256: str, component: Component | None = None) -> Path:
    """The file of a test; component: whose values it counts for, if not for all."""
    own = ""
    if component is not None:
        given = _package() + repr(sorted(component.parameters.items()))
        own = f"-{hashlib.sha256(given.encode()).hexdigest()[:16]}"
    return user_cache_path("tracktrain") / "self_tests" / f"{VERSION}-{sha256}{own}.json"


def _remembered(sha256: str, component: Component) -> SelfTest | None:
    for path in (_place(sha256), _place(sha256, component)):
        with suppress(OSError, ValueError, KeyError, TypeError):
            return _decoded(json.loads(path.read_text()))
    return None


def _remember(sha256: str, component: Component, found: SelfTest) -> None:
    path = _place(sha256, component if any(f.wrong for f in found.findings) else None)
    # without a cache it is tested each time
    with suppress(UnwrittenError), whole_file(path) as new:
        new.write_text(json.dumps(asdict(found)))


def _decoded(said: dict) -> SelfTest:
    findings = tuple(Finding(**finding) for finding in said["findings"])
    return SelfTest(said["label"], tuple(said["passed"]), findings)
