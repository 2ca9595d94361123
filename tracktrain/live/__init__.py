"""A run under way in a browser: a page on this machine that shows its values while they are made.

with Live() as live:
    print(live.address)
    run = simulate(system, duration="60 s", real_time=1.0, sinks=[live])
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Condition, Event, Thread
from types import TracebackType
from typing import Any, Self
from urllib.parse import parse_qs, urlsplit

import numpy as np
from numpy.typing import NDArray

from orchestrator import Header

from ..car.hopper import layout_by
from ..errors import TracktrainError
from ..quantities import shown_unit
from ..report import as_json
from ..report.rendering import rendered
from .history import History

HOST = "127.0.0.1"
TICK = 0.25
"""Wall time between two messages to a page [s]."""

PATIENCE = 2.0
"""Wall time that open pages get to hear of the end [s]."""

MOST = 12
"""Signals of which a page is sent the curves."""

SCRIPTS = ("common.js", "data.js", "chart.js", "plots.js", "live.js")


class Live:
    """A sink, and the server of a page that shows what it was given.

    port: 0 for a free one. Raises TracktrainError for one that is taken. Only this machine reaches
    the page, and it changes nothing.
    """

    due = TICK

    def __init__(self, port: int = 0) -> None:
        self._begun, self._ended = Event(), Event()
        self._streams, self._idle = 0, Condition()
        self._said = ""
        try:
            self._server = ThreadingHTTPServer((HOST, port), _handler(self))
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise TracktrainError(
                f"no page can be served at port {port}: {reason}; give no number for a free one"
            ) from None
        self._server.daemon_threads = True

    @property
    def address(self) -> str:
        """Of the page."""
        return f"http://{HOST}:{self._server.server_port}/"

    def __enter__(self) -> Self:
        Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        """Tell open pages that it is over, and stop."""
        self.close()
        with self._idle:
            self._idle.wait_for(lambda: not self._streams, PATIENCE)
        self._server.shutdown()
        self._server.server_close()

    def begin(self, header: Header) -> None:
        """Be ready for the first row."""
        said = header.attributes
        step = float(said.get("step", 0.0)) * int(said.get("every", 1))
        start = float(said.get("start", 0.0))
        self._span = start, start + step * max(header.rows - 1, 0)
        self._variables = list(header.variables)
        self._numbers = {name: n for n, (name, _) in enumerate(self._variables)}
        self._history, self._clock = History(len(self._variables)), time.perf_counter()
        self._begun.set()

    def append(self, rows: NDArray[np.float64]) -> None:
        """Take rows as they are made."""
        self._history.add(rows)

    def finish(self, said: Mapping[str, str | None]) -> None:
        """No more rows come."""
        self._said = said.get("stopped") or ""

    def close(self) -> None:
        """Let pages know that it is over."""
        self._ended.set()
        self._begun.set()

    def page(self) -> str:
        """The text of the page, once it is known what is run."""
        self._begun.wait()
        signals = [
            {"name": name, "text": v.description or "", "unit": v.unit or "1", "factor": 1.0}
            for name, v in getattr(self, "_variables", [])
        ]
        names = [str(signal["name"]) for signal in signals]
        usual = [shown.variable for shown in layout_by(names).quantities.values()]
        first = [name for name in usual if name in names][:2] or names[:3]
        known = {"signals": signals, "first": first, "events": []}
        return rendered(
            "live.html", SCRIPTS, title="A run under way", known=as_json(known), live=True
        )

    def messages(self, names: list[str]) -> Iterator[str]:
        """What a page that shows these signals is told, until the run is over."""
        with self._idle:
            self._streams += 1
        try:
            self._begun.wait()
            while not self._ended.wait(TICK):
                yield self._told("now", names)
            yield self._told("end", names)
        finally:
            with self._idle:
                self._streams -= 1
                self._idle.notify_all()

    def _told(self, event: str, names: list[str]) -> str:
        history, clock = self._history, time.perf_counter() - self._clock
        known = [name for name in names if name in self._numbers][:MOST]
        now, (start, stop) = float(history.last[0]), self._span
        passed = now - start if np.isfinite(now) else 0.0
        told: dict[str, Any] = {
            "time": start + passed,
            "start": start,
            "stop": stop,
            "speed": passed / max(clock, 1e-9),
            "rows": history.rows,
            "said": self._said,
            "curves": {name: self._curve(name) for name in known} if history.rows else {},
        }
        return f"event: {event}\ndata: {json.dumps(told, separators=(',', ':'))}\n\n"

    def _curve(self, name: str) -> dict[str, Any]:
        number = self._numbers[name]
        time, values = self._history.curve(number)
        low, high = self._history.reach(number)
        variable = self._variables[number][1]
        unit, factor = shown_unit(variable.unit or "1", max(abs(low), abs(high)))
        return {
            "x": _finite(time, 7),
            "y": _finite(factor * values, 5),
            "unit": unit,
            "least": _finite(np.array([factor * low]), 5)[0],
            "largest": _finite(np.array([factor * high]), 5)[0],
        }


def _finite(values: NDArray[np.float64], digits: int) -> list[float | None]:
    """For JSON, which knows no other numbers."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in values.tolist()]


def _handler(live: Live) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        """Gives the page at /, and its messages at /messages?of=SIGNAL&of=..."""

        def do_GET(self) -> None:
            place = urlsplit(self.path)
            if self.headers.get("Host", "").partition(":")[0] not in (HOST, "localhost"):
                self.send_error(403)  # a page of elsewhere that has this address looked up
            elif place.path == "/":
                self._give("text/html; charset=utf-8")
                self._write(live.page())
            elif place.path == "/messages":
                self._give("text/event-stream")
                for message in live.messages(parse_qs(place.query).get("of", [])):
                    if not self._write(message):
                        break
            else:
                self.send_error(404)

        def _give(self, kind: str) -> None:
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.send_header("Cache-Control", "no-store")
            self.end_headers()

        def _write(self, text: str) -> bool:
            """Whether someone still listens."""
            try:
                self.wfile.write(text.encode())
                self.wfile.flush()
            except OSError:
                return False
            return True

        def log_message(self, format: str, *args: Any) -> None:
            """Say nothing in the terminal of the run."""

    return Handler
