"""A wait says what it is for, once it is one."""

from __future__ import annotations

import threading

from tracktrain.waiting import announced


def test_a_wait_is_announced_in_its_own_words():
    said, heard = [], threading.Event()

    def say(what: str) -> None:
        said.append(what)
        heard.set()

    with announced("building", patience=0.0, say=say):
        assert heard.wait(60)
    with announced("what is over at once", patience=3600.0, say=say):
        pass
    assert said == ["building"]
