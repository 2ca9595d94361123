"""Fixtures that all tests share: the four FMUs of this checkout, and instances of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from hypothesis import settings

from fmus.catalogue import fmu_path
from support.blocks import EACH_BLOCK
from support.fmu_instance import FmuInstance

# a busy machine takes ten times as long, and that is no finding
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")


@pytest.fixture
def instantiate() -> Iterator[Callable[..., FmuInstance]]:
    """Instantiate a block's FMU by name; all are freed when the test ends."""
    open_instances: list[FmuInstance] = []

    def make(block: str, name: str = "instance", **kind: bool) -> FmuInstance:
        open_instances.append(FmuInstance(fmu_path(block), name, **kind))
        return open_instances[-1]

    yield make
    for instance in open_instances:
        instance.close()


@pytest.fixture(params=EACH_BLOCK)
def block_name(request: pytest.FixtureRequest) -> str:
    return request.param
