"""Couples FMUs at fixed macro steps, and says how far the answer can be trusted.

system = System({"a": Component(Path("a.fmu")), "b": Component(Path("b.fmu"))},
                (Connection("a.force", "b.force"), Connection("b.v", "a.v")))
run = simulate(system, duration=8.0, step=1e-3)
run.dataset["b.v"].plot()

The public names stand in `__init__.pyi`. Each is loaded when it is first asked for: compiled loops
and datasets take their time, and a command line wants its help at once.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
