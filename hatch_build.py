"""Build hook: a wheel carries the FMUs and the macro loops of one platform.

It is this machine's, or the one that TRACKTRAIN_TARGET names, as `tracktrain build --target` does.
"""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

TAGS = {
    "linux-x86_64": "manylinux_2_17_x86_64",
    "linux-aarch64": "manylinux_2_17_aarch64",
    "windows-x86_64": "win_amd64",
    "macos-x86_64": "macosx_11_0_x86_64",
    "macos-arm64": "macosx_11_0_arm64",
}
"""What a wheel calls the platforms that zig builds for."""


class NativeBuildHook(BuildHookInterface):
    """Builds both with the code that a checkout builds them with."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        sys.path.insert(0, self.root)
        from fmus.catalogue import build_into as build_fmus
        from fmus.export.compiler import host_target, targets
        from fmus.names import NAMES
        from orchestrator.compiled.compiler import PLATFORMS
        from orchestrator.compiled.library import build_into as build_loops

        (target,) = targets([os.environ.get("TRACKTRAIN_TARGET", "host")])
        loops = next(known for known in PLATFORMS.values() if known.zig == target.zig)
        # This machine's go into the checkout, which then has them; another's stay out of it.
        own = target == host_target()
        self.made_in = None if own else Path(tempfile.mkdtemp())
        place = self.made_in or Path(self.root)
        build_fmus(place / "fmus/built", NAMES, target.name)
        build_loops(place / "orchestrator/built", loops)
        for folder in ("fmus/built", "orchestrator/built"):
            if own:
                build_data["artifacts"].append(f"{folder}/*")
            else:
                build_data["force_include"][str(place / folder)] = folder
        build_data["pure_python"] = False
        by_zig = not own or find_spec("ziglang")
        build_data["tag"] = f"py3-none-{TAGS[target.name] if by_zig else _of_this_system()}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        if self.made_in:
            shutil.rmtree(self.made_in)


def _of_this_system() -> str:
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")
