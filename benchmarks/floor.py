"""A system's one-pass macro steps as plain C: the same calls of FMUs in the same order, no tables.

The C is written out for one prepared run: every value that goes from a row of the record into an
FMU is a line of its own, every instance and function an address. It is the floor under the macro
loop of the one-pass master, and gives the same rows.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fmus.export.compiler import compile_library, host_target
from orchestrator.masters.coupling import couple
from orchestrator.masters.loop.leads import (
    DERIVED,
    EXTRAPOLATED,
    KNOWN_END,
    LINE,
    Lead,
    leads_of,
    seed_leads,
)
from orchestrator.masters.loop.packets import ascending
from orchestrator.masters.loop.tables import early_columns
from orchestrator.masters.loop.tangents import Call, gather
from orchestrator.plan.order import Batch
from orchestrator.plan.plan import Link, columns_of
from orchestrator.run.context import Context

FUNCTIONS = {
    "reals": ("const uint32_t *", "size_t", "double *"),
    "rates": ("const uint32_t *", "size_t", "const int *", "double *"),
    "step": ("double", "double", "int"),
    "directional": (
        *("const uint32_t *", "size_t", "const uint32_t *", "size_t"),
        *("const double *", "double *"),
    ),
}
"""Types of FMI's functions: the arguments behind the instance."""


class Floor:
    """The C for a run whose instances are initialised; compiled into a folder."""

    def __init__(self, context: Context, folder: Path) -> None:
        self._text = _Text(context)
        source = folder / "floor.c"
        source.write_text(self._text.program())
        library = folder / f"floor{host_target().suffix}"
        compile_library([source], library, host_target(), ("-O2", "-fPIC", "-shared", "-w"))
        self._run = ctypes.CDLL(str(library)).run
        self._run.argtypes = (ctypes.c_long, ctypes.c_double, ctypes.c_double, ctypes.c_void_p)

    def run(self, start: float, step: float, rows: NDArray[np.float64]) -> None:
        """Step from row 1 of the record, at time `start` [s], to the last.

        Raises RuntimeError where an FMU fails.
        """
        if self._run(len(rows) - 2, start, step, rows[1:].ctypes.data):
            raise RuntimeError("an FMU failed in the floor's loop")


class _Text:
    """The lines of the program."""

    def __init__(self, context: Context) -> None:
        self._plan, self._slaves = context.plan, context.slaves
        self._coupling = couple(self._plan)
        self._targets = gather(self._plan, self._coupling)
        self._leads = leads_of(self._plan, self._coupling, self._targets)
        self._seeds = seed_leads(self._plan, self._coupling, self._targets)
        used = {lead.column for group in self._groups() for lead in group if _is_end(lead)}
        used |= {
            self._plan.column_of[n, tangent.output]
            for n, target in enumerate(self._targets)
            for link in target.links
            for tangent in self._coupling.tangents.get(link, [])
        }
        self._early = early_columns(self._plan, used)
        self._lists: list[str] = []

    def _groups(self) -> Iterator[Sequence[Lead]]:
        yield from self._leads
        yield from chain.from_iterable(self._seeds)

    def program(self) -> str:
        """All of it: types, lists of value references, the loop."""
        results = sum(len(call.unknowns) for target in self._targets for call in target.calls)
        moves = [line for slave in self._coupling.order for line in self._step(slave)]
        moves += [line for batch in self._plan.batches for line in self._refresh(batch)]
        types = [
            f"typedef int (*{name})({', '.join(('void *', *arguments))});"
            for name, arguments in FUNCTIONS.items()
        ]
        return "\n".join([
            "#include <stddef.h>",
            "#include <stdint.h>",
            *types,
            *self._lists,
            "int run(long steps, double start, double H, double *now) {",
            f"double v[256], seed[64], result[{results + 1}], *next;",
            "int failed = 0;",
            f"for (long k = 0; k < steps; k++, now += {len(self._plan.columns)}) {{",
            f"next = now + {len(self._plan.columns)};",
            *moves,
            "if (failed) return failed; }",
            "return 0; }",
            "",
        ])  # fmt: skip

    def _call(self, kind: str, name: str, slave: int, *arguments: object) -> str:
        found = self._slaves[slave].addresses
        function, instance = getattr(found, name), found.instance
        given = ", ".join(map(str, (f"(void *){instance}", *arguments)))
        return f"failed |= (({kind}){function})({given});"

    def _list(self, values: Sequence[float], type_: str = "uint32_t") -> str:
        """Name of a list of constants."""
        name = f"list{len(self._lists)}"
        inside = ", ".join(map(repr, values))
        self._lists.append(f"static const {type_} {name}[] = {{{inside}}};")
        return name

    def _step(self, slave: int) -> Iterator[str]:
        target, leads = self._targets[slave], self._leads[slave]
        inputs = [link.input.reference for link in target.links]
        seeds, copied = iter(self._seeds[slave]), list(target.fills)
        for call in target.calls:
            entries = range(call.first_result, call.first_result + len(call.unknowns))
            place = min((place for place, entry, _ in copied if entry in entries), default=0)
            straight = [(place + n, entry, 1.0) for n, entry in enumerate(entries)]
            if set(straight) <= set(copied):
                copied = [fill for fill in copied if fill not in straight]
                result = f"v + {len(inputs) + place}"
            else:
                result = f"result + {call.first_result}"
            yield from self._tangent(call, [] if call.seed else next(seeds), result)
        known = self._plan.descriptions[slave].variables
        references = [*inputs, *(known[name].reference for name in target.partials)]
        yield from self._values(target.links)
        for place, entry, gain in copied:
            yield f"v[{len(inputs) + place}] = {gain!r} * result[{entry}];"
        yield from self._send(slave, references)
        if leads:
            for n, lead in enumerate(leads):
                yield f"v[{n}] = {self._slope(lead)};"
            own = [lead.link.input.reference for lead in leads]
            orders = self._list([1] * len(leads), "int")
            yield self._call("rates", "set_rates", slave, self._list(own), len(own), orders, "v")
        yield self._call("step", "do_step", slave, "start + (double)k * H", "H", 1)
        finals = [lead for lead in leads if lead.second >= 0]
        for n, lead in enumerate(finals):
            slope, begin = self._slope(lead), self._value(lead.link)
            yield f"v[{n}] = {begin} + H * ({slope} + H / 6.0 * {self._bend(lead)});"
        if finals:
            yield from self._send(slave, [lead.link.input.reference for lead in finals])
        first = self._plan.first_column[slave]
        yield from self._read(slave, first, first + self._early[slave])

    def _refresh(self, batch: Batch) -> Iterator[str]:
        links = ascending(self._plan.link_of[batch.instance, name] for name in batch.inputs)
        yield from self._values(links, "next")
        yield from self._send(batch.instance, [link.input.reference for link in links])
        yield from self._read(batch.instance, *columns_of(self._plan, batch))

    def _tangent(self, call: Call, seeds: Sequence[Lead], result: str) -> Iterator[str]:
        known = self._plan.descriptions[call.source].variables
        unknowns = self._list([known[name].reference for name in call.unknowns])
        knowns = self._list([link.input.reference for link in call.knowns])
        seed = self._list(call.seed, "double") if call.seed else "seed"
        for n, lead in enumerate(seeds):
            yield f"seed[{n}] = {self._slope(lead)};"
        counts = len(call.unknowns), len(call.knowns)
        yield self._call(
            *("directional", "directional", call.source),
            *(unknowns, counts[0], knowns, counts[1], seed, result),
        )

    def _slope(self, lead: Lead) -> str:
        """C of the slope of an input's line over the step."""
        if lead.shape != LINE:
            raise NotImplementedError("the floor leads inputs along lines only")
        gain, column, width = f"{lead.link.gain!r} *", lead.column, len(self._plan.columns)
        if lead.kind == KNOWN_END:
            return f"({gain} ((next[{column}] - now[{column}]) / H))"
        if lead.kind == DERIVED:
            return f"({gain} result[{lead.rate}])"
        if lead.kind == EXTRAPOLATED:
            return f"({gain} ((now[{column}] - now[{column - width}]) / H))"
        bent = f" + H / 3.0 * {self._bend(lead)}" if lead.second >= 0 else ""
        return f"({gain} ({lead.rate_gain!r} * now[{lead.rate}]){bent})"

    def _bend(self, lead: Lead) -> str:
        return f"({lead.link.gain!r} * ({lead.second_gain!r} * now[{lead.second}]))"

    def _value(self, link: Link, row: str = "now") -> str:
        column = self._plan.column_of[link.source, link.output.name]
        shift = f" + {link.offset!r}" if link.offset else ""
        return f"({link.gain!r} * {row}[{column}]{shift})"

    def _values(self, links: Sequence[Link], row: str = "now") -> Iterator[str]:
        for n, link in enumerate(links):
            yield f"v[{n}] = {self._value(link, row)};"

    def _send(self, slave: int, references: Sequence[int]) -> Iterator[str]:
        if references:
            listed = self._list(references)
            yield self._call("reals", "set_real", slave, listed, len(references), "v")

    def _read(self, slave: int, first: int, last: int) -> Iterator[str]:
        """Read columns into the next row."""
        if first < last:
            references = self._list([v.reference for _, v in self._plan.columns[first:last]])
            yield self._call(
                "reals", "get_real", slave, references, last - first, f"next + {first}"
            )


def _is_end(lead: Lead) -> bool:
    return lead.kind == KNOWN_END
