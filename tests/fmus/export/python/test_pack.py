"""A user's model becomes an FMU: what travels along, and what is refused with a reason."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException

from fmus.export.python import PackError, pack
from orchestrator import describe
from support.archive_checks import findings
from support.fmu_instance import FmuInstance
from support.python_process import run_script

HEAD = """
from fmus.model import Input, Model, Output, Parameter
"""

SPRING = (
    HEAD
    + """
class Spring(Model):
    description = "A mass on a spring"
    author = "A. Newcomer"
    parameters = (
        Parameter("stiffness", "N/m", "Stiffness", minimum=0.0, default=100.0, tunable=True),
        Parameter("law", "1", "Law", kind="enumeration", choices=("soft", "hard"), default=1),
        Parameter("stuck", "1", "Whether it is stuck", kind="boolean", default=0),
        Parameter("turns", "1", "Turns of wire", kind="integer", default=7),
    )
    inputs = (Input("force", "N", "Force"),)
    outputs = (
        Output("x", "m", "Position"),
        Output("v", "m/s", "Velocity", derivative_of="x"),
        Output("a", "m/s2", "Acceleration", derivative_of="v"),
    )
    feedthrough = {"a": ("force",)}

    def start(self, p, u):
        self.x, self.v, self.past = 0.1, 0.0, []

    def step(self, p, u, time, size):
        self.v += size * self.acceleration(p, u)
        self.x += size * self.v
        self.past.append((time, self.x))

    def output(self, p, u):
        return {"x": self.x, "v": self.v, "a": self.acceleration(p, u)}

    def acceleration(self, p, u):
        hard = 2.0 if p["law"] == 2 else 1.0
        return 0.0 if p["stuck"] else u["force"] - hard * p["stiffness"] * self.x
"""
)


def packed(folder: Path, text: str, name: str = "my_spring") -> Path:
    (folder / f"{name}.py").write_text(text)
    return pack(folder / f"{name}.py", folder)


def refused(folder: Path, text: str) -> str:
    with pytest.raises(PackError) as caught:
        packed(folder, text)
    return str(caught.value)


@pytest.fixture
def spring(tmp_path):
    instance = FmuInstance(packed(tmp_path, SPRING))
    yield instance
    instance.close()


def test_a_plain_model_is_a_sound_fmu(tmp_path):
    path = packed(tmp_path, SPRING)
    assert findings(path) == []
    description = describe(path)
    assert description.variables["a"].dependencies == {"force"}
    assert description.variables["x"].dependencies == frozenset()
    assert description.variables["a"].derivative_of == "v"
    assert description.variables["stiffness"].minimum == 0.0
    assert description.variables["law"].items == {"soft": 1, "hard": 2}
    text = zipfile.ZipFile(path).read("modelDescription.xml").decode()
    assert 'author="A. Newcomer"' in text
    assert "MIT" not in text  # whose licence it is, is the author's to say


def test_packing_twice_gives_the_same_bytes(tmp_path):
    assert packed(tmp_path, SPRING).read_bytes() == packed(tmp_path, SPRING).read_bytes()


def test_parameters_of_every_type_reach_the_model(spring):
    slave, vr = spring.slave, spring.vr
    assert slave.getInteger(vr("law", "turns")) == [1, 7]
    slave.setInteger(vr("law"), [2])
    spring.initialize()
    assert spring.get("a") == [-20.0]
    spring.set({"stiffness": 50.0, "force": 1.0})
    assert spring.get("a") == [-9.0]
    slave.reset()
    slave.setBoolean(vr("stuck"), [True])
    assert spring.initialize().get("a") == [0.0]


def test_all_that_is_in_self_is_restored_and_stored(spring):
    slave = spring.initialize().slave
    slave.doStep(0.0, 0.01)
    state = slave.getFMUstate()
    data = slave.serializeFMUstate(state)
    slave.doStep(0.01, 0.01)
    expected = spring.outputs()
    for again in (state, slave.deSerializeFMUstate(data)):
        slave.setFMUstate(again)
        slave.doStep(0.01, 0.01)
        assert spring.outputs() == expected


def test_an_exception_in_the_model_is_a_message_and_the_step_is_not_taken(tmp_path):
    text = SPRING.replace("self.past.append", "1 / (u['force'] - 13.0); self.past.append")
    instance = FmuInstance(packed(tmp_path, text)).initialize()
    before = instance.outputs()
    instance.set({"force": 13.0})
    with pytest.raises(FMICallException):
        instance.slave.doStep(0.0, 0.01)
    assert instance.messages[0].startswith("my_spring: ZeroDivisionError in step, ")
    instance.set({"force": 0.0})
    assert instance.outputs() == before
    instance.slave.doStep(0.0, 0.01)
    instance.close()


def test_modules_and_data_beside_the_model_travel_along(tmp_path):
    (tmp_path / "table_of_mine.py").write_text(
        "from pathlib import Path\n"
        "VALUE = float((Path(__file__).parent / 'data' / 'value.txt').read_text())\n"
    )
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "value.txt").write_text("42.0")
    text = SPRING.replace(HEAD, HEAD + "from table_of_mine import VALUE\nimport table_of_mine\n")
    path = packed(tmp_path, text.replace("= 0.1, 0.0", "= VALUE, table_of_mine.VALUE"))
    script = f"""
from fmpy import simulate_fmu
result = simulate_fmu({str(path)!r}, stop_time=0.01, output_interval=0.01, output=["x", "v"])
print(result["x"][0], result["v"][0])
"""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    hidden = ("fmus", "orchestrator", "tracktrain", "pythonfmu", "casadi", "pint")
    assert run_script(script, elsewhere, hidden) == "42.0 42.0\n"


def test_a_model_finds_its_data_when_the_folder_of_its_first_instance_is_gone(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "value.txt").write_text("42.0")
    read = "float((Path(__file__).parent / 'data' / 'value.txt').read_text()), 0.0"
    text = SPRING.replace(HEAD, HEAD + "from pathlib import Path\n").replace("0.1, 0.0", read)
    path = packed(tmp_path, text)
    for _ in range(2):
        instance = FmuInstance(path).initialize()
        assert instance.get("x") == [42.0]
        instance.close()


def test_packages_that_have_to_be_installed_are_listed(tmp_path):
    path = packed(tmp_path, SPRING.replace(HEAD, HEAD + "import scipy.optimize\n"))
    needs = zipfile.ZipFile(path).read("documentation/externalDependencies.txt").decode()
    assert {line.split()[0] for line in needs.splitlines()[5:]} == {"numpy", "scipy"}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('{"a": ("force",)}', "{}", "a changes at once with force; say so in feedthrough"),
        ('{"a": (', '{"b": (', "feedthrough names b, which is no output"),
        ('("force",)}', '("push",)}', "feedthrough of a names push, which is no input"),
        ('"x", "m", "Pos', '"x", "inch", "Pos', "x is in 'inch', which is no SI unit as FMI"),
        ('of="x"', 'of="y"', "v is the rate of y, which is no output"),
        ('"v", "m/s"', '"x", "m/s"', "x is declared 2 times"),
        (", default=7", "", "the parameter turns has no default; give one"),
        ("default=100.0", "default=-1.0", "the default of stiffness is not within 0 to"),
        ('"v": self.v, ', "", "output() gives no v"),
        ('{"x": self.x', '{"z": 0.0, "x": self.x', "output() gives z, which is not declared"),
        ("0.1, 0.0, []", "0.1, 0.0, []; self.odd = {1}", "state['odd'] is a set; keep"),
        ("import Input", "import Inputs", "cannot be imported: ImportError"),
        ("self.v += size *", "self.v += size * nothing *", "NameError: name 'nothing'"),
        ("def start(self", "def start(self:", "line "),
        ("class Spring(Model)", "class Spring", "has to define one class derived from fmus.model"),
        (
            "from fmus.model import",
            "from fmus import BLOCKS\nfrom fmus.model import",
            "fmus.MODULE",
        ),
    ],
)
def test_what_is_not_true_is_refused_with_what_to_change(tmp_path, old, new, message):
    assert old in SPRING
    assert message in refused(tmp_path, SPRING.replace(old, new, 1))
    assert list(tmp_path.glob("*.fmu")) == []


def test_state_outside_self_is_found(tmp_path):
    text = SPRING.replace("class Spring", "MEMORY = [0.0]\n\nclass Spring").replace(
        "self.past.append", "MEMORY[0] += 1.0; self.x += MEMORY[0]; self.past.append"
    )
    assert "a step is another one after the state was put back" in refused(tmp_path, text)
