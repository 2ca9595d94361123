"""What each calculated variable of a block depends on, read off the sparsity of its equations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise

import casadi as ca

from ..describe.block import Block


@lru_cache(maxsize=1)
def dependencies(block: Block) -> dict[str, list[str]]:
    """Inputs and continuous states on which each output and each derivative depends directly."""
    continuous = ca.MX.sym("continuous", len(block.continuous))
    memory = ca.MX.sym("memory", len(block.memory))
    u, p = (ca.MX.sym("v", len(v)) for v in (block.inputs, block.parameters))
    d = ca.MX.sym("d", block.functions.derived.numel_out(0))
    x = ca.vertcat(continuous, memory)
    branches, rates = _dependence(block, ca.vertcat(u, continuous), [memory, p, d], x, u, p, d)
    known = [v.name for v in (*block.inputs, *block.continuous)]
    return _named(block, _union(branches), rates, known)


@lru_cache(maxsize=1)
def initial_dependencies(block: Block) -> dict[str, list[str]]:
    """Parameters and inputs that the first value of each output, derivative and constant needs."""
    f = block.functions
    u, p = (ca.MX.sym("v", len(v)) for v in (block.inputs, block.parameters))
    d = f.derived(p)
    branches, rates = _dependence(block, ca.vertcat(p, u), [], f.initial(p, d, u), u, p, d)
    needs = _union(branches)
    if block.switch:
        switch = [parameter.name for parameter in block.parameters].index(block.switch)
        for output, need in enumerate(needs):
            if any(branch[output] != branches[0][output] for branch in branches):
                needs[output] = sorted({*need, switch})
    known = [v.name for v in (*block.parameters, *block.inputs)]
    constants = _rows(ca.Function("chain", [p], [f.constants(p, d)]).jac_sparsity(0, 0))
    return _named(block, needs, rates, known) | {
        v.name: [known[n] for n in numbers]
        for v, numbers in zip(block.constants, constants, strict=True)
    }


def _dependence(
    block: Block, at: ca.MX, others: list[ca.MX], x: ca.MX, u: ca.MX, p: ca.MX, d: ca.MX
) -> tuple[list[list[list[int]]], list[list[int]]]:
    """Entries of `at` that each output needs, by branch, and those that each derivative needs."""
    f, table, lookup = block.functions, block.table, ca.MX(0, 0)
    if table:
        nodes = table.page(0, d)[:, 0]
        stations = ca.vertsplit(f.stations(x, u, p, d))
        lookup = ca.horzcat(*(ca.vertcat(station, nodes, nodes) for station in stations))

    def rows(expression: ca.MX) -> list[list[int]]:
        return _rows(ca.Function("chain", [at, *others], [expression]).jac_sparsity(0, 0))

    branches = [rows(branch(x, u, p, d, lookup)) for branch in block.output_branches()]
    return branches, rows(f.derivative(x, u, p, d))


def _named(
    block: Block, outputs: list[list[int]], rates: list[list[int]], known: Sequence[str]
) -> dict[str, list[str]]:
    unknowns = [*block.derivatives, *block.outputs]
    pairs = zip(unknowns, [*rates, *outputs], strict=True)
    return {v.name: [known[n] for n in numbers] for v, numbers in pairs}


def _rows(sparsity: ca.Sparsity) -> list[list[int]]:
    """The columns with an entry, for each row."""
    transposed = sparsity.T
    ends = transposed.colind()
    return [list(transposed.row()[a:b]) for a, b in pairwise(ends)]


def _union(branches: Iterable[list[list[int]]]) -> list[list[int]]:
    """Row by row, what any of the branches has."""
    return [sorted(set().union(*rows)) for rows in zip(*branches, strict=True)]
