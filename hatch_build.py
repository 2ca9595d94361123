"""Build hook: a wheel carries the FMUs and the macro loops of the platform it is built on."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class NativeBuildHook(BuildHookInterface):
    """Builds both with the code that a checkout builds them with."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from fmus.catalogue import build_into as build_fmus
        from orchestrator.compiled.library import build_into as build_loops

        places = {build_fmus: "fmus/built", build_loops: "orchestrator/built"}
        for build, place in places.items():
            build(Path(self.root) / place)
            build_data["artifacts"].append(f"{place}/*")
        build_data["pure_python"] = False
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["tag"] = f"py3-none-{platform}"
