"""A command loads what it uses, and a wheel without the extra `build` can do all but build."""

from __future__ import annotations

from fmus.catalogue import folder
from orchestrator.compiled.library import product
from support.python_process import run_script
from support.source_tree import ROOT

HEAVY = ("numpy", "scipy", "pandas", "xarray", "matplotlib", "casadi", "numba", "pint", "fmpy")

UNUSED = (
    "casadi", "dask.array", "distributed", "fmus.export", "markdown_it", "matplotlib.axes",
    "matplotlib.figure", "netCDF4", "numba", "pandas", "pint", "scipy.interpolate",
    "scipy.optimize", "xarray", "ziglang",
)  # fmt: skip
"""What a run with its verdict and its pictures does not take."""

SCRIPT = f"""
import sys
from click.testing import CliRunner
import orchestrator
print([name for name in {HEAVY} if name in sys.modules])
from tracktrain.cli.main import main
print([name for name in {HEAVY[1:]} if name in sys.modules])
def said(*arguments):
    result = CliRunner().invoke(main, arguments)
    return result.exit_code, " ".join(result.output.split())
code, text = said("run", "--duration", "0.1s", "--out", "out")
print(code, "Answer:" in text and "critical speed" in text)
print([name for name in {UNUSED} if name in sys.modules])
print(*said("build", "--out", "fmus"))
print(*said("study", "sensitivity"))
"""


def test_a_run_loads_only_what_it_uses_and_needs_nothing_of_the_extra_build(tmp_path):
    assert folder() and product()  # which a wheel has
    hidden = ("casadi", "markdown_it", "ziglang")
    lines = run_script(SCRIPT, tmp_path, hidden, path=str(ROOT)).splitlines()
    assert lines[:4] == ["[]", "[]", "0 True", "[]"]
    for refused in lines[4:]:
        assert refused.startswith("2 Error: this needs the package casadi, which is not installed")
        assert refused.endswith("python -m pip install 'tracktrain[build]'")
    assert (tmp_path / "out/carbody.png").exists() and len(lines) == 6


PAGE = f"""
import sys
from click.testing import CliRunner
from tracktrain.cli.main import main
if __name__ == "__main__":
    arguments = ["run", "--duration", "0.1s", "--out", "out", "--report"]
    print(CliRunner().invoke(main, arguments).exit_code)
    print([name for name in {(*UNUSED, "scipy.signal")} if name in sys.modules])
"""


def test_a_run_leaves_what_its_page_takes_to_a_process_beside_it(tmp_path):
    assert run_script(PAGE, tmp_path, path=str(ROOT)).splitlines() == ["0", "[]"]
    assert "</html>" in (tmp_path / "out/report.html").read_text()
