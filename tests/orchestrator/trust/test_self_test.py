"""FMUs that do not do what they say are found out; those that do are not."""

from __future__ import annotations

import random

import pytest

from orchestrator import Component, Connection, InlineModel, System, simulate
from orchestrator.trust.self_test import CHECKS, self_test
from orchestrator.trust.tested import self_tests
from support.coupled_models import damper, mass
from tracktrain.car.hopper import HOPPER, hopper_car


def checked(**mock):
    return self_test(Component(InlineModel(**mock)))


def errors(found) -> dict[str, str]:
    return {finding.check: finding.text for finding in found.errors}


def counting(x, u, rate, p, time, step):
    x[0] += u["u"] + 1.0  # in place: who saved the state holds this very list
    return x


COUNTER = {
    "inputs": {"u": "m"},
    "outputs": {"y": "m"},
    "initial": lambda p: [0.0],
    "step": lambda x, u, rate, p, time, step: [x[0] + u["u"] + 1.0],
    "output": lambda x, u, p: {"y": x[0]},
}


def test_honest_mocks_pass():
    for component in (damper(10.0), mass(), InlineModel(**COUNTER)):
        found = self_test(Component(component))
        assert found.findings == ()
    assert found.passed == (
        "start", "units", "surroundings", "determinism", "rollback", "reading", "dependencies",
    )  # fmt: skip


def test_a_saved_state_that_forgets_is_found_out():
    text = errors(checked(**{**COUNTER, "step": counting}))["rollback"]
    assert text.startswith("y was 2.99") and "when the state was saved, and is 5.99" in text


def test_a_hidden_state_that_is_not_saved_is_found_out():
    """As the default of pythonfmu, which saves what is a variable and nothing else."""
    hidden = [0.0]

    def step(x, u, rate, p, time, step):
        hidden[0] += 1.0
        return x + hidden[0]

    def initial(p):
        hidden[0] = 0.0
        return 0.0

    found = errors(
        checked(outputs={"y": "m"}, initial=initial, step=step, output=lambda x, u, p: {"y": x})
    )
    assert found["rollback"] == (
        "a saved state does not hold everything: y is 10 one step after it, and 13 when it is put "
        "back and the same is repeated"
    )


def test_random_outputs_are_found_out():
    found = errors(
        checked(outputs={"y": "m"}, step=lambda x, *_: random.random(),
               output=lambda x, u, p: {"y": x or 0.0})
    )  # fmt: skip
    assert "two instances differ: after 1 equal steps y is" in found["determinism"]


def test_a_wrong_derivative_is_found_out_with_both_numbers():
    wrong = damper(
        10.0,
        directional=lambda x, u, p, seed: {"force": -20.0 * seed["v"] + 10.0 * seed["ground_v"]},
    )
    found = errors(self_test(Component(wrong)))
    assert "the derivative of force by v is said to be -20 at the start" in found["derivatives"]
    assert "a central difference gives -10" in found["derivatives"]


def test_a_kink_is_no_wrong_derivative():
    kink = InlineModel(
        inputs={"v": "m/s"},
        outputs={"force": "N"},
        depends={"force": ("v",)},
        output=lambda x, u, p: {"force": 3.0 * max(u["v"], -1e-3)},
        directional=lambda x, u, p, seed: {"force": (3.0 if u["v"] > -1e-3 else 1.5) * seed["v"]},
    )
    assert self_test(Component(kink)).errors == []


def test_a_kink_of_one_output_may_choose_the_branch_of_another():
    """Its derivative is then of no side, where its own one-sided differences agree."""
    both = InlineModel(
        inputs={"v": "m/s"},
        outputs={"force": "N", "other": "N"},
        depends={"force": ("v",), "other": ("v",)},
        output=lambda x, u, p: {"force": 3.0 * max(u["v"], -1e-3), "other": 2.0 * u["v"]},
        directional=lambda x, u, p, seed: (
            {"force": 3.0 * seed["v"], "other": 2.0 * seed["v"]}
            if u["v"] > -1e-3
            else {"force": 0.0, "other": 0.5 * seed["v"]}
        ),
    )
    assert self_test(Component(both)).errors == []


def test_undeclared_feedthrough_is_an_error_and_unseen_a_remark():
    found = self_test(Component(damper(10.0, depends={"force": ("ground_v",)}, directional=None)))
    assert errors(found)["dependencies"].startswith("force goes from ")
    assert "at once when v goes from" in errors(found)["dependencies"]
    more = checked(**{**COUNTER, "depends": {"y": ("u",)}})
    assert more.errors == [] and "dependencies" in more.passed
    assert [f.text for f in more.findings] == [
        "said to depend at once, but not seen to here: y on u"
    ]


def test_unknown_units_are_remarked():
    found = checked(outputs={"y": "furlong/moon"}, output=lambda x, u, p: {"y": 1.0})
    assert "y: 'furlong/moon' is not a known unit" in found.findings[0].text
    assert not found.findings[0].wrong


def test_an_fmu_whose_states_lie_is_not_rolled_back():
    hidden = {"inputs": {"force": "N"}, "outputs": {"v": "m/s"}, "initial": lambda p: [1.0]}

    def step(x, u, rate, p, time, step):
        x[0] += step * u["force"]
        return x

    forgetful = InlineModel(step=step, output=lambda x, u, p: {"v": x[0]}, **hidden)
    system = System(
        {"damper": Component(damper(1.0)), "mass": Component(forgetful)},
        (Connection("damper.force", "mass.force"), Connection("mass.v", "damper.v")),
    )
    run = simulate(system, duration=0.1, step=0.01, master="iterated", self_test=True)
    notes = "\n".join(run.notes)
    assert "self-test of mass: mock: v was" in notes
    assert "not repeated, since not rolled back: mass" in notes
    assert run.verdict.level.value == "doubtful"
    assert "The self-test failed for mass (mock: v was" in str(run.verdict)


@pytest.fixture(scope="module")
def ours():
    return self_tests(hopper_car().components)


@pytest.mark.parametrize("instance", ["carbody", "truck_front", "wheelset_11", "track"])
def test_our_fmus_pass_every_check(ours, instance):
    assert ours[instance].passed == CHECKS
    assert ours[instance].label == f"{HOPPER.blocks[instance]}.fmu"
