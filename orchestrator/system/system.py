"""A system of FMUs: components, connections between them, and power bonds. Plain frozen data."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import CouplingError, FmuError, choices, listed
from ..fmu.description import CO_SIMULATION, MODEL_EXCHANGE
from ..fmu.given import in_unit
from ..fmu.port_map import PortMap
from ..fmu.read import describe
from ..summary import Rows, Summarised
from .profile import Profile
from .source import Source
from .transformation import IDENTITY, Transformation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Value = float | int | bool | str | list["Value"] | tuple["Value", ...]
"""A number in the variable's unit, or text: a quantity ("200 lbf/in"), an enumeration's item.

For an array a list, or text: "1 2 3 mm"."""

STEP = 1e-3
"""Macro step where neither the caller nor the system gives one [s]."""


@dataclass(frozen=True)
class Component:
    """An FMU, with start values of its parameters and of inputs that nothing drives.

    ports: what the system's names are in the FMU, where it has other ones.
    every: it steps once in so many macro steps, over all of them.
    reads_any_time: False for an FMU whose outputs may not be read after inputs were set, unless a
    step was taken between: they are then those of its last step.
    """

    fmu: Path | Profile | Source
    parameters: Mapping[str, Value] = field(default_factory=dict)
    ports: PortMap | None = None
    every: int = 1
    reads_any_time: bool = True

    def __post_init__(self) -> None:
        if isinstance(self.fmu, str):
            object.__setattr__(self, "fmu", Path(self.fmu))

    @property
    def label(self) -> str:
        """What stands for it, in a word."""
        return self.fmu.name if isinstance(self.fmu, Path) else type(self.fmu).__name__

    @property
    def file(self) -> Path | None:
        """The FMU file; None for a table or a model within the program."""
        return self.fmu if isinstance(self.fmu, Path) else None


@dataclass(frozen=True)
class Connection:
    """An output that drives an input: "truck_front.axle[1].y", instance, dot, variable.

    The value is converted to the target's unit, unless that is suppressed, and then transformed.
    """

    source: str
    target: str
    transformation: Transformation = IDENTITY
    suppress_unit_conversion: bool = False


@dataclass(frozen=True)
class PowerBond:
    """A force output and the velocity output that it works on, each driving the other's owner."""

    force: str
    velocity: str


@dataclass(frozen=True)
class Experiment:
    """How a system is run when nothing else is asked for [s]; None where it does not say."""

    start: float | None = None
    stop: float | None = None
    step: float | None = None

    def __post_init__(self) -> None:
        for stated in fields(self):
            if (given := getattr(self, stated.name)) is not None:
                object.__setattr__(self, stated.name, in_unit(given, "s", stated.name))


@dataclass(frozen=True, repr=False)
class System(Summarised):
    """Instances by name, and how they are connected. Without `bonds` these are found by unit.

    notes: what the reader of a file has to say about it; a run repeats them.
    """

    components: Mapping[str, Component]
    connections: tuple[Connection, ...] = ()
    bonds: tuple[PowerBond, ...] | None = None
    experiment: Experiment = Experiment()
    notes: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        """Take a path for its component, and a pair of names for their connection."""
        components = {
            name: given if isinstance(given, Component) else Component(given)
            for name, given in self.components.items()
        }
        connections = tuple(
            Connection(*given) if isinstance(given, tuple | list) else given
            for given in self.connections
        )
        object.__setattr__(self, "components", components)
        object.__setattr__(self, "connections", connections)

    def _summary(self) -> Rows:
        stop, step = self.experiment.stop, self.experiment.step
        timed = {} if stop is None else {"experiment": f"to {stop:g} s by {step or STEP:g} s"}
        return {
            "System": f"{len(self.components)} components, {len(self.connections)} connections",
            "of": listed([f"{name} ({c.label})" for name, c in self.components.items()]),
            **timed,
        }

    def plot(self) -> Figure:
        """A diagram of the components, and how many connections go from one to the other.

        Raises CouplingError for more than `diagram.MOST` components.
        """
        from .diagram import diagram

        boxes = {name: component.label for name, component in self.components.items()}
        return diagram(boxes, ((c.source, c.target) for c in self.connections))

    def with_fmu(self, instance: str, fmu: Path | Source, ports: PortMap | None = None) -> System:
        """The same system with another FMU in an instance's place; its values are kept."""
        component = replace(self._component(instance), fmu=fmu, ports=ports)
        return replace(self, components={**self.components, instance: component})

    def with_value(self, name: str, value: Value) -> System:
        """The same system with a start value for "instance.variable".

        Raises CouplingError or ValueRefusedError for a name that there is not; whether the value
        fits is seen when the system is run.
        """
        instance, variable = split(name)
        return self.with_values({instance: {variable: value}})

    def with_values(self, values: Mapping[str, Mapping[str, Value]]) -> System:
        """The same system with start values by instance and variable; raises as `with_value`."""
        changed = {}
        for instance, given in values.items():
            component = self._component(instance)
            _check_known(instance, component, given)
            changed[instance] = replace(component, parameters={**component.parameters, **given})
        return replace(self, components={**self.components, **changed})

    def driven(self, name: str, profile: Profile) -> System:
        """The same system with a table that drives the input "instance.variable".

        The table is an instance of its own, named after the input; its value at a time takes the
        place of a start value. Raises CouplingError for an input that something drives.
        """
        instance, variable = split(name)
        component = self._component(instance)
        driver = next((c.source for c in self.connections if c.target == name), None)
        if driver is not None:
            raise CouplingError(
                f"{name} cannot be driven by the table {profile.origin or profile.name}: it is "
                f"driven by {driver}"
            )
        place = re.sub(r"\W+", "_", name).strip("_")
        if place in self.components:
            raise CouplingError(f"an instance is called '{place}', as the table of {name} would be")
        given = {n: value for n, value in component.parameters.items() if n != variable}
        return replace(
            self,
            components={
                **self.components,
                instance: replace(component, parameters=given),
                place: Component(profile),
            },
            connections=(*self.connections, Connection(f"{place}.{profile.name}", name)),
        )

    def prefixed(self, prefix: str) -> System:
        """The same system, nested under a name: `truck` becomes `prefix:truck`."""

        def new(name: str) -> str:
            return f"{prefix}:{name}"

        return replace(
            self,
            components={new(name): component for name, component in self.components.items()},
            connections=tuple(
                replace(c, source=new(c.source), target=new(c.target)) for c in self.connections
            ),
            bonds=self.bonds
            and tuple(PowerBond(new(b.force), new(b.velocity)) for b in self.bonds),
        )

    def joined(self, other: System, connections: Iterable[Connection] = ()) -> System:
        """Both systems in one, with further connections between them; the experiment is this one's.

        Their bonds are kept where both have some, else found by unit. Raises CouplingError for a
        name that both have.
        """
        for name in self.components:
            if name in other.components:
                raise CouplingError(
                    f"both systems have an instance '{name}'; tell them apart with prefixed()"
                )
        both = self.bonds is not None and other.bonds is not None
        return replace(
            self,
            components={**self.components, **other.components},
            connections=(*self.connections, *other.connections, *connections),
            bonds=(*(self.bonds or ()), *(other.bonds or ())) if both else None,
            notes=tuple(dict.fromkeys((*self.notes, *other.notes))),
        )

    def _component(self, instance: str) -> Component:
        if instance not in self.components:
            raise CouplingError(
                f"there is no instance '{instance}'; {choices(instance, self.components)}"
            )
        return self.components[instance]


def _check_known(instance: str, component: Component, names: Iterable[str]) -> None:
    """Raise ValueRefusedError where an instance has no variable of one of the names.

    Of an FMU that cannot be read, the run says so.
    """
    description = None
    if not isinstance(component.fmu, Path):
        description = component.fmu.description
    else:
        for interface in (MODEL_EXCHANGE, CO_SIMULATION):
            with suppress(FmuError):
                description = describe(component.fmu, interface=interface)
        if description is not None and component.ports is not None:
            description = component.ports.applied(description)
    if description is None:
        return
    for name in names:
        if not description.may_have(name):
            raise description.unknown(instance, name)


def split(name: str) -> tuple[str, str]:
    """Instance and variable of "instance.variable"; raises CouplingError without a dot."""
    instance, dot, variable = name.partition(".")
    if not (instance and dot and variable):
        raise CouplingError(f"'{name}' names no variable; write it as instance.variable")
    return instance, variable
