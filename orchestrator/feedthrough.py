"""Outputs that depend on inputs at the same instant: in which order they are to be read again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

Port = tuple[int, str]
"""Instance and variable."""


@dataclass(frozen=True)
class Batch:
    """Inputs of one instance to be set, then outputs of it to be read."""

    instance: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def evaluation_order(
    outputs: Iterable[Port],
    depends: Mapping[Port, frozenset[str]],
    driver: Mapping[Port, Port],
) -> tuple[list[Batch], list[list[Port]]]:
    """Batches in which every output with feedthrough is read after all that it depends on.

    outputs: all outputs that are read. depends: inputs of its instance on which an output depends.
    driver: the output that drives a connected input.
    Also returns the algebraic loops, each as its outputs in order. A loop is not solved: one pass
    in the order of the batches goes through it.
    """
    needs: dict[Port, dict[str, Port]] = {}
    for instance, output in outputs:
        found = {
            name: driver[instance, name]
            for name in sorted(depends.get((instance, output), ()))
            if (instance, name) in driver
        }
        if found:
            needs[instance, output] = found
    pending, batches, loops = dict(needs), [], []
    while pending:
        ready: dict[int, list[str]] = {}
        for (instance, output), sources in pending.items():
            if not any(source in pending for source in sources.values()):
                ready.setdefault(instance, []).append(output)
        if not ready:
            loop = _loop(pending)
            loops.append(loop)
            ready[loop[0][0]] = [loop[0][1]]
        left = {i: sum(port[0] == i for port in pending) - len(names) for i, names in ready.items()}
        # An instance whose outputs can all be read now is evaluated only once.
        instance = min(ready, key=lambda i: (left[i], i))
        names = ready[instance]
        inputs = dict.fromkeys(name for o in names for name in needs[instance, o])
        batches.append(Batch(instance, tuple(inputs), tuple(names)))
        for name in names:
            del pending[instance, name]
    return batches, loops


def _loop(pending: Mapping[Port, Mapping[str, Port]]) -> list[Port]:
    """A cycle among outputs each of which waits for another one."""
    path: list[Port] = [next(iter(pending))]
    while True:
        following = next(s for s in pending[path[-1]].values() if s in pending)
        if following in path:
            return path[path.index(following) :][::-1]
        path.append(following)
