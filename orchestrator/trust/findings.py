"""What the self-test of an FMU found: plain data, that can be remembered."""

from __future__ import annotations

from dataclasses import dataclass

VERSION = 1
"""Of the checks: results of another version are not used."""

CHECKS = ("units", "determinism", "rollback", "serialisation", "dependencies", "derivatives")
"""What an FMU is tested for."""


@dataclass(frozen=True)
class Finding:
    """What a check found, in words. wrong: an error in the FMU, and no mere remark."""

    check: str
    text: str
    wrong: bool = True


@dataclass(frozen=True)
class SelfTest:
    """Checks that an FMU went through without error, and what was found."""

    label: str
    passed: tuple[str, ...]
    findings: tuple[Finding, ...] = ()

    @property
    def errors(self) -> list[Finding]:
        return [f for f in self.findings if f.wrong]

    def failed(self, check: str) -> bool:
        """Whether a check found an error."""
        return any(f.check == check for f in self.errors)
