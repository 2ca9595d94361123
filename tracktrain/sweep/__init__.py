"""Many runs of the hopper car: a grid over anything, on all cores or a cluster, one table out.

from tracktrain.sweep import sweep
table = sweep({"speed": "60:100:20 ft/s", "seed": "1:10"}, out="my-sweep")
table["wheelset_11.force_y.rms"].median("seed").plot()

In a script stand these lines under `if __name__ == "__main__":`, as worker processes import it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .grid import sweep

__all__ = ["sweep"]


def __getattr__(name: str) -> Any:
    if name == "sweep":  # only then is all that it needs imported
        from .grid import sweep

        return sweep
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
