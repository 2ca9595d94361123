"""`python -m tracktrain`: the command of the same name."""

from __future__ import annotations

from .cli.main import main

if __name__ == "__main__":
    main(prog_name="tracktrain")
