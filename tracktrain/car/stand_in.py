"""Whether an FMU can stand in for a block of the hopper car, and what the car loses by it."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fmus.catalogue import fmu_path
from orchestrator import (
    Contents,
    Description,
    FmuError,
    OrchestratorError,
    Plan,
    PortMap,
    Problem,
    System,
    UnitError,
    Variable,
    Way,
    conversion,
    couple,
    describe,
    fit,
    interpolated,
    make_plan,
    open_fmu,
    shaped,
    survey,
    taken_apart,
)

from .changes import connected_ports, differentiated, swapped, takes
from .hopper import HOPPER, hopper_car
from .signs import opposed


@dataclass(frozen=True)
class Converted:
    """A port in another unit than the block's: target value = gain * source value + offset."""

    port: str
    source: str
    target: str
    gain: float
    offset: float

    @property
    def rule(self) -> str:
        shift = f", {'plus' if self.offset > 0 else 'minus'} {abs(self.offset):.10g}"
        return f"times {self.gain:.10g}{shift if self.offset else ''}"


@dataclass
class StandIn:
    """An FMU beside a block of the car.

    Of the ports that the car connects: `fitting`, `converted`, `unitless`, `missing` by causality,
    `unusable`. Of the block's other ports: `optional` and `absent`. Of what the car gives values
    to: `given` and `lacking`. obstacles: what else keeps it out. losses: what it does not offer the
    coupling. mapped: what a map says that ports are in the FMU. effects: inputs of the car that are
    led otherwise with it; None where it cannot be in. opposed: outputs that answer what moves or
    pushes it with the other sign than the block's.
    """

    name: str
    block: str
    runs_here: bool
    platforms: list[str]
    fitting: list[str] = field(default_factory=list)
    converted: list[Converted] = field(default_factory=list)
    unitless: list[str] = field(default_factory=list)
    missing: dict[str, list[str]] = field(default_factory=lambda: {"input": [], "output": []})
    unusable: list[str] = field(default_factory=list)
    optional: list[str] = field(default_factory=list)
    absent: list[str] = field(default_factory=list)
    given: list[str] = field(default_factory=list)
    lacking: list[str] = field(default_factory=list)
    obstacles: list[str] = field(default_factory=list)
    losses: list[str] = field(default_factory=list)
    effects: list[str] | None = None
    opposed: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    mapped: dict[str, str] = field(default_factory=dict)

    @property
    def required(self) -> int:
        """How many ports the car connects."""
        names = (self.fitting, self.unitless, self.unusable, *self.missing.values())
        return len(self.converted) + sum(len(sort) for sort in names)

    @property
    def possible(self) -> bool:
        return not (any(self.missing.values()) or self.unusable or self.obstacles)

    @property
    def sound(self) -> bool:
        """Whether it can be in, and answers as the block does."""
        return self.possible and not self.opposed

    @property
    def verdict(self) -> str:
        """One sentence in plain words."""
        if not self.possible:
            missing = sum(len(ports) for ports in self.missing.values())
            reasons = [f"it lacks {counted(missing, 'required port')}"] if missing else []
            if self.unusable:
                reasons.append(f"{counted(len(self.unusable), 'port')} cannot be used")
            reasons += self.obstacles
            return f"{self.name} cannot stand in for the block {self.block}: {'; '.join(reasons)}."
        but = []
        if self.converted:
            verb = "is" if len(self.converted) == 1 else "are"
            but.append(f"{counted(len(self.converted), 'port')} {verb} converted")
        if self.effects:
            but.append("the coupling is less accurate")
        detail = f"; {' and '.join(but)}" if but else ""
        said = f"{self.name} can stand in for the block {self.block}{detail}."
        if not self.opposed:
            return said
        verb = "answers" if len(self.opposed) == 1 else "answer"
        return (
            f"{said} But {counted(len(self.opposed), 'output')} {verb} with the other sign than "
            "the block's: turn what is wrong in the FMU, or with sign = -1 in a --map."
        )


def compare(path: Path, block: str, ports: PortMap | None = None) -> StandIn:
    """The FMU, seen through a map, as a block of the hopper car.

    Raises orchestrator.FmuError for what is no FMU, CouplingError for a map that does not fit it.
    """
    contents = open_fmu(path)
    whole, own = survey(contents), describe(fmu_path(block))
    instances, car = HOPPER.instances(block), hopper_car()
    required = set[str]().union(*(connected_ports(car, name) for name in instances))
    result = StandIn(path.name, block, bool(whole.binary), contents.platforms)
    elements = taken_apart(whole, {})
    given = ports or PortMap()
    bare = given.unitless(own, elements)
    ports = given.fitted(own, elements, required)
    found = ports.applied(elements)
    result.mapped = {n: port.name for n, port in ports.ports.items() if n not in bare}
    if ports.rates:
        result.remarks.append(differentiated(ports))
    for port in [*own.inputs, *own.outputs]:
        if port.name in required:
            _compare_port(result, port, own, found)
            if port.name in bare and port.name in result.fitting:
                result.fitting.remove(port.name)
                result.unitless.append(port.label)
        elif port.name not in own.partials:
            there = _has(found, port)
            (result.optional if there else result.absent).append(port.name)
    _compare_values(result, car, instances[0], own, found)
    try:
        describe(path)
    except FmuError as error:
        result.obstacles.append(str(error).replace(f"'{path.resolve()}'", "it", 1))
    result.losses += _losses(car, instances[0], required, own, found)
    if result.possible:
        _plan(result, car, instances[0], path, ports)
    if result.possible:
        other = swapped(car, instances[0], path, ports)[0].components[instances[0]]
        pair = (car.components[instances[0]], other)
        try:
            result.opposed = opposed(
                *pair, own, _rates(car, instances[0]), required, found.single_instance
            )
        except OrchestratorError as error:
            result.remarks.append(f"its signs could not be compared with the block's: {error}")
    result.remarks += _remarks(instances, contents, own, found)
    return result


def counted(number: int, noun: str) -> str:
    """ "1 port", "2 ports"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _has(found: Description, port: Variable) -> bool:
    variable = found.find(port.name)
    return variable is not None and variable.causality == port.causality


def _compare_port(
    result: StandIn,
    port: Variable,
    own: Description,
    found: Description,
) -> None:
    variable = found.find(port.name)
    kind = f"an {port.causality}"
    if variable is None and port.name in found.arrays:
        size = shaped(found.arrays[port.name])
        result.unusable.append(f"{port.name} is an array of {size}; the port is one number")
    elif variable is None:
        result.missing[port.causality].append(f"{port.label}{_lookalike(port, own, found)}")
    elif variable.causality != port.causality:
        article = "an" if variable.causality[0] in "aeiou" else "a"
        result.unusable.append(f"{port.name} is {article} {variable.causality}, not {kind}")
    elif variable.clocked:
        result.unusable.append(_other_type(port, variable))
    else:
        _compare_ends(result, port, own, variable, found)


def _compare_ends(
    result: StandIn, port: Variable, own: Description, variable: Variable, found: Description
) -> None:
    """Whether a variable gives what the port gives, or takes what it takes."""
    ends = [(port, own), (variable, found)]
    (source, giving), (target, taking) = ends if port.causality == "input" else ends[::-1]
    match = fit(source, giving, target, taking)
    if match.problem is Problem.KIND:
        result.unusable.append(_other_type(port, variable))
    elif match.problem is Problem.UNKNOWN_UNIT:
        result.unusable.append(
            f"{port.name}: {match.detail}; define it in the FMU's UnitDefinitions"
        )
    elif match.problem is Problem.DIMENSION:
        result.unusable.append(
            f"{port.name} is in {variable.unit}, which measures something else than {port.unit}"
        )
    elif (match.gain, match.offset) == (1.0, 0.0):
        result.fitting.append(port.name)
    else:
        units = (source.unit or "1", target.unit or "1")
        result.converted.append(Converted(port.name, *units, match.gain, match.offset))


def _other_type(port: Variable, variable: Variable) -> str:
    return f"{port.name} is of type {variable.type}; the port is of type {port.type}"


def _lookalike(port: Variable, own: Description, found: Description) -> str:
    ports = found.inputs if port.causality == "input" else found.outputs
    others = [v.name for v in ports if v.name not in own.variables]
    close = difflib.get_close_matches(port.name, others, n=1, cutoff=0.7)
    return f" (it has {close[0]})" if close else ""


def _compare_values(
    result: StandIn, car: System, instance: str, own: Description, found: Description
) -> None:
    """Values that the car gives are converted, so that they must measure the same."""
    for name in car.components[instance].parameters:
        (result.given if takes(found, name) else result.lacking).append(name)
    foreign = []
    for name in result.given:
        unit, other = own.variables[name].unit, _of(found, name).unit
        if other is None or unit is None:
            continue
        try:
            fits = conversion(unit, other, own.units, found.units) is not None
        except UnitError:
            fits = False
        if not fits:
            foreign.append(f"{name} [{other} instead of {unit}]")
    if foreign:
        result.obstacles.append(f"it takes the car's values in other units: {', '.join(foreign)}")


def _losses(
    car: System, instance: str, required: set[str], own: Description, found: Description
) -> list[str]:
    """What the coupling has of the block and has not of the FMU."""
    outputs = [v for v in own.outputs if v.name in required and _has(found, v)]
    losses = []
    if required & {v.name for v in own.inputs} and not found.interpolates_inputs:
        losses.append("takes no input derivatives: its inputs are constant over each step")
    tangible = _tangible(car, instance) & {v.name for v in outputs}
    if tangible and not found.gives_derivatives:
        losses.append(f"gives no directional derivatives of {_names(tangible)}")
    taken = {tangent.input for tangent in found.tangents}
    if untaken := {tangent.input for tangent in own.tangents} - taken:
        losses.append(f"takes no tangents of {_names(untaken)}")
    if rateless := [v.name for v in outputs if own.rate_of(v.name) and not found.rate_of(v.name)]:
        losses.append(f"declares no rates of {_names(rateless)}")
    unknown = [
        v.name
        for v in outputs
        if v.dependencies is not None and _of(found, v.name).dependencies is None
    ]
    if unknown and found.inputs:
        losses.append(
            f"does not declare the feedthrough of {_names(unknown)}: taken to depend on all inputs"
        )
    return losses


def _tangible(car: System, instance: str) -> set[str]:
    """Outputs of an instance that drive an input with tangents."""
    tangible = set()
    for connection in car.connections:
        owner, _, output = connection.source.partition(".")
        target, _, driven = connection.target.partition(".")
        taker = describe(Path(str(car.components[target].fmu)))
        if owner == instance and any(tangent.input == driven for tangent in taker.tangents):
            tangible.add(output)
    return tangible


def _names(names: set[str] | list[str]) -> str:
    return ", ".join(sorted(names))


def _of(found: Description, name: str) -> Variable:
    variable = found.find(name)
    assert variable is not None
    return variable


def _plan(result: StandIn, car: System, instance: str, path: Path, ports: PortMap) -> None:
    """Plan the car with the FMU in it, as a run does, and compare how its inputs are led."""
    usual = make_plan(car)
    try:
        plan = make_plan(swapped(car, instance, path, ports)[0])
    except OrchestratorError as error:
        result.obstacles.append(f"the car refuses it: {error}")
        return
    before, now = _ways(usual), _ways(plan)
    changes: dict[tuple[str, str], list[str]] = {}
    for name, way in now.items():
        if way != before[name]:
            changes.setdefault((way, before[name]), []).append(name)
    result.effects = [
        f"{way} instead of {then}: {', '.join(names)}" for (way, then), names in changes.items()
    ]
    if looped := plan.looped - usual.looped:
        names = _names([plan.names[n] for n in looped])
        result.effects.append(f"algebraic loop, solved in every step, through {names}")


def _ways(plan: Plan) -> dict[str, str]:
    """How each input is led, by its full name; by the mean where it cannot move over a step."""
    return {
        plan.name(link.target, link.input): way.name.lower().replace("_", " ")
        if way is Way.HELD or interpolated(plan, link)
        else "mean"
        for link, way in couple(plan).ways.items()
    }


def _rates(car: System, instance: str) -> dict[str, str]:
    """Inputs of an instance that the car drives with rates, by the inputs whose rates they are."""
    drives: dict[str, str] = {}
    for connection in car.connections:
        target, _, port = connection.target.partition(".")
        if target == instance:
            drives[connection.source] = port
    rates = {}
    for source, port in drives.items():
        owner, _, output = source.partition(".")
        rate = describe(Path(str(car.components[owner].fmu))).rate_of(output)
        if rate is not None and (moving := drives.get(f"{owner}.{rate.name}")):
            rates[moving] = port
    return rates


def _remarks(
    instances: Sequence[str], contents: Contents, own: Description, found: Description
) -> list[str]:
    remarks = []
    if found.single_instance and len(instances) > 1:
        remarks.append(
            f"it can be instantiated only once in a process: for one of {', '.join(instances)}, or "
            "with --isolate"
        )
    said = contents.interfaces.get("co-simulation", {})
    if said.get("needsExecutionTool") in ("true", "1"):
        remarks.append("it needs the tool that made it on this machine")
    opened = [
        v.name for v in found.inputs if v.name not in own.variables and v.name not in found.partials
    ]
    if opened:
        remarks.append(f"inputs that nothing drives stay at their start: {', '.join(opened)}")
    return remarks
