"""Where a dataset's numbers come from: its attributes, written and read back."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from math import inf
from typing import Any

from ..fmu.description import Limit
from ..plan.plan import Plan, start_values
from .signals import Responses

PACKAGES = ("tracktrain", "fmpy", "numpy")
"""Those whose versions are written down."""


def provenance(
    plan: Plan, how: Mapping[str, Any], notes: Sequence[str], more: Mapping[str, Any]
) -> dict[str, Any]:
    """Attributes of a dataset: text and numbers as they are, everything else as JSON.

    how: what the run was asked for. more: what was found out about it. None is left out.
    """
    given = {
        **how,
        "parameters": start_values(plan),
        "fmus": {
            name: {"file": d.label, "sha256": d.sha256}
            for name, d in zip(plan.names, plan.descriptions, strict=True)
        },
        "connections": [
            (plan.name(k.source, k.output), plan.name(k.target, k.input))
            for k in (*plan.links, *plan.text_links)
        ],
        "ranges": {
            name: [_stated(limit) for limit in d.limits]
            for name, d in zip(plan.names, plan.descriptions, strict=True)
            if d.limits is not None
        },
        "notes": list(notes),
        **more,
        "versions": _versions(),
    }
    return {
        key: value if isinstance(value, (str, int, float)) else json.dumps(value)
        for key, value in given.items()
        if value is not None
    }


@dataclass(frozen=True)
class Provenance:
    """The attributes of a dataset, read back; what it does not say is empty."""

    attributes: Mapping[str, Any]

    @classmethod
    def of(cls, dataset: Responses) -> Provenance:
        """What a dataset says of itself."""
        return cls(dataset.attrs)

    @cached_property
    def parameters(self) -> dict[str, Any]:
        """Start values that were given, by "instance.variable"."""
        return self.read("parameters", {})

    @cached_property
    def constants(self) -> dict[str, float]:
        """What FMUs calculated of their parameters [their units], by "instance.variable"."""
        return self.read("constants", {})

    @cached_property
    def fmus(self) -> dict[str, dict[str, str]]:
        """File and SHA-256 by instance."""
        return self.read("fmus", {})

    @property
    def connections(self) -> list[tuple[str, str]]:
        """What drives what, each by "instance.variable"."""
        return [(source, target) for source, target in self.read("connections", [])]

    @cached_property
    def ranges(self) -> dict[str, list[Limit]]:
        """What each instance's FMU says that it holds for; without those that say nothing."""
        return {
            name: [Limit(**{**each, "outputs": tuple(each["outputs"])}) for each in limits]
            for name, limits in self.read("ranges", {}).items()
        }

    @property
    def notes(self) -> list[str]:
        """What the run had to say."""
        return self.read("notes", [])

    @property
    def versions(self) -> dict[str, str]:
        """Versions of the packages that made it."""
        return self.read("versions", {})

    @property
    def master(self) -> str:
        """Name of the master."""
        return str(self.attributes.get("master", ""))

    @property
    def step(self) -> float:
        """Macro step [s]; 0 where it is not said."""
        return float(self.attributes.get("step", 0.0))

    def read(self, name: str, missing: Any) -> Any:
        """An attribute that is JSON, or `missing`."""
        text = self.attributes.get(name)
        return missing if text is None else json.loads(text)


def _stated(limit: Limit) -> dict[str, Any]:
    """What a limit states, without what it leaves open: JSON knows no infinity."""
    return {name: v for name, v in asdict(limit).items() if v not in (inf, -inf, "")}


@cache
def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found
