"""The variables of an FMU as its model description lists them, whatever FMI's version."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

from ...describe.block import Block
from ...describe.variables import Array, Output, Parameter, Values, Variable, limits
from ...model import Model

T = TypeVar("T")


@dataclass(frozen=True)
class ModelVariable:
    """One variable: a scalar, or an array of the scalars called `members`.

    kind: real, integer, boolean or enumeration. `start` and `bounds` are text, as in the XML;
    `derivative_of` is the name of the variable that this one is the rate of. An array of
    different units has none.
    """

    name: str
    reference: int
    description: str
    causality: str
    variability: str
    initial: str | None
    kind: str = "real"
    unit: str | None = None
    nominal: float | None = None
    start: str | None = None
    bounds: Mapping[str, str] = field(default_factory=dict)
    derivative_of: str | None = None
    shape: tuple[int, ...] = ()
    members: tuple[str, ...] = ()


def scalars(
    block: Block | Model, start: Values, at_start: Mapping[str, Iterable[str] | None]
) -> list[ModelVariable]:
    """All variables but time, in the order of their references.

    start: parameter values [SI]. at_start: what first values depend on.
    """
    references = block.references
    tunable = {p.name for p in block.parameters if p.tunable}

    def variable(of: Variable, causality: str, variability: str, initial: str | None,
                 **more: object) -> ModelVariable:  # fmt: skip
        text = ModelVariable(
            of.name, references[of.name], of.description, causality, variability, initial
        )
        return replace(text, unit=of.unit, nominal=of.nominal, **more)  # type: ignore[arg-type]

    found = []
    for parameter in block.parameters:
        found.append(
            variable(
                parameter,
                "parameter",
                "tunable" if parameter.tunable else "fixed",
                "exact",
                kind=parameter.kind,
                start=_text(parameter.kind, start[parameter.name]),
                bounds=_bounds(parameter),
            )
        )
    for port in block.inputs:
        found.append(variable(port, "input", "continuous", None, start=repr(float(port.start))))
    for causality, calculated in (("output", block.outputs), ("local", block.locals)):
        for v in calculated:
            source = v.derivative_of if isinstance(v, Output) else None
            found.append(variable(v, causality, "continuous", "calculated", derivative_of=source))
    for constant in block.constants:
        varies = "tunable" if tunable & set(at_start[constant.name] or tunable) else "fixed"
        found.append(variable(constant, "calculatedParameter", varies, "calculated"))
    return found


def with_arrays(block: Block, variables: Sequence[ModelVariable]) -> list[ModelVariable]:
    """The variables with the block's arrays after them, less the scalars that these replace."""
    by_name = {v.name: v for v in variables}
    gathered = block.all_arrays
    array_of = {m: array.name for array in gathered if array.replaces for m in array.members}
    first = len(variables) + 1
    found = [
        _array(array, first + i, [by_name[m] for m in array.members], array_of)
        for i, array in enumerate(gathered)
    ]
    return [*(v for v in variables if v.name not in array_of), *found]


def _array(
    array: Array, reference: int, members: Sequence[ModelVariable], array_of: Mapping[str, str]
) -> ModelVariable:
    source = members[0].derivative_of
    return replace(
        members[0],
        name=array.name,
        reference=reference,
        description=array.description,
        unit=_common(m.unit for m in members),
        nominal=_common(m.nominal for m in members),
        derivative_of=array_of.get(source) if source else None,
        shape=array.shape,
        members=array.members,
    )


def _common(values: Iterable[T]) -> T | None:
    """What all have in common, None if nothing."""
    different = set(values)
    return different.pop() if len(different) == 1 else None


def _text(kind: str, value: float) -> str:
    if kind == "real":
        return repr(float(value))
    return ("true" if value else "false") if kind == "boolean" else str(int(value))


def _bounds(parameter: Parameter) -> dict[str, str]:
    if parameter.kind not in ("real", "integer"):
        return {}
    low, high = (_text(parameter.kind, value) for value in limits(parameter))
    bounds = {"min": low} if parameter.minimum is not None else {}
    return bounds | ({"max": high} if parameter.maximum is not None else {})
