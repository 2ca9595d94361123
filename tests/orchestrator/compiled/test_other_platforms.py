"""The compiled loops of other platforms: built here, loaded and called where a runner is found."""

from __future__ import annotations

import subprocess
import sys

import pytest

from fmus.export.compiler import TARGETS
from orchestrator.compiled.compiler import PLATFORMS
from orchestrator.compiled.library import ENTRIES, PRODUCT, build_into
from support.other_platforms import RUNNERS, environment, runner

PROGRAM = r"""
#include <stdio.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) (void *)LoadLibraryA(path)
#define FIND(library, name) (void *)GetProcAddress((HMODULE)(library), name)
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

static void hear(void *from, const char *name, int status, const char *kind, const char *text) {
    printf("%s %d %s: %s\n", name, status, kind, text);
}

int main(int count, char **given) {
    void *library = OPEN(given[1]);
    if (!library) return 1;
    for (int n = 2; n < count; n++)
        if (!FIND(library, given[n])) return 2;
    *(void (**)(void *, const char *, int, const char *, const char *))
        FIND(library, "logger_listener") = hear;
    void (*logger)(void *, const char *, int, const char *, const char *, ...) =
        (void (*)(void *, const char *, int, const char *, const char *, ...))
        FIND(library, "logger");
    logger(0, "car", 1, "warning", "%s of %d: %.2f", "axle", 2, 0.25);
    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNNERS)
def test_loops_of_another_platform_are_loaded_and_called(name, tmp_path, tmp_path_factory):
    begin, zig = runner(name), TARGETS[name].zig
    target = next(platform for platform in PLATFORMS.values() if platform.zig == zig)
    library = build_into(tmp_path, target)
    (tmp_path / "load.c").write_text(PROGRAM)
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", zig, "-w"]
    subprocess.run([*compiler, "load.c", "-o", "load.exe"], cwd=tmp_path, check=True)
    functions = [entry.name for entry in ENTRIES.values() if entry.module in PRODUCT]
    said = subprocess.run(
        [*begin, "./load.exe", f"./{library.name}", *functions],
        cwd=tmp_path,
        env=environment(tmp_path_factory.mktemp("wine")),
        capture_output=True,
        text=True,
        check=True,
    )
    assert len(functions) > 10
    assert said.stdout.strip() == "car 1 warning: axle of 2: 0.25"
