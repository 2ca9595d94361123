"""What an FMU says about itself, as far as coupling needs it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf

from ..errors import ValueRefusedError, choices, listed
from ..summary import Rows, Summarised
from .types import TYPES
from .units import Definitions, Unit

CO_SIMULATION, MODEL_EXCHANGE = "co-simulation", "model exchange"


@dataclass(frozen=True)
class Lane:
    """Where a variable's number is in an FMU: element of `value_reference`, which has `size`.

    The variable's value is gain * the FMU's + offset. difference_of: name of the variable whose
    rate it is, where the FMU does not have it.
    """

    value_reference: int
    element: int = 0
    size: int = 1
    gain: float = 1.0
    offset: float = 0.0
    difference_of: str = ""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU. `dependencies`: inputs that an output depends on; None means all.

    reference: by which it is set and read; a number of its own where it has a `lane`, else the
    value reference. dimensions: sizes, or names of the structural parameters that give them; an
    array that is coupled is taken apart into variables without. starts: those of an array.
    difference: its values are differences, to which no offset of a unit belongs.
    interpolated: an input that may vary over a step. clocks: value references of those that it
    belongs to. held: between the ticks of clocks it stays as it is. clocked: because of its clocks
    it is not coupled.
    """

    name: str
    reference: int
    type: str
    causality: str
    variability: str = "continuous"
    initial: str | None = None
    unit: str | None = None
    difference: bool = False
    start: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float = 0.0
    items: Mapping[str, int] = field(default_factory=dict)
    description: str = ""
    derivative_of: str | None = None
    dependencies: frozenset[str] | None = frozenset()
    shape: tuple[int, ...] = ()
    dimensions: tuple[int | str, ...] = ()
    starts: tuple[str, ...] = ()
    interpolated: bool = True
    clocks: tuple[int, ...] = ()
    held: bool = False
    clocked: bool = False
    lane: Lane | None = None

    @property
    def kind(self) -> str:
        """What it is whatever its size in memory, such as "real" or "integer"."""
        return TYPES[self.type].kind

    @property
    def coupled(self) -> bool:
        """Whether it is a number that masters can exchange."""
        return not self.textual and not self.shape and not self.clocked

    @property
    def textual(self) -> bool:
        """Whether it is a text, as which bytes are passed on, too: two hexadecimal digits each."""
        return self.kind in ("string", "binary")

    @property
    def value_reference(self) -> int:
        """By which the FMU knows it."""
        return self.lane.value_reference if self.lane else self.reference

    @property
    def takes_value(self) -> bool:
        """Whether it may be given a value before the run."""
        if self.variability == "constant" or self.causality == "independent":
            return False
        if self.causality in ("parameter", "structuralParameter", "input"):
            return True
        return self.initial in ("exact", "approx")

    @property
    def label(self) -> str:
        """Name and unit, as messages show it."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass(frozen=True)
class Clock:
    """A clock of FMI 3.0. variability: of its interval, as the standard has it.

    interval, shift: from tick to tick, and to the first one [s]; None where only the FMU knows.
    """

    name: str
    reference: int
    causality: str
    variability: str
    interval: float | None = None
    shift: float = 0.0

    @property
    def triggered(self) -> bool:
        """Whether it ticks when other clocks do, and not by time."""
        return self.causality == "output" or self.variability == "triggered"


@dataclass(frozen=True)
class Tangent:
    """The input `partial` is the derivative of `input` with respect to the FMU's own `output`."""

    input: str
    output: str
    partial: str


@dataclass(frozen=True)
class Limit:
    """Outputs, and the values [their unit] that the FMU's laws hold for, as it states them.

    beyond: what lies outside, remedy: what helps, both in words. void: whether what lies outside
    means nothing, rather than being less sure. allowed: share of a run's time that an output may be
    outside while the answer as a whole holds.
    """

    outputs: tuple[str, ...]
    least: float = -inf
    largest: float = inf
    unit: str = ""
    beyond: str = ""
    remedy: str = ""
    source: str = ""
    void: bool = False
    allowed: float = 0.0


@dataclass(frozen=True, repr=False)
class Description(Summarised):
    """An FMU for one of its interfaces: its variables, what it can do, and where its binary is.

    failure_categories: those of the standard's log categories for what goes wrong that it has.
    arrays: shapes of those that were taken apart into elements. aliases: other names of variables.
    has_events: it has the event mode of FMI 3.0. returns_early: it may end a step early.
    optional: inputs that the FMU can do without.
    input_order: the highest derivative of an input that is taken; of a file it is 1.
    needs_tool: it runs in the tool that it is from. tolerance: that its default experiment asks
    for. reads_any_time: outputs may be read after inputs were set, without a step between;
    late: those that are not and follow inputs at once. limits: None where it states no range.
    """

    label: str
    variables: Mapping[str, Variable]
    interpolates_inputs: bool = False
    input_order: int = 1
    saves_state: bool = False
    variable_step: bool = False
    gives_derivatives: bool = False
    single_instance: bool = False
    needs_tool: bool = False
    serializes_state: bool = False
    tangents: tuple[Tangent, ...] = ()
    optional: frozenset[str] = frozenset()
    units: Definitions = field(default_factory=dict)
    fmi_version: str = "2.0"
    guid: str = ""
    model_identifier: str = ""
    binary: str = ""
    sha256: str = ""
    failure_categories: tuple[str, ...] = ()
    arrays: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    aliases: Mapping[str, str] = field(default_factory=dict)
    has_events: bool = False
    returns_early: bool = False
    clocks: tuple[Clock, ...] = ()
    tolerance: float | None = None
    reads_any_time: bool = True
    late: tuple[str, ...] = ()
    limits: tuple[Limit, ...] | None = None

    def _summary(self) -> Rows:
        of = {
            kind: [v.label for v in self.variables.values() if v.causality == kind]
            for kind in ("parameter", "input", "output")
        }
        able = {
            "interpolates inputs": self.interpolates_inputs,
            "directional derivatives": self.gives_derivatives,
            "saves its state": self.saves_state,
        }
        return {
            "FMU": f"{self.label} (FMI {self.fmi_version})",
            **{f"{kind}s": listed(names) for kind, names in of.items() if names},
            "can": listed([what for what, is_so in able.items() if is_so]) or "step",
        }

    def as_of_steps(self) -> Description:
        """The same, outputs being read right after a step only: none follows an input at once."""
        variables = {
            v.name: replace(v, dependencies=frozenset()) if v.causality == "output" else v
            for v in self.variables.values()
        }
        late = tuple(v.name for v in self.outputs if v.dependencies != frozenset())
        return replace(
            self, variables=variables, reads_any_time=False, gives_derivatives=False, late=late
        )

    def with_outputs(self, names: Collection[str]) -> Description:
        """The same with more variables as outputs, of which it is not said what they depend on."""
        depends = None if self.reads_any_time else frozenset[str]()
        variables = {
            v.name: replace(v, causality="output", dependencies=depends) if v.name in names else v
            for v in self.variables.values()
        }
        return replace(self, variables=variables)

    def find(self, name: str) -> Variable | None:
        """The variable of a name, which may be an alias."""
        return self.variables.get(name) or self.variables.get(self.aliases.get(name, ""))

    def unit_of(self, variable: Variable) -> Unit | None:
        """A variable's unit as this FMU means it; None for a variable without one."""
        if variable.unit is None:
            return None
        return Unit(variable.unit, self.units, variable.difference)

    def may_have(self, name: str) -> bool:
        """Whether there is a variable or an array of a name, or such an element for some size."""
        return self.find(name) is not None or name.partition("[")[0] in self.arrays

    def unknown(self, instance: str, name: str) -> ValueRefusedError:
        """What to raise where a value is given to a variable that there is not."""
        settable = (v.name for v in self.variables.values() if v.takes_value)
        names = [known for known in settable if known not in self.partials]
        return ValueRefusedError(
            f"{instance} ({self.label}) has no variable '{name}'; {choices(name, names)}"
        )

    def interpolates(self, variable: Variable) -> bool:
        """Whether an input can be led along a line over a step."""
        continuous = variable.kind == "real" and variable.interpolated
        return self.interpolates_inputs and continuous

    @cached_property
    def inputs(self) -> list[Variable]:
        return [v for v in self.variables.values() if v.causality == "input"]

    @cached_property
    def outputs(self) -> list[Variable]:
        return [v for v in self.variables.values() if v.causality == "output"]

    @cached_property
    def partials(self) -> frozenset[str]:
        """Inputs that take a partial derivative; unconnected they stay at their start."""
        return frozenset(tangent.partial for tangent in self.tangents)

    def rate_of(self, output: str) -> Variable | None:
        """The output that is declared to be the time derivative of `output`."""
        return self._rates.get(output)

    @cached_property
    def _rates(self) -> dict[str | None, Variable]:
        """By each output, the first that is its rate."""
        return {v.derivative_of: v for v in reversed(self.outputs)}
