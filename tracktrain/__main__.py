"""`python -m tracktrain`: the command of the same name."""

from __future__ import annotations

import signal


def start() -> None:
    """The command. Ctrl-C while its modules load just ends it: nothing is under way."""
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if heard:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from .cli.main import main

    if heard:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    main(prog_name="tracktrain")


if __name__ == "__main__":
    start()
