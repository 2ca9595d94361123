"""A running table: its outputs follow the time."""

from __future__ import annotations

import struct

from ..errors import SlaveError
from ..system.profile import Profile
from .inline import InlineModel, InlineSlave

_TIME = struct.Struct("<d")


class ProfileSlave(InlineSlave):
    """A profile behind the same C functions as an FMU's; its state is the time [s]."""

    def __init__(self, name: str, profile: Profile) -> None:
        names = (profile.name, profile.rate)
        model = InlineModel(
            outputs=dict.fromkeys(names, "1"),
            step=lambda x, u, rate, p, time, step: time + step,
            output=lambda x, u, p: dict(zip(names, profile.at(x), strict=True)),
        )
        super().__init__(name, model)
        self.description = profile.description
        self._profile = profile

    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        self._profile.check_span(self.name, time, stop)
        self._x = time

    def state(self) -> bytes:
        return _TIME.pack(self._x)

    def restore(self, state: bytes) -> None:
        if len(state) != _TIME.size:
            raise SlaveError(f"{self.name}: its saved state is none of a table")
        (self._x,) = _TIME.unpack(state)
