"""The fixtures of these tests: instances of the blocks' FMUs for both versions of FMI."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from fmus.catalogue import fmu_path
from support.fmi3_instance import INSTANCE


@pytest.fixture(params=INSTANCE)
def fmi(request: pytest.FixtureRequest) -> str:
    """A version of FMI."""
    return request.param


@pytest.fixture
def instances() -> Iterator[Callable[..., Any]]:
    """Instantiate a block's FMU by name and version; all are freed when the test ends."""
    open_instances: list[Any] = []

    def make(block: str, fmi: str, name: str = "instance", **kind: bool) -> Any:
        open_instances.append(INSTANCE[fmi](fmu_path(block, fmi), name, **kind))
        return open_instances[-1]

    yield make
    for instance in open_instances:
        instance.close()


@pytest.fixture
def instantiate(instances: Callable[..., Any], fmi: str) -> Callable[..., Any]:
    """Instantiate a block's FMU by name, in each version."""
    return lambda block, name="instance": instances(block, fmi, name)


@pytest.fixture
def instantiate2(instances: Callable[..., Any]) -> Callable[..., Any]:
    """The same for what FMI 2.0 alone has."""
    return lambda block, name="instance", **kind: instances(block, "2.0", name, **kind)
