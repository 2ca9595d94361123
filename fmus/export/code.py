"""C of one block: its equations as CasADi generates them, and the tables that the core reads."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import casadi as ca

from ..describe.block import Block
from ..describe.variables import MAX, Values, Variable, limits
from .dependencies import dependencies
from .tables import array_tables, c_tables

NATIVE = Path(__file__).parent / "native"
QUIET = """\
/* Generated: a function has the arguments of all, and some helpers serve no function here. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
"""
SELECTED = """\
#include <math.h>
/* C's own ask whether an argument is not a number, which costs more than the choice. */
#define fmin(x, y) ((x) < (y) ? (x) : (y))
#define fmax(x, y) ((x) > (y) ? (x) : (y))
"""
EQUATIONS = ("evaluate.c", "states.c")
"""Hand-written files that belong to equations: another model than a block has others instead."""

TABLE_SLOTS = 16
"""Pages of a table that an instance keeps: more than the car's length spans."""


def sources(block: Block, start: Values, fmi: str, guid: str) -> dict[str, str]:
    """All C files of the FMU for a version of FMI by name. start: parameter values [SI]."""
    counts = variable_counts(block) | _equation_counts(block)
    files = frame(block, start, fmi, guid, counts, dependencies(block))
    files |= {name: (NATIVE / name).read_text() for name in EQUATIONS}
    return files | {"equations.h": _equations(block)}


def frame(
    block: Block,
    start: Values,
    fmi: str,
    guid: str,
    counts: Mapping[str, int],
    known: Mapping[str, Sequence[str]],
) -> dict[str, str]:
    """The C files but those of the equations. known: what each calculated variable depends on."""
    files = {path.name: path.read_text() for path in _native(fmi) if path.name not in EQUATIONS}
    files["block.h"] = _header(block, counts)
    files["block.c"] = _variables(block, start)
    files["identity.h"] = f'#define GUID "{guid}"\n'
    if fmi == "3.0":
        files["arrays.c"] = array_tables(block, known)
    return files


def unit_files(fmi: str) -> list[str]:
    """Names of the C files to compile for a version of FMI."""
    names = [path.name for path in _native(fmi) if path.suffix == ".c"]
    # The first file is the same for both: zig recognises what it compiled under that name.
    return ["block.c", *names, *(["arrays.c"] if fmi == "3.0" else [])]


def _native(fmi: str) -> list[Path]:
    """The hand-written files: those of the version itself, and those of both."""
    other = "fmi3" if fmi == "2.0" else "fmi2"
    return [path for path in sorted(NATIVE.glob("*.[ch]")) if not path.name.startswith(other)]


def generated_functions(block: Block) -> dict[str, ca.Function]:
    """The functions that go into the FMU, by the name that the core calls."""
    f = block.functions
    names = ["derived", "initial", "largest_step", "step", "outputs", "forward"]
    if block.continuous:
        names.append("derivative")
    if f.event_indicators.numel_out():
        names.append("event_indicators")
    if block.memory:
        names.append("memory_after")
    if f.transition.numel_out():
        names.append("transition")
    if block.constants:
        names.append("constants")
    if f.has_margin:
        names += ["step_beyond", "outputs_beyond"]
    if block.table:
        names += ["stations", "stations_forward"]
    laws = [*f.output_laws, *f.slope_laws]
    if f.output_laws:
        names.remove("outputs")
    functions = {name: getattr(f, name) for name in names} | {law.name(): law for law in laws}
    return functions | ({"page": block.table.page} if block.table else {})


@lru_cache(maxsize=1)
def _equations(block: Block) -> str:
    generator = ca.CodeGenerator("equations.c", {"include_math": True})
    for name, function in generated_functions(block).items():
        if function.name() != name:
            raise ValueError(f"the function {function.name()!r} must be called {name!r}")
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(folder + "/")
        text = (Path(folder) / "equations.c").read_text()
    laws = {"outputs": block.functions.output_laws, "slopes": block.functions.slope_laws}
    choices = (_chosen(block, name, found) for name, found in laws.items() if found)
    return QUIET + SELECTED + _tightened(_without_queries(text)) + "\n".join(choices)


def _chosen(block: Block, name: str, laws: Sequence[ca.Function]) -> str:
    """A function that calls that of the law which the parameter `switch` chooses."""
    place = [parameter.name == block.switch for parameter in block.parameters].index(True)
    cases = "\n".join(
        f"    case {number}: return {law.name()}(arg, res, iw, w, mem);"
        for number, law in enumerate(laws, start=1)
    )
    return (
        f"static int {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, "
        f"casadi_real* w, int mem) {{\n  switch ((int)arg[2][{place}]) {{\n{cases}\n"
        "    default: return 1;\n  }\n}\n"
    )


def _without_queries(text: str) -> str:
    """The code without CasADi's functions about functions (sparsity, names): nothing calls them."""
    query = re.compile(
        r"CASADI_SYMBOL_EXPORT [^\n]*\b\w+_(?:alloc_mem|init_mem|free_mem|checkout|release|incref|"
        r"decref|n_in|n_out|default_in|name_in|name_out|sparsity_in|sparsity_out|work|work_bytes)"
        r"\([^\n]*\) ?\{(?:[^\n]*\}|\n.*?\n\})\n",
        re.DOTALL,
    )
    return re.sub(r"\n{3,}", "\n\n", query.sub("", text))


def _tightened(text: str) -> str:
    """The code without questions whether an argument or a result was given: the core gives all.

    Its lists are apart in memory, too, which is said with `restrict`: several numbers are then read
    and written at once. What other generated functions call may be asked for some of its results.
    """
    text = re.sub(r"(arg\[\d+\])\? (arg\[\d+\]\[\d+\]) : 0;", r"\2;", text)
    called = set(re.findall(r"if \((casadi_f\d+)\(", text))

    def function(match: re.Match[str]) -> str:
        if match[1] in called:
            return match[0]
        return _apart(match[1], match[2], re.sub(r"if \(res\[\d+\]!=0\) ", "", match[3]))

    return re.sub(
        r"static int (casadi_f\d+)(\(.*?\)) \{\n(.*?)\n\}\n", function, text, flags=re.DOTALL
    )


def _apart(name: str, parameters: str, body: str) -> str:
    """A function of lists of lists as one of the lists; as it was, if it hands them on."""
    element = r"\b(arg|res)\[(\d+)\](?=\[\d+\])"
    own = f"static int {name}{parameters} {{\n{body}\n}}\n"
    if re.search(r"\b(arg|res)\b", re.sub(element, "", body)):
        return own
    lists = sorted({(kind, int(place)) for kind, place in re.findall(element, body)})
    const = {"arg": "const casadi_real", "res": "casadi_real"}
    taken = ", ".join(f"{const[kind]}* restrict {kind}{place}" for kind, place in lists)
    given = ", ".join(f"{kind}[{place}]" for kind, place in lists)
    return (
        f"static int {name}_apart({taken or 'void'}) {{\n"
        + re.sub(element, r"\1\2", body)
        + f"\n}}\n\nstatic int {name}{parameters} {{\n  return {name}_apart({given});\n}}\n"
    )


def variable_counts(block: Block) -> dict[str, int]:
    """Numbers of variables and the like, by their names in C; of equations there are none yet."""
    return {
        "N_PARAMETERS": len(block.parameters),
        "N_INPUTS": len(block.inputs),
        "N_OUTPUTS": len(block.outputs),
        "N_STATES": len(block.states),
        "N_CONTINUOUS": len(block.continuous),
        "N_MEMORY": len(block.memory),
        "N_MODES": len(block.modes),
        "N_LOCALS": len(block.locals),
        "N_CONSTANTS": len(block.constants),
        "N_ARRAYS": len(block.all_arrays),
        "N_LED": len(block.led),
        "HAS_EXCHANGE": 0,
        "TABLE_NODES": 1,
        "TABLE_SLOTS": 1,
        **dict.fromkeys(
            (
                *("N_INDICATORS", "N_DERIVED", "N_TRANSITION", "HAS_MARGIN", "TABLE_STATIONS"),
                *("TABLE_VALUES", "TABLE_PAGE_SIZE", "TABLE_ROWS"),
                *("WORK_ARG", "WORK_RES", "WORK_IW", "WORK_W"),
            ),
            0,
        ),
    }


def _equation_counts(block: Block) -> dict[str, int]:
    functions = generated_functions(block).values()
    table = block.table
    numbers = {
        "N_INDICATORS": block.functions.event_indicators.numel_out(),
        "N_DERIVED": block.functions.derived.numel_out(0),
        "N_TRANSITION": block.functions.transition.numel_out(),
        "HAS_MARGIN": int(block.functions.has_margin),
        "HAS_EXCHANGE": 1,
        "WORK_ARG": max(f.sz_arg() for f in functions),
        "WORK_RES": max(f.sz_res() for f in functions),
        "WORK_IW": max(f.sz_iw() for f in functions),
        "WORK_W": max(f.sz_w() for f in functions),
    }
    if table:
        numbers |= {
            "TABLE_STATIONS": table.station_count,
            "TABLE_VALUES": table.values,
            "TABLE_NODES": table.nodes_per_page,
            "TABLE_PAGE_SIZE": table.values * table.nodes_per_page,
            "TABLE_ROWS": table.rows,
            "TABLE_SLOTS": TABLE_SLOTS,
        }
    return numbers


def _header(block: Block, counts: Mapping[str, int]) -> str:
    lines = [f"#define {name} {value}" for name, value in counts.items()]
    if block.table:
        lines.append(f"#define TABLE_SPACING {block.table.spacing!r}")
    return (
        f"/* Generated from the block {block.name!r}. */\n#ifndef BLOCK_H\n#define BLOCK_H\n"
        + "\n".join(lines)
        + "\n#endif\n"
    )


def _variables(block: Block, start: Values) -> str:
    rows = []
    for parameter in block.parameters:
        low, high = limits(parameter)
        rows.append(
            f'{{"{parameter.name}", "{parameter.unit}", {parameter.kind.upper()}, '
            f"{int(parameter.tunable)}, {start[parameter.name]!r}, {low!r}, {high!r}}}"
        )
    for port in block.inputs:
        rows.append(f'{{"{port.name}", "{port.unit}", REAL, 1, {port.start!r}, {-MAX!r}, {MAX!r}}}')
    calculated = [*block.outputs, *block.locals, *block.constants]
    reference = block.references
    tables = {
        "VariableInfo VARIABLE_INFO": rows,
        "uint32_t REFERENCE": [str(n) for n in range(1 + len(reference))],
        "char *const CALCULATED_NAME": _names(calculated),
        "char *const STATE_NAME": _names(block.states),
        "double STATE_NOMINAL": [repr(float(n)) for n in nominals(block)],
        "uint32_t STATE_REFERENCE": [str(reference[v.name]) for v in block.continuous],
        "uint32_t DERIVATIVE_REFERENCE": [str(reference[v.name]) for v in block.derivatives],
    }
    return c_tables(block, "core.h", tables)


def nominals(block: Block) -> list[float]:
    """Nominal value of each continuous state, which is that of its output."""
    by_name = {output.name: output.nominal for output in block.outputs}
    return [by_name[state.name] or 1.0 for state in block.continuous]


def _names(variables: Sequence[Variable]) -> list[str]:
    return [f'"{v.name}"' for v in variables]
