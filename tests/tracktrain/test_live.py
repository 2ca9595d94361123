"""A run under way, as its page is told of it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from http.client import HTTPConnection, HTTPResponse
from threading import Thread
from urllib.parse import urlencode

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator import simulate
from support.coupled_models import oscillator
from tracktrain.cli.main import main
from tracktrain.errors import TracktrainError
from tracktrain.live import HOST, Live
from tracktrain.live.history import BINS, History


def asked(live: Live, path: str, host: str = HOST) -> HTTPResponse:
    connection = HTTPConnection(HOST, int(live.address.rsplit(":", 1)[1].strip("/")))
    connection.request("GET", path, headers={"Host": host})
    return connection.getresponse()


def told(response: HTTPResponse) -> Iterator[tuple[str, dict]]:
    """Events and what comes with them."""
    event = ""
    for line in response:
        name, _, text = line.decode().strip().partition(": ")
        event = text if name == "event" else event
        if name == "data":
            yield event, json.loads(text)


@pytest.mark.parametrize("rows", [1, BINS - 1, BINS + 1, 7 * BINS + 3])
def test_no_peak_is_lost_however_long_a_run_gets(rows: int) -> None:
    rng = np.random.default_rng(rows)
    table = np.column_stack([np.arange(rows, dtype=float), rng.normal(size=(rows, 2))])
    history = History(2)
    for part in np.array_split(table, rng.integers(1, min(rows, 40) + 1)):
        history.add(part)
    for column in (0, 1):
        own = table[:, 1 + column]
        assert history.reach(column) == (own.min(), own.max())
        time, values = history.curve(column)
        assert len(time) == len(values) <= 2 * BINS + 1
        assert np.all(np.diff(time) >= 0.0) and (time[-1], values[-1]) == (rows - 1, own[-1])


def test_a_page_hears_of_every_signal_until_the_run_is_over() -> None:
    with Live() as live:
        run = Thread(target=lambda: simulate(oscillator(), duration=3.0, step=0.01, sinks=[live]))
        run.start()
        page = asked(live, "/").read().decode()
        events = asked(live, "/messages?" + urlencode({"of": ["one.x", "no.such"]}, doseq=True))
        run.join()
        live.close()
        heard = list(told(events))
    assert '"name":"other.force"' in page and "://" not in page.replace("http://www.w3.org", "")
    name, last = heard[-1]
    assert name == "end" and last["said"] == "" and last["rows"] == 301
    assert (last["time"], last["stop"]) == (pytest.approx(3.0), pytest.approx(3.0))
    assert list(last["curves"]) == ["one.x"] and len(last["curves"]["one.x"]["x"]) == 302


def test_only_this_machine_is_answered_and_only_by_its_own_name() -> None:
    with Live() as live:
        live.close()
        assert live.address.startswith(f"http://{HOST}:")
        assert asked(live, "/", host="example.org").status == 403
        assert asked(live, "/else").status == 404
        with pytest.raises(TracktrainError, match="no page can be served at port"):
            Live(int(live.address.rsplit(":", 1)[1].strip("/")))


def test_a_run_that_ends_lets_its_page_and_port_go(tmp_path) -> None:
    out = ["--out", str(tmp_path), "--quiet", "--track", "perfect", "--duration", "0.1 s"]
    result = CliRunner().invoke(main, ["run", *out, "--live"])
    assert result.exit_code == 0, result.output
    assert "the run is over, and its page with it" in result.output
    address = result.output.partition(HOST)[2].split("/")[0].strip(":")
    with pytest.raises(ConnectionRefusedError):
        HTTPConnection(HOST, int(address)).connect()
