"""What a run says beside its numbers."""

from __future__ import annotations


class Detail(str):
    """A note of how the answer was computed, for who asks; what has to be known is a plain one."""
