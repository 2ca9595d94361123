"""Build hook: a wheel carries the FMUs of the platform it is built on."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class FmuBuildHook(BuildHookInterface):
    """Builds the FMUs with the same code as `tracktrain build`."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from fmus.catalogue import build_into

        place = Path(self.root) / "fmus" / "built"
        build_into(place)
        build_data["artifacts"].append("fmus/built/*")
        build_data["pure_python"] = False
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
