"""What the orchestrator advises, with what to type for it."""

from __future__ import annotations

from orchestrator import Advice


def typed(text: str) -> str:
    """A text; of advice with the options of the command line that do it."""
    if not isinstance(text, Advice) or not text.ways:
        return text
    ways = (
        " ".join(f"--{name.replace('_', '-')} {value}".rstrip() for name, value in way.items())
        for way in text.ways
    )
    return f"{text} ({' or '.join(ways)})"
