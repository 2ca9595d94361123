"""The binary of a Python FMU in any program: nothing that it is given ends that program."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from hypothesis import settings
from hypothesis.stateful import rule, run_state_machine_as_test

from fmus.export.python import build_python, pack
from support.fmu_instance import FmuInstance
from support.hosted import HOST, Hosted, step
from support.python_process import TESTS, run_script
from support.random_calls import SETTINGS, AnyCalls, standard_run

SLOW = """
from fmus.model import Input, Model, Output, Parameter

class Slow(Model):
    description = "A step that never ends where its input is 1, and ends the program where it is 2"
    parameters = (Parameter("stiffness", "N/m", "Unused", minimum=0.0, default=1.0),)
    inputs = (Input("force", "N", "What goes wrong"),)
    outputs = (Output("x", "m", "Position"),)

    def start(self, p, u):
        self.x = 0.0

    def step(self, p, u, time, size):
        self.x += 1.0
        while u["force"] == 1.0:
            pass
        if u["force"] == 2.0:
            raise SystemExit(7)

    def output(self, p, u):
        return {"x": self.x}
"""

PLAIN = """
from fmus.model import Input, Model, Output, Parameter

class Plain(Model):
    description = "A lag with variables of every type"
    parameters = (
        Parameter("rate", "1", "Rate", minimum=0.0, default=2.0, tunable=True),
        Parameter("initial", "m", "Start", default=0.1),
        Parameter("law", "1", "Law", kind="enumeration", choices=("soft", "hard"), default=1),
        Parameter("stuck", "1", "Whether it is stuck", kind="boolean", default=0),
        Parameter("turns", "1", "Turns", kind="integer", minimum=-1, maximum=9, default=7),
    )
    inputs = (Input("force", "N", "Force"), Input("other", "N", "Force"))
    outputs = (Output("x", "m", "Position"), Output("sum", "N", "Sum"))
    feedthrough = {"sum": ("force", "other")}

    def start(self, p, u):
        self.x, self.past = p["initial"], [1, 2]

    def step(self, p, u, time, size):
        if not p["stuck"]:
            self.x += size * (u["force"] - p["rate"] * p["law"] * self.x)
        self.past[0] += 1

    def output(self, p, u):
        return {"x": self.x, "sum": u["force"] + u["other"]}
"""


@pytest.fixture(scope="module")
def track(tmp_path_factory) -> Path:
    return build_python("track", tmp_path_factory.mktemp("python"))


@pytest.fixture(scope="module")
def slow(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("slow")
    (folder / "slow.py").write_text(SLOW)
    return pack(folder / "slow.py", folder)


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("plain")
    (folder / "plain.py").write_text(PLAIN)
    return pack(folder / "plain.py", folder)


LOGGER = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, *[ctypes.c_char_p] * 2
)


class Library:
    """The functions of a Python FMU, unpacked into a folder, and what it says."""

    def __init__(self, fmu: Path, folder: Path) -> None:
        extract(str(fmu), str(folder))
        self.guid = read_model_description(str(fmu)).guid.encode()
        self.resources = (folder / "resources").as_uri().encode()
        (library,) = folder.glob(f"binaries/*/{fmu.stem}.*")
        self.functions = ctypes.CDLL(str(library))
        self.functions.fmi2Instantiate.restype = ctypes.c_void_p
        self.said: list[tuple[bytes, int, bytes]] = []
        self.logger = LOGGER(lambda _e, name, s, _c, text: self.said.append((name, s, text)))
        self.callbacks = fmi2CallbackFunctions(ctypes.cast(self.logger, fmi2CallbackLoggerTYPE))

    def instantiate(self, **changes) -> int | None:
        given = {"name": b"mine", "type": 1, "guid": self.guid, "resources": self.resources}
        given |= {"callbacks": ctypes.byref(self.callbacks)} | changes
        return self.functions.fmi2Instantiate(*given.values(), 0, 0)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"guid": b"{other}"}, "the GUID differs from the model description's"),
        ({"guid": None}, "the GUID or the location of the resources is missing"),
        ({"type": 0}, "this FMU is for co-simulation (1) alone"),
        ({"type": 77}, "this FMU is for co-simulation (1) alone"),
        ({"name": b""}, "an instance needs a name"),
        ({"resources": None}, "the GUID or the location of the resources is missing"),
        ({"resources": b"file:///no/such/place"}, "there is no folder of resources at file:///no"),
        # The message is a format of printf: it reads the same formatted, and nearly so as it is.
        ({"resources": b"file:///no/50%"}, "there is no folder of resources at file:///no/50%%"),
        ({"resources": b"\xff\xfe"}, "there is no folder of resources at"),
    ],
)
def test_no_instance_is_made_of_what_is_wrong(track, tmp_path, wrong, message):
    library = Library(track, tmp_path)
    assert not library.instantiate(**wrong)
    ((name, status, text),) = library.said
    assert (name, status) == (wrong.get("name", b"mine"), 3)
    assert text.decode().startswith(message)


@pytest.mark.parametrize("folder", ["plain", "with blanks and 100%25", "größe", "#?[]{}", "%41"])
def test_resources_may_be_anywhere(track, tmp_path, folder):
    library = Library(track, tmp_path / folder)
    assert library.instantiate()
    for place in (
        str(tmp_path / folder / "resources").encode(),
        b"file:" + library.resources.removeprefix(b"file://"),
        library.resources.replace(b"file:///", b"FILE://localhost/"),
    ):
        assert library.instantiate(resources=place), place
    assert library.said == []


def test_names_are_any_bytes_and_callbacks_may_be_missing(track, tmp_path):
    library = Library(track, tmp_path)
    latin = "größe".encode("latin-1")
    c = ctypes.c_void_p(library.instantiate(name=latin))
    assert library.functions.fmi2Terminate(c) == 3
    assert library.said[-1][0] == latin
    for callbacks in (None, ctypes.byref(fmi2CallbackFunctions())):
        mute = ctypes.c_void_p(library.instantiate(callbacks=callbacks))
        assert library.functions.fmi2Terminate(mute) == 3
        library.functions.fmi2FreeInstance(mute)
    assert not library.instantiate(callbacks=None, guid=b"other")


def test_a_state_that_was_freed_is_no_state(track):
    instance = FmuInstance(track).initialize()
    slave = instance.slave
    state = slave.getFMUstate()
    stale = ctypes.c_void_p(state.value)
    for _ in range(2):
        slave.freeFMUstate(state)
    slave.freeFMUstate(stale)
    assert slave.dll.fmi2SetFMUstate(ctypes.c_void_p(slave.component), ctypes.c_void_p(4711)) == 3
    assert instance.messages == ["a saved state is needed, and this is none, or it was freed"]
    instance.close()


def test_ctrl_c_within_a_step_is_the_programs_and_the_instance_goes_on(slow, tmp_path):
    script = f"""
import _thread, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.path.insert(0, {TESTS!r})
from support.fmu_instance import FmuInstance
from pathlib import Path
instance = FmuInstance(Path({str(slow)!r})).initialize()
instance.set({{"force": 1.0}})
threading.Timer(0.5, _thread.interrupt_main).start()
try:
    instance.slave.doStep(0.0, 1.0)
except KeyboardInterrupt:
    print(instance.messages)
instance.set({{"force": 0.0}})
instance.slave.doStep(0.0, 1.0)
print(instance.get("x"))
"""
    assert run_script(script, tmp_path).splitlines() == ["['interrupted']", "[1.0]"]


def test_a_model_that_ends_its_program_does_not(slow):
    instance = FmuInstance(slow).initialize()
    instance.set({"force": 2.0})
    assert instance.slave.dll.fmi2DoStep(
        ctypes.c_void_p(instance.slave.component), ctypes.c_double(0), ctypes.c_double(1), 1
    )
    assert instance.messages[0].startswith("slow: SystemExit in step, ")
    assert instance.get("x") == [0.0]
    instance.close()


def test_a_program_ends_well_whatever_is_left(track, tmp_path):
    """Instances and states that nobody frees, and an instance freed when Python is gone."""
    script = f"""
import atexit, sys
sys.path.insert(0, {TESTS!r})
from support.fmu_instance import FmuInstance
from pathlib import Path
instances = [FmuInstance(Path({str(track)!r})).initialize() for _ in range(3)]
states = [instance.slave.getFMUstate() for instance in instances]
atexit.register(instances[1].slave.freeInstance)
instances[0].slave.freeInstance()
instances[2].slave.freeInstance()
print("end")
"""
    command = [sys.executable, "-X", "dev", "-c", script]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr


def shared_python() -> Path | None:
    """The library of this Python, if there is one."""
    variable = sysconfig.get_config_var
    place = Path(variable("LIBDIR") or "", variable("INSTSONAME") or "")
    return place if ".so" in place.name and place.exists() else None


def test_a_program_in_c_runs_it_with_the_python_on_its_path(track, tmp_path, capfd):
    """The same bits as in a Python program; without any Python a message."""
    if not shared_python() or not shutil.which("cc"):
        pytest.skip("this needs a shared library of Python and a C compiler called cc")
    program = tmp_path / "host"
    subprocess.run(["cc", "-O1", str(HOST), "-o", program, "-ldl", "-lm"], check=True)
    extract(str(track), str(tmp_path / "fmu"))
    (library,) = (tmp_path / "fmu").glob("binaries/*/*")
    hosted = Hosted(track, tmp_path, "track", str(library))
    resources = (tmp_path / "fmu" / "resources").as_uri()
    environment = {"PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"}
    step([program], [hosted], tmp_path, environment | {"FMU_RESOURCES": resources})
    found = hosted.outputs()
    with pytest.raises(subprocess.CalledProcessError):
        step([program], [hosted], tmp_path, {"PATH": "/nowhere", "FMU_RESOURCES": resources})
    assert "no Python was found" in capfd.readouterr().err
    instance = FmuInstance(track).initialize()
    rows = []
    inputs = np.fromfile(tmp_path / "inputs-track").reshape(len(found), -1)
    for k, values in enumerate(inputs):
        instance.slave.setReal(instance.vr(*instance.names("input")), list(values))
        instance.slave.doStep(k * 1e-3, 1e-3)
        rows.append(instance.outputs())
    assert np.array_equal(found, rows)
    instance.close()


def test_random_calls_are_done_or_refused_and_crash_nothing(plain):
    class AnyCallsToPython(AnyCalls):
        """It has no derivatives."""

        instance = FmuInstance(plain)

        def __init__(self) -> None:
            super().__init__()
            self.unknowns, self.knowns = set(), set()

        @rule()
        def set_input_derivatives(self) -> None:
            reference = self.legal_references[0]
            self.call(self.stepped.setRealInputDerivatives, [reference], [1], [0.0], refused=True)

        @rule()
        def get_directional_derivative(self) -> None:
            self.call(self.slave.getDirectionalDerivative, [1], [1], [1.0], refused=True)

    AnyCallsToPython.fresh = standard_run(AnyCallsToPython.instance)
    run_state_machine_as_test(AnyCallsToPython, settings=settings(SETTINGS, max_examples=100))
    AnyCallsToPython.instance.close()
