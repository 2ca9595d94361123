"""Strongly connected parts of a directed graph: who waits for whom, and who for each other."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import TypeVar

Node = TypeVar("Node", bound=Hashable)


def strong_parts(nodes: Sequence[Node], sources: Mapping[Node, Sequence[Node]]) -> list[list[Node]]:
    """The strongly connected parts (Tarjan 1972), each after all that it has a source in.

    sources: by node, the nodes that it waits for. Within a part the nodes stand in the order of
    `nodes`.
    """
    place = {node: n for n, node in enumerate(nodes)}
    number: dict[Node, int] = {}
    low: dict[Node, int] = {}
    stack: list[Node] = []
    found: set[Node] = set()
    parts: list[list[Node]] = []
    for root in nodes:
        if root in number:
            continue
        path: list[tuple[Node, Iterator[Node]]] = []
        following: Node | None = root
        while path or following is not None:
            if following is not None:
                number[following] = low[following] = len(number)
                stack.append(following)
                path.append((following, iter(sources.get(following, ()))))
            node, left = path[-1]
            following = None
            for source in left:
                if source not in number:
                    following = source
                    break
                if source not in found:
                    low[node] = min(low[node], number[source])
            if following is not None:
                continue
            path.pop()
            if path:
                low[path[-1][0]] = min(low[path[-1][0]], low[node])
            if low[node] == number[node]:
                part = []
                while True:
                    part.append(stack.pop())
                    if part[-1] == node:
                        break
                found.update(part)
                parts.append(sorted(part, key=place.__getitem__))
    return parts


def sweep(part: Sequence[Node], sources: Mapping[Node, Sequence[Node]]) -> list[Node]:
    """An order of a part's nodes in which most stand after their sources (depth first)."""
    inside, seen, order = set(part), set(), []
    for root in part:
        path: list[tuple[Node, Iterator[Node]]] = []
        if root not in seen:
            seen.add(root)
            path.append((root, iter(sources.get(root, ()))))
        while path:
            node, left = path[-1]
            following = next((s for s in left if s in inside and s not in seen), None)
            if following is None:
                order.append(node)
                path.pop()
            else:
                seen.add(following)
                path.append((following, iter(sources.get(following, ()))))
    return order
