"""What is wrong in a model description, found before anything relies on it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from xml.etree.ElementTree import Element

TYPED = ("Real", "Integer", "Boolean", "String", "Enumeration")
"""Elements that say the type of a variable of FMI 1.0 and 2.0."""

Reader = Callable[[str], object]
"""From text to a value; None for text that is none."""

REFERENCES = 2**32
"""Value references have 32 bits."""


def first_problem(root: Element) -> str:
    """What is wrong first, in words; empty if nothing is."""
    return next(_problems(root), "")


def _problems(root: Element) -> Iterator[str]:
    for path, attributes in _NUMBERS.items():
        for element in root.iterfind(path):
            yield from _no_numbers(f"<{element.tag}>", element, attributes)
    for path in ("UnitDefinitions/Unit", "TypeDefinitions/*", "TypeDefinitions//Item"):
        for element in root.iterfind(path):
            if "name" not in element.attrib and root.get("fmiVersion") != "1.0":
                yield f"a <{element.tag}> has no name"
    variables = root.find("ModelVariables")
    if variables is None:
        yield "it has no <ModelVariables>"
        return
    names: set[str] = set()
    for variable in variables:
        if "name" not in variable.attrib:
            yield f"a <{variable.tag}> has no name"
        label = f"the variable '{variable.get('name')}'"
        said = [variable, *variable.findall("Alias")]
        for name in (str(element.get("name")) for element in said):
            if name in names:
                yield f"two variables are called '{name}'"
            names.add(name)
        yield from _of_variable(label, variable, root)
    yield from _of_structure(root, variables)


def _of_variable(label: str, variable: Element, root: Element) -> Iterator[str]:
    typed = variable
    if variable.tag == "ScalarVariable":
        found = next((child for child in variable if child.tag in TYPED), None)
        if found is None:
            yield f"{label} has no type"
            return
        typed = found
    if "valueReference" not in variable.attrib:
        yield f"{label} has no valueReference"
    yield from _no_numbers(label, variable, {"valueReference": _reference, "previous": _reference})
    kind = _number_of(typed.tag.removesuffix("Type"))
    if kind is not None:
        limits = {"min": kind, "max": kind, "nominal": _real, "derivative": _reference}
        yield from _no_numbers(label, typed, limits)
        starts = (typed.get("start") or "").split()
        one = variable.tag == "ScalarVariable" and "start" in typed.attrib
        for text in starts or ([""] if one else []):
            if kind(text) is None:
                yield f'{label} has start="{text}", which is no {_WORDS[kind]}'
        if one and len(starts) > 1:
            yield f'{label} has start="{typed.get("start")}", which is no {_WORDS[kind]}'
    for dimension in variable.iterfind("Dimension"):
        if not {"start", "valueReference"} & {*dimension.attrib}:
            yield f"{label} has a dimension without a size"
        sizes = {"start": _count, "valueReference": _reference}
        yield from _no_numbers(f"a dimension of {label}", dimension, sizes)


def _of_structure(root: Element, variables: Element) -> Iterator[str]:
    """Numbers of variables that are none: their places in FMI 2.0, else their value references."""
    by_place = root.get("fmiVersion") == "2.0"
    known: range | set[int] = range(1, len(variables) + 1)
    if not by_place:
        known = {int(v.get("valueReference", "0")) for v in variables}
    meant = f"1 to {len(variables)}" if by_place else "the variables' value references"

    def unknown(label: str, texts: Iterable[str]) -> Iterator[str]:
        for text in texts:
            number = _reference(text)
            if number is None or number not in known:
                yield f"{label} is '{text}', which is no variable; {meant} are"

    for variable in variables:
        label = f"of the variable '{variable.get('name')}'"
        for typed in (variable, *variable):
            for attribute in ("derivative", "clocks", "previous"):
                if typed.tag in (*TYPED, variable.tag) and attribute in typed.attrib:
                    yield from unknown(f"the {attribute} {label}", typed.attrib[attribute].split())
        sizes = (
            d.attrib["valueReference"] for d in variable.iterfind("Dimension[@valueReference]")
        )
        yield from unknown(f"the size {label}", sizes)
    for structure in root.iterfind("ModelStructure"):
        for element in structure.iter():
            key = "index" if by_place else "valueReference"
            if element.tag in _UNKNOWNS:
                if key not in element.attrib:
                    yield f"an <{element.tag}> of the model structure has no {key}"
                yield from unknown(f"the {key} of an <{element.tag}>", [element.get(key, "")])
                depends = element.get("dependencies", "").split()
                yield from unknown(
                    f'a dependency of <{element.tag} {key}="{element.get(key)}">', depends
                )


def _no_numbers(label: str, element: Element, attributes: Mapping[str, Reader]) -> Iterator[str]:
    for attribute, read in attributes.items():
        text = element.get(attribute)
        if text is not None and read(text) is None:
            yield f'{label} has {attribute}="{text}", which is no {_WORDS[read]}'


def _real(text: str) -> float | None:
    try:
        return float(text) if "_" not in text else None
    except ValueError:
        return None


def _whole(text: str) -> int | None:
    return int(text) if len(text) < 40 and re.fullmatch(r"\s*[+-]?[0-9]+\s*", text) else None


def _count(text: str) -> int | None:
    number = _whole(text)
    return number if number is not None and 0 <= number < 2**63 else None


def _reference(text: str) -> int | None:
    number = _whole(text)
    return number if number is not None and 0 <= number < REFERENCES else None


def _truth(text: str) -> bool | None:
    return {"true": True, "1": True, "false": False, "0": False}.get(text.strip())


def _number_of(type_: str) -> Reader | None:
    """How a value of a type is read; None for one that may be any text."""
    if type_ in ("Real", "Float32", "Float64"):
        return _real
    if type_ in ("Integer", "Enumeration") or type_.startswith(("Int", "UInt")):
        return _whole
    return _truth if type_ == "Boolean" else None


_WORDS: dict[Reader, str] = {
    _real: "number",
    _whole: "whole number",
    _count: "size",
    _reference: "whole number from 0 to 4294967295",
    _truth: "truth value",
}

_UNKNOWNS = {
    "Unknown", "Output", "ContinuousStateDerivative", "ClockedState", "InitialUnknown",
    "EventIndicator",
}  # fmt: skip

_BASE = dict.fromkeys(("kg", "m", "s", "A", "K", "mol", "cd", "rad"), _whole)
_SCALE = {"factor": _real, "offset": _real}
_RANGE = dict.fromkeys(("min", "max", "nominal"), _real)

_NUMBERS: dict[str, dict[str, Reader]] = {
    ".": {"numberOfEventIndicators": _count, "numberOfContinuousStates": _count},
    "UnitDefinitions/Unit/BaseUnit": {**_BASE, **_SCALE},
    "UnitDefinitions/Unit/DisplayUnit": {**_SCALE},
    "TypeDefinitions/*": {**_RANGE},
    "TypeDefinitions/SimpleType/*": {**_RANGE},
    "TypeDefinitions/SimpleType/Enumeration/Item": {"value": _whole},
    "TypeDefinitions/EnumerationType/Item": {"value": _whole},
    "DefaultExperiment": dict.fromkeys(("startTime", "stopTime", "stepSize", "tolerance"), _real),
}
"""Attributes that are numbers, by the way to their elements."""
