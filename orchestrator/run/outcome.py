"""Why a run ended before its time, as data; the sentence is made where it is shown."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from ..notes import Advice


class Kind(Enum):
    """What ended a run; the value is the sentence that says so."""

    NOT_FINITE = "{instance}.{variable} is {why} at t = {time:g} s{said}"
    LOOP = "{why} at t = {time:g} s"
    NOT_CONVERGED = (
        "{instance} do not agree after {evaluations} evaluations of the step from t = {time:g} s: "
        "{variable} {why}; give a shorter step, another method or a larger tolerance"
    )
    REFUSED = "{instance}: {why} in the step from t = {time:g} s{said}"
    ASKED = "{instance} asks to end the run at t = {time:g} s{said}"
    DEPARTED = "{instance} {why} in the step from t = {time:g} s{said}"
    UNWRITTEN = "{why}; stopped at t = {time:g} s"
    INTERRUPTED = "interrupted at t = {time:g} s"
    LEFT = "left at t = {time:g} s"
    FAILED = "{why}"


WAYS: dict[Kind, tuple[dict[str, str], ...]] = {
    Kind.NOT_CONVERGED: ({"step": ""}, {"method": ""}, {"tolerance": ""})
}
"""What helps, as `Advice` has it."""


@dataclass(frozen=True)
class Outcome:
    """What ended a run, and when [s]; of which instance and variable, where it is one of them.

    why: what is specific, in words. said: what the FMU said last. evaluations: of a macro step that
    was repeated in vain.
    """

    kind: Kind
    time: float
    instance: str = ""
    variable: str = ""
    why: str = ""
    said: str = ""
    evaluations: int = 0

    def __str__(self) -> str:
        return Advice(self.kind.value.format(**vars(self)), *WAYS.get(self.kind, ()))
