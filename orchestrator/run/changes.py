"""What is changed between two macro steps: inputs that nothing drives, and tunable parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..errors import CouplingError, choices
from ..fmu.description import Variable
from ..naming import picked
from ..plan.connections import split
from ..plan.plan import Plan
from ..plan.start_values import resolve
from ..slaves.base import Slave
from ..system.system import Value


class Changes:
    """Gives variables of a plan's slaves values while a run stands between two macro steps."""

    def __init__(self, plan: Plan, slaves: Sequence[Slave]) -> None:
        self._plan, self._slaves = plan, slaves
        self._driver = {
            (k.target, k.input.name): plan.name(k.source, k.output)
            for k in (*plan.links, *plan.text_links)
        }

    def set(self, name: str, value: Value) -> dict[str, float]:
        """Give "instance.variable" a value, or text with a unit; the inputs that changed.

        Raises CouplingError, SlaveError, ValueRefusedError.
        """
        instance, variable_name = split(self._spelled(name))
        if instance not in self._plan.names:
            raise CouplingError(
                f"'{name}' is in no instance; {choices(instance, self._plan.names)}"
            )
        number = self._plan.names.index(instance)
        found = resolve(instance, self._plan.descriptions[number], variable_name, value)
        for variable, _ in found:
            if reason := self._refusal(number, variable):
                raise CouplingError(f"{name} cannot be set between steps: {reason}")
        slave, changed = self._slaves[number], {}
        with slave.watched():
            for variable, own in found:
                if variable.causality != "input":
                    slave.set_value(variable, own)
                elif variable.textual:
                    slave.set_texts([variable], [str(own)])
                else:
                    numbers = np.array([own], float)
                    slave.set_reals([variable], numbers)
                    changed[self._plan.name(number, variable)] = float(numbers[0])
        return changed

    def _spelled(self, asked: str) -> str:
        """The name of what can be set that `picked` reads in it; else what was asked."""
        names = self._plan.names
        if asked.partition(".")[0] in names:
            return asked
        free = [f"{name}.{own}" for number, name in enumerate(names) for own in self._free(number)]
        found = picked(asked, free)
        return found[0] if len(found) == 1 else asked

    def _refusal(self, number: int, variable: Variable) -> str:
        """Why a variable cannot be set; empty if it can."""
        driver = self._driver.get((number, variable.name))
        if driver is not None:
            return f"{driver} drives it; leave that connection out"
        if variable.causality == "input" or variable.variability == "tunable":
            return ""
        free = choices(variable.name, self._free(number))
        return f"its FMU takes this {variable.causality} before a run only; {free}"

    def _free(self, number: int) -> Iterator[str]:
        for variable in self._plan.descriptions[number].variables.values():
            known = variable.takes_value and (number, variable.name) not in self._driver
            if known and (variable.causality == "input" or variable.variability == "tunable"):
                yield variable.name
