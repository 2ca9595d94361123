"""Random calls on each FMU: refused where they must be, with a reason, and forgotten by a reset."""

from __future__ import annotations

from hypothesis.stateful import run_state_machine_as_test

from support.random_calls import SETTINGS, AnyCalls, standard_run


def test_calls_in_any_order_are_refused_or_right_and_a_reset_forgets_them(instantiate2, block_name):
    fresh = standard_run(instantiate2(block_name, "fresh"))
    instance = instantiate2(block_name)
    machine = type("Calls", (AnyCalls,), {"instance": instance, "fresh": fresh})
    run_state_machine_as_test(machine, settings=SETTINGS)
