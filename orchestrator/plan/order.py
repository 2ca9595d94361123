"""Outputs that depend on inputs at the same instant: in which order they are to be read again."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from .graph import strong_parts, sweep

Port = tuple[int, str]
"""Instance and variable."""


@dataclass(frozen=True)
class Batch:
    """Inputs of one instance to be set, then outputs of it to be read."""

    instance: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True)
class Loop:
    """An algebraic loop: the batches from `first` up to `last`, gone through until they agree.

    guessed: the outputs that are used before they are read.
    """

    first: int
    last: int
    guessed: tuple[Port, ...]


def evaluation_order(
    outputs: Iterable[Port],
    depends: Mapping[Port, frozenset[str]],
    driver: Mapping[Port, Port],
) -> tuple[list[Batch], list[Loop]]:
    """Batches in which every output with feedthrough is read after all that it depends on.

    outputs: all outputs that are read. depends: inputs of its instance on which an output depends.
    driver: the output that drives a connected input.
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
    sources = {port: [s for s in found.values() if s in needs] for port, found in needs.items()}
    parts = strong_parts(list(needs), sources)
    part_of = {port: n for n, part in enumerate(parts) for port in part}
    waiting = [
        {part_of[s] for port in part for s in sources[port]} - {n} for n, part in enumerate(parts)
    ]
    waiters: dict[int, list[int]] = {}
    for n, others in enumerate(waiting):
        for other in others:
            waiters.setdefault(other, []).append(n)
    batches: list[Batch] = []
    loops: list[Loop] = []
    left: dict[int, int] = {}  # by instance: outputs still to be read and not ready
    for instance, _ in needs:
        left[instance] = left.get(instance, 0) + 1
    ready: dict[int, list[int]] = {}
    ready_loops: list[int] = []
    heap: list[tuple[int, int]] = []

    def release(n: int) -> None:
        (instance, _), *others = parts[n]
        if others or parts[n][0] in sources[parts[n][0]]:
            heapq.heappush(ready_loops, n)
            return
        ready.setdefault(instance, []).append(n)
        left[instance] -= 1
        heapq.heappush(heap, (left[instance], instance))

    def read(done: Iterable[int]) -> None:
        for n in done:
            for waiter in waiters.get(n, ()):
                waiting[waiter].discard(n)
                if not waiting[waiter]:
                    release(waiter)

    for n, others in enumerate(waiting):
        if not others:
            release(n)
    while heap or ready_loops:
        # An instance whose outputs can all be read now is evaluated only once.
        while heap and (heap[0][1] not in ready or heap[0][0] != left[heap[0][1]]):
            heapq.heappop(heap)
        if heap:
            instance = heapq.heappop(heap)[1]
            done = ready.pop(instance)
            batches.append(_batch(instance, [parts[n][0][1] for n in done], needs))
            read(done)
        elif ready_loops:
            n = heapq.heappop(ready_loops)
            loop_batches, guessed = _around(parts[n], sources, needs)
            loops.append(Loop(len(batches), len(batches) + len(loop_batches), guessed))
            batches += loop_batches
            for instance, _ in parts[n]:
                left[instance] -= 1
                if instance in ready:
                    heapq.heappush(heap, (left[instance], instance))
            read([n])
    return batches, loops


def _batch(instance: int, names: list[str], needs: Mapping[Port, Mapping[str, Port]]) -> Batch:
    inputs = dict.fromkeys(name for output in names for name in needs[instance, output])
    return Batch(instance, tuple(inputs), tuple(names))


def _around(
    part: list[Port], sources: Mapping[Port, list[Port]], needs: Mapping[Port, Mapping[str, Port]]
) -> tuple[list[Batch], tuple[Port, ...]]:
    """Batches of a loop, one for each instance, and the outputs to be guessed for them."""
    outputs: dict[int, list[str]] = {}
    for instance, name in part:
        outputs.setdefault(instance, []).append(name)
    inside = set(part)
    instances = {
        instance: list(
            dict.fromkeys(s[0] for name in names for s in sources[instance, name] if s in inside)
        )
        for instance, names in outputs.items()
    }
    order = sweep(list(instances), instances)
    place = {instance: n for n, instance in enumerate(order)}
    guessed = dict.fromkeys(
        source
        for port in part
        for source in sources[port]
        if source in inside and place[source[0]] >= place[port[0]]
    )
    return [_batch(i, outputs[i], needs) for i in order], tuple(guessed)
