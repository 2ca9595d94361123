"""Instances that stay loaded between runs, and are reset instead of loaded anew."""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from ..fmu.description import Description
from ..plan.plan import Plan
from ..system.profile import Profile
from ..system.system import System
from .base import Slave
from .departure import departing
from .isolated.slave import IsolatedSlave
from .listener import Listener
from .loading import load, unzip
from .profile import ProfileSlave
from .surroundings import kept


def _loaded(name: str, description: Description, folder: Path, listener: Listener | None) -> Slave:
    """An instance in this process, which finds its surroundings as they were."""
    changed: list[str] = []
    with (
        kept(changed.extend),
        departing(lambda did: f"{name} ({description.label}) {did} while it was loaded"),
    ):
        slave = load(name, description, folder, listener)
    slave.disturbed.update(dict.fromkeys(changed))
    return slave


class Session:
    """Keeps what one run has loaded for the next.

    with Session() as session:
        runs = [simulate(system.with_value("track.seed", n), session=session) for n in range(9)]

    An instance is reset (fmi2Reset) where the next run has the same FMU under the same name; one
    that failed, that logs, runs in a process of its own or is called through adaptors is loaded
    anew. Not for several threads at once.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._folder: Path | None = None
        self._unzipped: dict[tuple[Path, str], Path] = {}
        self._idle: dict[str, Slave] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Free all instances, and remove what was unzipped."""
        for slave in self._idle.values():
            slave.close()
        self._idle.clear()
        self._unzipped.clear()
        self._folder = None
        self._stack.close()

    def slaves(
        self,
        system: System,
        plan: Plan,
        stack: ExitStack,
        listener: Listener | None,
        isolate: Sequence[str],
        timeout: float,
    ) -> list[Slave]:
        """Instances of all components; the stack frees those that are not kept."""
        ready = self._reset(plan, set(plan.names) - set(isolate) if listener is None else ())
        slaves: list[Slave] = []
        for name, component, description in zip(
            plan.names, system.components.values(), plan.descriptions, strict=True
        ):
            slave: Slave
            if isinstance(component.fmu, Profile):
                slave = ProfileSlave(name, component.fmu)
            elif not isinstance(component.fmu, Path):
                slave = component.fmu.slave(name)
            elif name in ready:
                slave = ready[name]
            elif name in isolate:
                folder = self._unzip(component.fmu, description)
                slave = IsolatedSlave(name, description, folder, listener, timeout)
            else:
                folder = self._unzip(component.fmu, description)
                slave = _loaded(name, description, folder, listener)
            stack.callback(self._release, slave)
            slaves.append(slave)
        for slave in slaves:
            slave.ready()
            if listener is not None and listener.debug:
                slave.debug(listener.categories)
        return slaves

    def keep(self, slaves: Sequence[Slave]) -> None:
        """Have instances whose run is over ready for the next."""
        self._idle |= {slave.name: slave for slave in slaves}

    def _reset(self, plan: Plan, names: Collection[str]) -> dict[str, Slave]:
        """Of the idle instances those that can be used again, by name; the others are freed."""
        described = dict(zip(plan.names, plan.descriptions, strict=True))
        found: dict[str, Slave] = {}
        idle, self._idle = self._idle, {}
        for name, slave in idle.items():
            if name in names and described[name] == slave.description and slave.reset():
                found[name] = slave
            else:
                slave.close()
        return found

    def _release(self, slave: Slave) -> None:
        if self._idle.get(slave.name) is not slave:
            slave.close()

    def _unzip(self, path: Path, description: Description) -> Path:
        if self._folder is None:
            self._folder = Path(
                self._stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
            )
        place = (path.resolve(), description.sha256)
        if place not in self._unzipped:
            folder = self._folder / str(len(self._unzipped))
            self._unzipped[place] = unzip(path, description, folder)
        return self._unzipped[place]
