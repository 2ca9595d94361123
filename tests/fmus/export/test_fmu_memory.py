"""The FMUs' C under the compiler's sanitizers: no leak, no stray access, no shared data."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import pytest

from fmus import BLOCKS
from fmus.describe.parameters import DEFAULT_SET, parameter_set
from fmus.export.code import sources
from support.hosted import HOSTS

pytestmark = pytest.mark.slow

HOST = HOSTS / "memory_host.c"
MEMORY = ("-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
THREADS = ("-fsanitize=thread",)
LIVES = 10_000
INSTANCES = 6
INTERFACES = ("co_simulation", "model_exchange")


def compiled(folder: Path, compiler: str, flags: tuple[str, ...]) -> Path:
    """All C files of the folder as one program; raises CalledProcessError."""
    program = folder / "program"
    files = map(str, folder.glob("*.c"))
    subprocess.run(
        [compiler, "-std=gnu11", "-O1", "-g", *flags, *files, "-o", program, "-lm", "-lpthread"],
        check=True,
        capture_output=True,
    )
    return program


@cache
def compiler_with(flags: tuple[str, ...]) -> str | None:
    """A C compiler of this machine whose programs run with the flags."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "trial.c").write_text("int main(void) { return 0; }\n")
        for compiler in filter(shutil.which, ("cc", "gcc", "clang")):
            try:
                subprocess.run([compiled(folder, compiler, flags)], check=True, capture_output=True)
                return compiler
            except (subprocess.CalledProcessError, OSError):
                continue
    return None


def host(
    block_name: str, fmi: str, flags: tuple[str, ...], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """The C host with the block's sources, or the test is skipped."""
    compiler = compiler_with(flags)
    if compiler is None:
        pytest.skip(f"no cc, gcc or clang here makes programs that run with {flags[0]}")
    block = BLOCKS[block_name]()
    folder = tmp_path_factory.mktemp(block_name)
    start = parameter_set(DEFAULT_SET).values(block)
    calls = HOST.with_name(f"host_fmi{fmi[0]}.h")
    own = {file.name: file.read_text() for file in (HOST, calls)}
    for name, text in {**sources(block, start, fmi, "guid"), **own}.items():
        (folder / name).write_text(text)
    return compiled(folder, compiler, (*flags, f'-DHOST_API="{calls.name}"'))


def run(program: Path, *arguments: object) -> None:
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]


def test_ten_thousand_lives_leave_no_memory_behind(block_name, fmi, tmp_path_factory):
    program = host(block_name, fmi, MEMORY, tmp_path_factory)
    for interface in INTERFACES:
        run(program, "lives", interface, LIVES)


def test_instances_in_threads_share_nothing(block_name, fmi, tmp_path_factory):
    program = host(block_name, fmi, THREADS, tmp_path_factory)
    for interface in INTERFACES:
        run(program, "threads", interface, INSTANCES)
